#include "volcal/identify/criticism/catalogue/left_out.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/rotary_places.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/functions/legendre_polynomials.h"
#include "volcal/model/kinematics/location_sign.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

constexpr int kDegrees = 6;                  // polynomials of an axis' position, or sines and cosines
constexpr const char* kHeldAtZero = "zero";  // a basis without functions
constexpr const char* kHarmonics = "harmonics";

using Polynomials = std::array<double, kDegrees + 1>;  // by degree

Polynomials legendre(double x) {
  Polynomials values;
  write_legendre_polynomials(kDegrees, x, values.data());
  return values;
}

/// cos q, sin q, cos 2q ... as number 1, 2, 3 ...
Polynomials harmonics(double angle) {
  Polynomials values{1.0};
  for (int k = 1; k <= kDegrees; ++k) {
    const double multiple = (k + 1) / 2 * angle;
    values[static_cast<std::size_t>(k)] = k % 2 == 1 ? std::cos(multiple) : std::sin(multiple);
  }
  return values;
}

/// Polynomials of an axis' position over its measured range, of a rotary axis harmonics: what a bearing, a
/// droop or a line out of true do goes on as a sine where no reading stood. Zero at home.
class OwnPosition {
 public:
  OwnPosition(const Campaign& campaign, AxisName axis)
      : axis_(axis),
        range_(measured_range(campaign, axis)),
        home_(values(campaign.machine.axis(axis).home)) {}

  bool varies() const { return range_.max > range_.min; }
  /// From the degree `lowest` on; columns beyond the first `order` are zero.
  void fill(const SetupView& view, int lowest, Eigen::Index order,
            Eigen::Ref<Eigen::MatrixXd> columns) const {
    columns.setZero();
    const auto& position = view.setup.readings.position[index_of(axis_)];
    for (Eigen::Index row = 0; row < columns.rows(); ++row) {
      const Polynomials values = this->values(position[static_cast<std::size_t>(row)]);
      for (Eigen::Index k = 0; k < order; ++k) {
        const auto degree = static_cast<std::size_t>(lowest + k);
        columns(row, k) = values[degree] - home_[degree];
      }
    }
  }

 private:
  Polynomials values(double position) const {
    return is_rotary(axis_) ? harmonics(position) : legendre(range_.scaled(position));
  }

  AxisName axis_;
  MeasuredRange range_;
  Polynomials home_;
};

EffectSpec left_out_spec(const std::string& symbols) { return effect_spec(kLeftOut, {{"symbol", symbols}}); }

/// "displacement along X", "rotation about X"
std::string words_of(Component component) {
  return std::string(is_rotation(component) ? "rotation about " : "displacement along ") +
         "XYZ"[direction_of(component)];
}

/// "EAC, error motion of C: rotation about X"
std::string words_of(ErrorSymbol symbol) {
  return symbol.name() + ", error motion of " + letter_of(symbol.axis) + ": " + words_of(symbol.component);
}

/// "EC0Y, squareness of Y: rotation about Z"
std::string words_of(LocationSymbol location) {
  return location.name() + (is_rotary(location.axis) ? ", location error of " : ", squareness of ") +
         letter_of(location.axis) + ": " + words_of(location.component);
}

/// Lowest degree of an error function: the straight part of a straightness that is a squareness belongs to
/// that.
int lowest_degree(const Machine& machine, ErrorSymbol symbol) {
  const auto is_its_straight_part = [symbol](LocationSymbol location) {
    return motion_of_squareness(location).symbol == symbol;
  };
  return std::ranges::any_of(squareness_errors(machine), is_its_straight_part) ? 2 : 1;
}

/// Of rotary axes whole harmonics, cosine and sine together, as many as the places of the axis tell apart.
std::vector<Eigen::Index> orders_of(const Campaign& campaign, ErrorSymbol symbol, std::size_t amplitudes) {
  std::vector<Eigen::Index> orders;
  auto most = static_cast<Eigen::Index>(amplitudes);
  const Eigen::Index step = is_rotary(symbol.axis) ? 2 : 1;
  if (is_rotary(symbol.axis))
    most = std::min<Eigen::Index>(most, 2 * std::max(1, most_periods(places_in_turn(campaign, symbol.axis))));
  for (Eigen::Index order = step; order <= most; order += step) orders.push_back(order);
  return orders;
}

/// An error function.
std::unique_ptr<Effect> function(const Campaign& campaign, ErrorSymbol symbol) {
  std::vector<EffectAmplitude> amplitudes;
  const int lowest = lowest_degree(campaign.machine, symbol);
  for (int degree = lowest; degree <= kDegrees; ++degree) {
    const std::string number = "P" + std::to_string(degree);
    amplitudes.push_back({.label = part_label(words_of(symbol), number),
                          .target = {.kind = TargetKind::Motion, .symbol = symbol},
                          .key = number + "_" + std::string(edge_unit(symbol.component)),
                          .of = words_of(symbol),
                          .part = number});
  }
  return std::make_unique<FormulaEffect>(
      EffectName{kLeftOut, symbol, position_of(symbol.axis), "function"}, std::move(amplitudes),
      [position = OwnPosition(campaign, symbol.axis), lowest](
          const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        const Eigen::Index most = kDegrees - lowest + 1;
        Eigen::MatrixXd drivers(static_cast<Eigen::Index>(view.rows()), most);
        position.fill(view, lowest, shape.size() > 0 ? static_cast<Eigen::Index>(shape[0]) : most, drivers);
        return drivers;
      },
      [](const Campaign& /*campaign*/, const SourcePlace& /*place*/) {});
}

std::unique_ptr<Effect> squareness(LocationSymbol location) {
  const SquarenessMotion motion = motion_of_squareness(location);
  return std::make_unique<FormulaEffect>(
      EffectName{kLeftOut, location, position_of(location.axis), "squareness"},
      std::vector<EffectAmplitude>{{.label = words_of(location),
                                    .target = {.kind = TargetKind::Motion, .symbol = motion.symbol},
                                    .key = "amplitude_urad"}},
      [axis = location.axis, sign = motion.sign](const SetupView& view,
                                                 const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const auto& position = view.setup.readings.position[index_of(axis)];
        return sign *
               Eigen::Map<const Eigen::VectorXd>(position.data(), static_cast<Eigen::Index>(position.size()));
      },
      [](const Campaign& /*campaign*/, const SourcePlace& /*place*/) {});
}

/// A location error of a rotary axis: a constant motion of it (chain.h).
std::unique_ptr<Effect> axis_location(const Machine& machine, LocationSymbol location) {
  const auto joint = std::ranges::find(machine.structure.joints, location.axis, &Joint::axis);
  const double sign = rotary_location_sign(joint->workpiece_side, location.axis, location.component);
  return std::make_unique<FormulaEffect>(
      EffectName{kLeftOut, location, position_of(location.axis), "location"},
      std::vector<EffectAmplitude>{
          {.label = words_of(location),
           .target = {.kind = TargetKind::Motion, .symbol = {location.component, location.axis}},
           .key = "amplitude_" + std::string(edge_unit(location.component))}},
      [sign](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return constant(view, sign);
      },
      [](const Campaign& /*campaign*/, const SourcePlace& /*place*/) {});
}

/// Squareness, and of rotary axes that move the locations that readings can tell.
std::vector<LocationSymbol> locations_in_campaign(const Campaign& campaign) {
  std::vector<LocationSymbol> symbols = squareness_errors(campaign.machine);
  const std::vector<AxisName> moving = moving_rotary_axes(campaign);
  if (moving.empty()) return symbols;
  for (const LocationSymbol& symbol : independent_locations(campaign.machine)) {
    if (std::ranges::find(moving, symbol.axis) != moving.end()) symbols.push_back(symbol);
  }
  return symbols;
}

std::vector<ErrorSymbol> lacking_functions(const MeasurementModel& model) {
  std::vector<ErrorSymbol> symbols;
  for (const ErrorSymbol symbol : motions_in_campaign(model.campaign())) {
    const bool moved = OwnPosition(model.campaign(), symbol.axis).varies();
    if (moved && !model.layout().find(symbol)) symbols.push_back(symbol);
  }
  return symbols;
}

}  // namespace

std::vector<LeftOutError> left_out_errors(const MeasurementModel& model) {
  const Campaign& campaign = model.campaign();
  std::vector<LeftOutError> errors;
  for (const ErrorSymbol symbol : lacking_functions(model)) {
    std::unique_ptr<Effect> effect = function(campaign, symbol);
    std::vector<Eigen::Index> orders = orders_of(campaign, symbol, effect->amplitudes().size());
    errors.push_back({left_out_spec(symbol.name()), std::move(effect), std::move(orders)});
  }
  for (const LocationSymbol& location : locations_in_campaign(campaign)) {
    if (model.layout().find_location(location)) continue;
    errors.push_back(
        {left_out_spec(location.name()),
         is_rotary(location.axis) ? axis_location(campaign.machine, location) : squareness(location),
         {}});
  }
  return errors;
}

void state_order(Eigen::Index order, EffectSpec& spec) {
  const auto symbol = ErrorSymbol::parse(spec.options.text("symbol").value_or(""));
  if (symbol && is_rotary(symbol->axis) && order < kDegrees)
    spec.options.set(kHarmonics, static_cast<double>(order) / 2.0);
}

bool is_left_out(const MachineError& error, const ModelSpec& model) {
  if (const auto location = error.location())
    return std::ranges::find(model.locations_off, *location) != model.locations_off.end() ||
           (is_rotary(location->axis) && model.default_function.basis == kHeldAtZero &&
            !model.locations.contains(*location));
  const auto function = error.motion();
  return function && model.function(*function).basis == kHeldAtZero;
}

namespace {

/// In the usual basis of its axis, or in as many harmonics as were found.
void restore(ErrorSymbol symbol, const EffectSpec& spec, const Machine& machine, ModelSpec& model) {
  if (const auto harmonics = spec.options.number(kHarmonics)) {
    FunctionSpec function;
    function.basis = "fourier";
    function.degree = static_cast<int>(*harmonics);
    model.functions[symbol] = function;
  } else if (model.default_function.basis == kHeldAtZero) {
    model.functions[symbol] = usual_function(machine.axis(symbol.axis));
  } else {
    model.functions.erase(symbol);
  }
}

}  // namespace

bool restore_left_out(const EffectSpec& spec, const Machine& machine, ModelSpec& model) {
  if (spec.kind != kLeftOut) return false;
  for (const MachineError& error : errors_given_back(spec)) {
    if (const auto location = error.location()) {
      std::erase(model.locations_off, *location);
      if (is_rotary(location->axis)) model.locations.try_emplace(*location, 0.0);
    }
    const auto symbol = error.motion();
    if (symbol && is_left_out(error, model)) restore(*symbol, spec, machine, model);
  }
  return true;
}

}  // namespace volcal
