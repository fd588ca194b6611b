#include "volcal/identify/program/program_errors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/compensation/table_format.h"
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

/// Intervals of an axis on which the drivers of effects follow a polynomial of degree 4; finer ones than
/// kShortestInterval are not made.
class EffectIntervals {
 public:
  EffectIntervals(const MachineEffects& effects, const Machine& machine)
      : effects_(effects), machine_(machine) {}

  void refine(AxisName axis, std::vector<double>& ends) const {
    const bool depends = [&] {
      for (std::size_t e = 0; e < effects_.effect_count(); ++e) {
        if (effects_.reach(e).position[index_of(axis)]) return true;
      }
      return false;
    }();
    if (!depends) return;
    const Axis& of_machine = machine_.axis(axis);
    ends.push_back(of_machine.travel_min);
    ends.push_back(of_machine.travel_max);
    std::ranges::sort(ends);
    std::vector<double> added;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) split(axis, ends[i], ends[i + 1], added);
    ends.insert(ends.end(), added.begin(), added.end());
  }

 private:
  void split(AxisName axis, double begin, double end, std::vector<double>& added) const {
    constexpr double kShortestInterval = 2e-4;  // m
    if (end - begin < kShortestInterval || added.size() > kMostIntervals || is_smooth(axis, begin, end))
      return;
    const double middle = 0.5 * (begin + end);
    added.push_back(middle);
    split(axis, begin, middle, added);
    split(axis, middle, end, added);
  }

  /// Compares with the polynomial through five points at three others, the other axes at several places.
  bool is_smooth(AxisName axis, double begin, double end) const {
    constexpr std::array<double, 5> kFit = {0.0, 0.25, 0.5, 0.75, 1.0};
    constexpr std::array<double, 3> kCheck = {0.1, 0.4, 0.9};
    constexpr double kSame = 1e-3;  // of the largest driver: effects are micrometres, splitting is to 0.1 um
    double largest = 0.0, deviation = 0.0;
    for (const double share : {0.2, 0.7}) {
      std::vector<AxisPosition> positions;
      const auto add = [&](double of_interval) {
        AxisPosition position{};
        for (const Axis& other : machine_.axes) {
          if (!is_rotary(other.name))
            position[index_of(other.name)] = other.travel_min + share * other.travel();
        }
        position[index_of(axis)] = begin + of_interval * (end - begin);
        positions.push_back(position);
      };
      for (const double node : kFit) add(node);
      for (const double node : kCheck) add(node);
      const Eigen::MatrixXd drivers = effects_.drivers(positions, {&kTowardsPlus, 1});
      largest = std::max(largest, drivers.cwiseAbs().maxCoeff());
      for (std::size_t c = 0; c < kCheck.size(); ++c) {
        Eigen::RowVectorXd through = Eigen::RowVectorXd::Zero(drivers.cols());
        for (std::size_t i = 0; i < kFit.size(); ++i) {
          double weight = 1.0;
          for (std::size_t k = 0; k < kFit.size(); ++k) {
            if (k != i) weight *= (kCheck[c] - kFit[k]) / (kFit[i] - kFit[k]);
          }
          through += weight * drivers.row(static_cast<Eigen::Index>(i));
        }
        deviation = std::max(
            deviation,
            (drivers.row(static_cast<Eigen::Index>(kFit.size() + c)) - through).cwiseAbs().maxCoeff());
      }
    }
    return deviation <= kSame * largest;
  }

  static constexpr std::size_t kMostIntervals = 20000;
  const MachineEffects& effects_;
  const Machine& machine_;
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
  for (const AxisName axis : linear_axes_of(result.machine)) {
    auto& ends = errors.pieces[index_of(axis)];
    for (const double end : {errors.measured.min[index_of(axis)], errors.measured.max[index_of(axis)]}) {
      if (std::isfinite(end)) ends.push_back(end);
    }
    EffectIntervals(effects, result.machine).refine(axis, ends);
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
