#include "volcal/identify/program/program_errors.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "volcal/identify/tables/compensation.h"

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

AxisPosition axis_position_of(const Eigen::Vector3d& position) {
  return {position.x(), position.y(), position.z(), 0.0, 0.0, 0.0};
}

}  // namespace

ProgramErrors program_errors(const FitResult& result) {
  ProgramErrors errors;
  errors.machine = result.machine;
  auto identified = std::make_shared<FitResult>();  // what a field needs, without covariance and residuals
  identified->machine = result.machine;
  identified->layout = result.layout;
  identified->parameters = result.parameters;
  errors.field = [identified](const Eigen::Vector3d& tool_offset) {
    return identified_error_field(*identified, tool_offset);
  };
  for (const FunctionGroup& group : result.layout.groups) {
    if (!is_rotary(group.axis)) add_pieces(*group.basis, errors.pieces[index_of(group.axis)]);
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

CommandSolver::CommandSolver(const Machine& machine, ErrorField errors)
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
