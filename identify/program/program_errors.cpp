#include "volcal/identify/program/program_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/program/quartic.h"
#include "volcal/identify/program/sample_shares.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/parallel_axes.h"

namespace volcal {
namespace {

/// Bases of at most this many functions at a point are polynomials of degree 3 between their pieces, 4 with
/// the arm of an angle; others are cut into intervals shorter than half a wave of their highest function.
constexpr int kCubicSupport = 4;
constexpr int kIntervalsPerFunction = 2;

void add_pieces(const Basis& basis, std::vector<double>& ends) {
  const std::vector<double> pieces = basis.pieces();
  const int parts = basis.support() <= kCubicSupport ? 1 : kIntervalsPerFunction * basis.support();
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    for (int k = 0; k < parts; ++k) ends.push_back(pieces[i] + (pieces[i + 1] - pieces[i]) * k / parts);
  }
  if (!pieces.empty()) ends.push_back(pieces.back());
}

Eigen::Vector3d offset_of_tool(const Machine& machine, const std::string& tool) {
  if (tool.empty() && machine.tools.empty()) return Eigen::Vector3d::Zero();
  TableFormatOptions options;
  options.tool = tool;
  return tool_of(machine, options).offset;
}

AxisPosition axis_position_of(const Eigen::Vector3d& position) {
  return {position.x(), position.y(), position.z(), 0.0, 0.0, 0.0};
}

/// What the effects that vary with the position of one axis add to each error motion and to the tool's
/// offset.
class EffectsAlong {
 public:
  EffectsAlong(const MachineEffects& effects, const Eigen::VectorXd& parameters, AxisName axis)
      : effects_(effects.subset(varying_with(effects, axis))) {
    std::vector<std::string> targets;
    for (std::size_t c = 0; c < effects_.amplitude_count(); ++c) {
      const EffectColumn& column = effects_.columns()[c];
      const bool motion = column.target.kind == TargetKind::Motion;
      const std::string target =
          motion ? column.target.symbol.name() : std::to_string(column.target.component);
      const auto found = std::ranges::find(targets, target);
      target_of_.push_back(found - targets.begin());
      if (found == targets.end()) targets.push_back(target);
      amplitudes_.push_back(parameters[column.parameter]);
    }
    target_count_ = static_cast<Eigen::Index>(targets.size());
  }

  bool empty() const { return target_of_.empty(); }

  /// Positions x targets, m or rad.
  Eigen::MatrixXd at(std::span<const AxisPosition> positions,
                     std::span<const ApproachDirection> directions) const {
    const Eigen::MatrixXd drivers = effects_.drivers(positions, directions);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(drivers.rows(), target_count_);
    for (std::size_t c = 0; c < target_of_.size(); ++c)
      sums.col(target_of_[c]) += amplitudes_[c] * drivers.col(static_cast<Eigen::Index>(c));
    return sums;
  }

 private:
  static std::vector<std::size_t> varying_with(const MachineEffects& effects, AxisName axis) {
    std::vector<std::size_t> varying;
    for (std::size_t e = 0; e < effects.effect_count(); ++e) {
      if (effects.reach(e).position[index_of(axis)]) varying.push_back(e);
    }
    return varying;
  }

  MachineEffects effects_;
  std::vector<Eigen::Index> target_of_;  ///< by column
  std::vector<double> amplitudes_;
  Eigen::Index target_count_ = 0;
};

/// Intervals of an axis on which effects follow a polynomial of degree 4; finer ones than kShortestInterval
/// are not made.
class EffectIntervals {
 public:
  EffectIntervals(const MachineEffects& effects, const FitResult& result, AxisName axis)
      : effects_(effects, result.parameters, axis),
        shortest_period_(shortest_wave(result, axis)),
        machine_(result.machine),
        axis_(axis) {}

  void refine(std::vector<double>& ends) const {
    if (effects_.empty()) return;
    const Axis& of_machine = machine_.axis(axis_);
    ends.push_back(of_machine.travel_min);
    ends.push_back(of_machine.travel_max);
    std::ranges::sort(ends);
    std::vector<double> added;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) split(ends[i], ends[i + 1], added);
    ends.insert(ends.end(), added.begin(), added.end());
  }

 private:
  void split(double begin, double end, std::vector<double>& added) const {
    constexpr double kShortestInterval = 2e-4;  // m
    if (end - begin < kShortestInterval || added.size() > kMostIntervals || is_smooth(begin, end)) return;
    const double middle = 0.5 * (begin + end);
    added.push_back(middle);
    split(begin, middle, added);
    split(middle, end, added);
  }

  /// Looks at one place of the other axes first, where most of what is not smooth shows.
  bool is_smooth(double begin, double end) const {
    return 2.0 * (end - begin) < shortest_period_ && is_quartic(begin, end, 0, 1) &&
           is_quartic(begin, end, 1, kPlacesOfOthers);
  }

  /// Compares with the polynomial through five points at many others, with the other axes at the places from
  /// `first` to before `last`.
  bool is_quartic(double begin, double end, std::size_t first, std::size_t last) const {
    constexpr double kSame = 1e-3;     // of the largest value: splitting is to 0.1 um
    constexpr double kNothing = 1e-9;  // m or rad
    const std::size_t checks = checks_of(end - begin);
    std::vector<AxisPosition> positions;
    std::vector<ApproachDirection> directions;
    for (std::size_t place = first; place < last; ++place) {
      const auto add = [&](double share) {
        positions.push_back(position(place, begin + share * (end - begin)));
        directions.push_back(direction(place));
      };
      for (const double node : kQuarticNodes) add(node);
      for (std::size_t c = 0; c < checks; ++c) add(sample_share(place * checks + c));
    }
    const Eigen::MatrixXd values = effects_.at(positions, directions);
    const Eigen::RowVectorXd allowed = (kSame * values.cwiseAbs().colwise().maxCoeff()).cwiseMax(kNothing);
    for (std::size_t place = first; place < last; ++place) {
      const auto row = static_cast<Eigen::Index>((place - first) * (kQuarticNodes.size() + checks));
      for (std::size_t c = 0; c < checks; ++c) {
        const std::array<double, 5> weights = quartic_weights(sample_share(place * checks + c));
        const Eigen::RowVectorXd quartic =
            Eigen::Map<const Eigen::Matrix<double, 1, 5>>(weights.data()) * values.middleRows<5>(row);
        const auto at = row + static_cast<Eigen::Index>(kQuarticNodes.size() + c);
        if (((values.row(at) - quartic).cwiseAbs().array() > allowed.array()).any()) return false;
      }
    }
    return true;
  }

  /// At all places of the others together one every half millimetre, so that narrow ones are not missed.
  static std::size_t checks_of(double length) {
    constexpr double kBetween = 0.5e-3;  // m
    constexpr double kFewest = 4.0;
    return static_cast<std::size_t>(std::max(kFewest, std::ceil(length / (kBetween * kPlacesOfOthers))));
  }

  AxisPosition position(std::size_t place, double of_axis) const {
    constexpr std::array<double, 3> kSteps = {0.6180339887498949, 0.4142135623730951, 0.7320508075688773};
    AxisPosition position{};
    for (const Axis& other : machine_.axes) {
      if (is_rotary(other.name)) continue;
      const double share = std::fmod(
          (static_cast<double>(place) + 0.5) * kSteps[static_cast<std::size_t>(direction_of(other.name))],
          1.0);
      position[index_of(other.name)] = other.travel_min + share * other.travel();
    }
    position[index_of(axis_)] = of_axis;
    return position;
  }

  /// Every place has another combination.
  static ApproachDirection direction(std::size_t place) {
    ApproachDirection direction = kTowardsPlus;
    for (std::size_t k = 0; k < 3; ++k) {
      if ((place >> k & 1U) != 0) direction[k] = -1;
    }
    return direction;
  }

  static constexpr std::size_t kPlacesOfOthers = 8;
  static constexpr std::size_t kMostIntervals = 100000;
  EffectsAlong effects_;
  double shortest_period_;
  const Machine& machine_;
  AxisName axis_;
};

}  // namespace

FunctionalPoint functional_point(const Machine& machine, const std::string& tool,
                                 const std::string& lengths_from) {
  FunctionalPoint point;
  point.without_length = offset_of_tool(machine, tool);
  if (!lengths_from.empty()) point.lengths_from = offset_of_tool(machine, lengths_from);
  return point;
}

NcSetup nc_setup(const Machine& machine) {
  require_no_parallel_axes(machine, "the compensation of programs");
  NcSetup setup;
  for (const AxisName axis : kLinearAxes) {
    if (!machine.has_axis(axis))
      throw InputError({}, std::string("the machine has no axis ") + letter_of(axis),
                       "programs are compensated on machines with X, Y and Z");
    setup.home[direction_of(axis)] = machine.axis(axis).home;
  }
  return setup;
}

ProgramErrors program_errors(const FitResult& result, const std::string& tool_name,
                             const Conditions& conditions) {
  require_no_parallel_axes(result.machine, "the compensation of programs");
  auto identified = std::make_shared<FitResult>(result);  // what a field needs
  identified->covariance = {};
  identified->residuals.clear();
  identified->adjustment = nullptr;
  Tool tool;
  if (const auto index = result.machine.tool_index(tool_name)) tool = result.machine.tools[*index];
  ProgramErrors errors{.machine = result.machine,
                       .field =
                           [identified, tool, conditions](const Eigen::Vector3d& tool_offset) {
                             Tool at = tool;
                             at.offset = tool_offset;
                             return displacement_field(*identified, at, conditions);
                           },
                       .measured = MeasuredTravel(result),
                       .pieces = {}};
  for (const FunctionGroup& group : result.layout.groups) {
    if (!is_rotary(group.axis)) add_pieces(*group.basis, errors.pieces[index_of(group.axis)]);
  }
  const MachineEffects effects(result, tool, conditions);
  for (const AxisName axis : result.machine.main_linear_axes()) {
    auto& ends = errors.pieces[index_of(axis)];
    for (const double end : {errors.measured[axis].first, errors.measured[axis].last}) {
      if (std::isfinite(end)) ends.push_back(end);
    }
    EffectIntervals(effects, result, axis).refine(ends);
  }
  for (auto& ends : errors.pieces) {
    std::ranges::sort(ends);
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  }
  return errors;
}

void turn_directions(const Eigen::Vector3d& motion, ApproachDirection& directions) {
  constexpr double kStill = 1e-12;  // m
  for (std::size_t i = 0; i < 3; ++i) {
    const double moved = motion[static_cast<Eigen::Index>(i)];
    if (std::abs(moved) > kStill) directions[i] = moved > 0.0 ? 1 : -1;
  }
}

CommandSolver::CommandSolver(const Machine& machine, DisplacementField errors)
    : errors_(std::move(errors)), movable_(movable_directions(machine)) {}

Eigen::Vector3d CommandSolver::error(const Eigen::Vector3d& position,
                                     const ApproachDirection& directions) const {
  return errors_(axis_position_of(position), directions);
}

void CommandSolver::set_steepness(double steepness) {
  constexpr double kAccuracy = 1e-9;  // m
  constexpr double kSteepest = 0.5, kFlattest = 1e-6;
  last_step_ = kAccuracy;
  if (steepness < kSteepest) last_step_ *= (1.0 - steepness) / std::max(steepness, kFlattest);
}

Eigen::Vector3d CommandSolver::command(const Eigen::Vector3d& position, const ApproachDirection& directions) {
  constexpr int kMostSteps = 50;
  Eigen::Vector3d correction = last_correction_;
  for (int i = 0; i < kMostSteps; ++i) {
    const Eigen::Vector3d next = -movable_.cwiseProduct(error(position + correction, directions));
    const double step = (next - correction).norm();
    correction = next;
    if (step < last_step_) {
      last_correction_ = correction;
      return position + correction;
    }
  }
  throw std::runtime_error("the identified errors change too fast with position to be compensated");
}

}  // namespace volcal
