#include "volcal/sim/measurement/measurements.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/measurement/plan_tools.h"

namespace volcal::sim {
namespace {

struct Planner {
  const PlanContext& context;
  std::vector<SetupPlan> operator()(const Tracking& s) const { return plan_tracking(s, context); }
  std::vector<SetupPlan> operator()(const BallBarCircles& s) const { return plan_ball_bar(s, context); }
  std::vector<SetupPlan> operator()(const Diagonals& s) const { return plan_diagonals(s, context); }
  std::vector<SetupPlan> operator()(const AxisLines& s) const { return plan_axis_lines(s, context); }
  std::vector<SetupPlan> operator()(const StraightnessLines& s) const {
    return plan_straightness(s, context);
  }
  std::vector<SetupPlan> operator()(const Squares& s) const { return plan_squares(s, context); }
  std::vector<SetupPlan> operator()(const AngleLines& s) const { return plan_angles(s, context); }
  std::vector<SetupPlan> operator()(const PointGrid& s) const { return plan_point_grid(s, context); }
  std::vector<SetupPlan> operator()(const RTest& s) const { return plan_r_test(s, context); }
  std::vector<SetupPlan> operator()(const ProbedSphere& s) const { return plan_probed_sphere(s, context); }
  std::vector<SetupPlan> operator()(const BallBarPoses& s) const { return plan_ball_bar_poses(s, context); }
  std::vector<SetupPlan> operator()(const AxisOfRotation& s) const {
    return plan_axis_of_rotation(s, context);
  }
  std::vector<SetupPlan> operator()(const DriftAtRest& s) const { return plan_drift_at_rest(s, context); }
};

}  // namespace

std::size_t PlanContext::tool(const std::string& name) const {
  if (machine.tools.empty()) fail("the machine has no tool", "add a [tools.NAME] table to its file");
  if (name.empty()) return 0;
  const auto index = machine.tool_index(name);
  if (!index) fail("there is no tool \"" + name + "\"", "use a tool of the machine file");
  return *index;
}

void PlanContext::fail(const std::string& problem, const std::string& remedy) const {
  const std::string measurement =
      prefix.empty() ? "" : "measurement " + prefix.substr(0, prefix.size() - 1) + ": ";
  throw InputError(place, measurement + problem, remedy);
}

std::vector<AxisName> PlanContext::linear_axes() const {
  std::vector<AxisName> axes;
  for (const AxisName axis : kLinearAxes) {
    if (machine.has_axis(axis)) axes.push_back(axis);
  }
  return axes;
}

void PlanContext::require_axis(AxisName axis) const {
  if (machine.has_axis(axis)) return;
  fail(std::string("the machine has no axis ") + letter_of(axis), "name axes of its structure");
}

std::vector<std::string> PlanContext::planes_of(const std::vector<std::string>& named) const {
  if (!named.empty()) return named;
  std::vector<std::string> planes;
  for (const char* name : {"XY", "YZ", "ZX"}) {
    const std::string plane = name;
    if (std::ranges::all_of(plane, [&](char c) { return machine.has_axis(*axis_from_letter(c)); }))
      planes.push_back(plane);
  }
  return planes;
}

void PlanContext::require_at_least(int value, int least, const std::string& what) const {
  if (value < least) {
    fail(what + " is " + std::to_string(value), "it must be " + std::to_string(least) + " or more");
  }
}

Plane parse_plane(const std::string& name, const PlanContext& context) {
  if (name.size() == 2) {
    const auto first = axis_from_letter(name[0]);
    const auto second = axis_from_letter(name[1]);
    if (first && second && direction_of(*first) != direction_of(*second) && !is_rotary(*first) &&
        !is_rotary(*second)) {
      context.require_axis(*first);
      context.require_axis(*second);
      return {*first, *second};
    }
  }
  context.fail("\"" + name + "\" is not a plane", "write two of X, Y, Z, as in \"XY\"");
}

LineEnds axis_line(const Machine& machine, AxisName axis, const Eigen::Vector3d& at) {
  if (is_parallel(axis) || is_rotary(axis)) {
    LineEnds ends{at_fraction(machine, at), at_fraction(machine, at)};
    const Axis& own = machine.axis(axis);
    const std::array<double, 2> range =
        is_rotary(axis) ? rotary_range({}, own) : std::array{own.travel_min, own.travel_max};
    ends.start.position[index_of(axis)] = range[0];
    ends.end.position[index_of(axis)] = range[1];
    return ends;
  }
  Eigen::Vector3d low = at;
  Eigen::Vector3d high = at;
  low[direction_of(axis)] = 0.0;
  high[direction_of(axis)] = 1.0;
  return {at_fraction(machine, low), at_fraction(machine, high)};
}

Eigen::Vector3d stated_position(const Eigen::Vector3d& position, double millimetres) {
  const double steps_per_millimetre = std::round(1.0 / millimetres);
  const Eigen::Array3d steps = (position.array() / kMetrePerMillimetre * steps_per_millimetre).round();
  return (steps / steps_per_millimetre * kMetrePerMillimetre).matrix();
}

std::vector<SetupPlan> plan_setups(const Measurement& measurement, const Machine& machine,
                                   std::uint64_t seed) {
  const PlanContext context{machine, measurement.name.empty() ? "" : measurement.name + "_", seed,
                            measurement.place};
  if (context.linear_axes().size() < 2)
    context.fail("the machine has fewer than two of the axes X, Y and Z",
                 "simulate a machine with two linear axes or more: one axis alone has no frame");
  std::vector<SetupPlan> plans = std::visit(Planner{context}, measurement.settings);
  for (SetupPlan& plan : plans) {
    if (plan.unseen.empty()) {
      RandomStream random(seed, "unseen positions of " + plan.name);
      plan.unseen = points_between(plan.points, random);
    }
    if (!measurement.shuffled) continue;
    RandomStream random(seed, "line order of " + plan.name);
    shuffle_lines(random, plan);
  }
  return plans;
}

}  // namespace volcal::sim
