#include "volcal/identify/criticism/catalogue/left_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/functions/legendre_polynomials.h"
#include "volcal/model/kinematics/location_sign.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

constexpr int kDegrees = 6;                  // of one function
constexpr int kSharedDegrees = 4;            // of each of several
constexpr const char* kHeldAtZero = "zero";  // a basis without functions

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

/// Polynomials of an axis' position over its measured range, of one that turns fully harmonics; zero at home.
class OwnPosition {
 public:
  OwnPosition(const Campaign& campaign, AxisName axis)
      : axis_(axis),
        periodic_(turns_fully(campaign.machine.axis(axis))),
        range_(measured_range(campaign, axis)),
        home_(values(campaign.machine.axis(axis).home)) {}

  bool varies() const { return range_.max > range_.min; }
  void fill(const SetupView& view, Eigen::Ref<Eigen::MatrixXd> columns) const {
    const auto& position = view.setup.readings.position[index_of(axis_)];
    for (Eigen::Index row = 0; row < columns.rows(); ++row) {
      const Polynomials values = this->values(position[static_cast<std::size_t>(row)]);
      for (Eigen::Index k = 0; k < columns.cols(); ++k) {
        const auto degree = static_cast<std::size_t>(k) + 1;
        columns(row, k) = values[degree] - home_[degree];
      }
    }
  }

 private:
  Polynomials values(double position) const {
    return periodic_ ? harmonics(position) : legendre(range_.scaled(position));
  }

  AxisName axis_;
  bool periodic_;
  MeasuredRange range_;
  Polynomials home_;
};

EffectSpec left_out_spec(const std::string& symbols) { return effect_spec(kLeftOut, {{"symbol", symbols}}); }

/// Functions of the given symbols, `degrees` amplitudes each.
std::unique_ptr<Effect> functions(const Campaign& campaign, const std::vector<ErrorSymbol>& symbols,
                                  int degrees, const EffectName& name, const std::string& label) {
  std::vector<EffectAmplitude> amplitudes;
  std::vector<OwnPosition> positions;
  for (const ErrorSymbol symbol : symbols) {
    positions.emplace_back(campaign, symbol.axis);
    const std::string own = symbols.size() > 1 ? symbol.name() + ":" : "";
    for (int degree = 1; degree <= degrees; ++degree) {
      const std::string number = std::to_string(degree);
      amplitudes.push_back({.label = label + " " + own + "P" + number,
                            .target = {.kind = TargetKind::Motion, .symbol = symbol},
                            .key = own + "P" + number + "_" + std::string(edge_unit(symbol.component))});
    }
  }
  return std::make_unique<FormulaEffect>(
      name, std::move(amplitudes),
      [positions, degrees](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        Eigen::MatrixXd drivers(static_cast<Eigen::Index>(view.rows()),
                                degrees * static_cast<Eigen::Index>(positions.size()));
        for (std::size_t i = 0; i < positions.size(); ++i) {
          positions[i].fill(view, drivers.middleCols(degrees * static_cast<Eigen::Index>(i), degrees));
        }
        return drivers;
      },
      [](const Campaign& /*campaign*/, const SourcePlace& /*place*/) {});
}

std::unique_ptr<Effect> squareness(LocationSymbol location) {
  const SquarenessMotion motion = motion_of_squareness(location);
  const std::string driver(1, lower_letter_of(location.axis));
  return std::make_unique<FormulaEffect>(
      EffectName{kLeftOut, location.name(), driver, "squareness"},
      std::vector<EffectAmplitude>{{.label = location.name() + " left out",
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
      EffectName{kLeftOut, location.name(), std::string(1, lower_letter_of(location.axis)), "location"},
      std::vector<EffectAmplitude>{
          {.label = location.name() + " left out",
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

std::string joined_names(const std::vector<ErrorSymbol>& symbols) {
  std::string text;
  for (const ErrorSymbol symbol : symbols) text += (text.empty() ? "" : " ") + symbol.name();
  return text;
}

}  // namespace

std::vector<LeftOutError> left_out_errors(const MeasurementModel& model) {
  const Campaign& campaign = model.campaign();
  std::vector<LeftOutError> errors;
  std::vector<ErrorSymbol> rotations;
  std::map<AxisName, std::vector<ErrorSymbol>> of_rotary_axis;
  for (const ErrorSymbol symbol : lacking_functions(model)) {
    if (is_rotary(symbol.axis)) of_rotary_axis[symbol.axis].push_back(symbol);
    if (is_rotation(symbol.component)) rotations.push_back(symbol);
    const EffectName name{kLeftOut, symbol.name(), std::string(1, lower_letter_of(symbol.axis)), "function"};
    errors.push_back({left_out_spec(symbol.name()),
                      functions(campaign, {symbol}, kDegrees, name, symbol.name() + " left out")});
  }
  const auto add_together = [&](const std::vector<ErrorSymbol>& symbols, const std::string& driver,
                                const std::string& label) {
    if (symbols.size() < 2) return;
    const std::string names = joined_names(symbols);
    errors.push_back({left_out_spec(names), functions(campaign, symbols, kSharedDegrees,
                                                      {kLeftOut, names, driver, "functions"}, label)});
  };
  add_together(rotations, "position", "rotations left out");
  for (const auto& [axis, symbols] : of_rotary_axis) {
    add_together(symbols, std::string(1, lower_letter_of(axis)),
                 std::string("error motions of ") + letter_of(axis) + " left out");
  }
  for (const LocationSymbol& location : locations_in_campaign(campaign)) {
    if (model.layout().find_location(location)) continue;
    errors.push_back({left_out_spec(location.name()), is_rotary(location.axis)
                                                          ? axis_location(campaign.machine, location)
                                                          : squareness(location)});
  }
  return errors;
}

bool is_left_out(const std::string& symbol, const ModelSpec& model) {
  if (const auto location = LocationSymbol::parse(symbol))
    return std::ranges::find(model.locations_off, *location) != model.locations_off.end() ||
           (is_rotary(location->axis) && model.default_function.basis == kHeldAtZero &&
            !model.locations.contains(*location));
  const auto function = ErrorSymbol::parse(symbol);
  return function && model.function(*function).basis == kHeldAtZero;
}

bool restore_left_out(const EffectSpec& spec, const Machine& machine, ModelSpec& model) {
  if (spec.kind != kLeftOut) return false;
  for (const std::string& name : left_out_symbols(spec)) {
    if (const auto location = LocationSymbol::parse(name)) {
      std::erase(model.locations_off, *location);
      if (is_rotary(location->axis)) model.locations.try_emplace(*location, 0.0);
    }
    const auto symbol = ErrorSymbol::parse(name);
    if (!symbol || !is_left_out(name, model)) continue;
    if (model.default_function.basis == kHeldAtZero) {
      model.functions[*symbol] = usual_function(machine.axis(symbol->axis));
    } else {
      model.functions.erase(*symbol);
    }
  }
  return true;
}

}  // namespace volcal
