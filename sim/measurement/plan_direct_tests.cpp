/// Direct tests that a standard asks for: axis of rotation (ISO 230-7), drift at rest (ISO 230-3).

#include <algorithm>
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/measurement/plan_tools.h"
#include "volcal/sim/measurement/rotary_poses.h"

namespace volcal::sim {
namespace {

constexpr double kOnLine = 1e-3;        // m: a sphere is set up on a line to a millimetre
constexpr double kWithinTravel = 1e-9;  // m
constexpr double kLeastDuration = 1.0;  // s

/// The part of the machine between a rotary axis and the tool: nominal points of it are those that the axis
/// turns.
Machine beyond(const Machine& machine, AxisName axis) {
  Machine part = machine;
  auto& joints = part.structure.joints;
  joints.erase(joints.begin(), std::ranges::find(joints, axis, &Joint::axis) + 1);
  std::erase_if(part.axes, [&](const Axis& each) {
    return std::ranges::find(joints, each.name, &Joint::axis) == joints.end();
  });
  return part;
}

std::vector<AxisName> rotary_axes_of(const AxisOfRotation& settings, const PlanContext& context) {
  require_rotary_axes(context);
  std::vector<AxisName> axes = settings.axes;
  if (axes.empty()) {
    for (const Axis& axis : context.machine.axes) {
      if (is_rotary(axis.name)) axes.push_back(axis.name);
    }
  }
  for (const AxisName axis : axes) {
    context.require_axis(axis);
    if (!is_rotary(axis))
      context.fail(std::string("axis ") + letter_of(axis) + " is not a rotary axis", "name A, B or C");
  }
  return axes;
}

std::vector<std::size_t> tools_named(const std::vector<std::string>& names, const PlanContext& context) {
  std::vector<std::size_t> tools;
  for (const std::string& name : names) tools.push_back(context.tool(name));
  if (tools.empty()) tools.push_back(context.tool(""));
  return tools;
}

std::string in_millimetres(double length) {
  return std::to_string(static_cast<long>(std::lround(length / kMetrePerMillimetre)));
}

/// Brings tools onto the line of a rotary axis.
class LinePlanner {
 public:
  LinePlanner(const AxisOfRotation& settings, AxisName axis, const PlanContext& context)
      : settings_(settings), axis_(axis), context_(context), part_(beyond(context.machine, axis)) {}

  /// Heights of the sphere with a tool.
  std::vector<double> heights() const {
    if (!settings_.heights.empty()) return settings_.heights;
    return {0.0};
  }

  SetupPlan plan(std::size_t tool, double height) const {
    SetupPlan plan;
    plan.name = context_.prefix + "rotation_" + letter_of(axis_) + "_" + context_.machine.tools[tool].name;
    if (heights().size() > 1) plan.name += "_" + in_millimetres(height);
    plan.instrument = kRTest;
    plan.tool = tool;
    plan.noise = settings_.noise;
    plan.seconds_per_reading = settings_.seconds_per_reading;
    plan.options.set("sphere", plan.name);
    plan.options.set("frame", settings_.frame);
    plan.points = turned(on_line(tool, height));
    RandomStream random(context_.seed, "sphere " + plan.name);
    plan.truth.sphere = settings_.offset_spread * random.normal_vector();
    return plan;
  }

 private:
  /// All axes but the one that turns, at which the tool point stands on its line.
  CommandedPoint on_line(std::size_t tool, double height) const {
    const Eigen::Vector3d& offset = context_.machine.tools[tool].offset;
    const TruthMachine nominal(part_);
    CommandedPoint point = at_fraction(context_.machine, settings_.at);
    const Eigen::Vector3d line = unit(axis_);
    const Eigen::Vector3d wanted = context_.machine.axis(axis_).centre + height * line;
    point = Follower(nominal, offset).nearest(point, wanted);
    Eigen::Vector3d missed =
        nominal.nominal_point({point.position, point.direction, 0.0, {}}, offset) - wanted;
    if (settings_.heights.empty()) missed -= missed.dot(line) * line;
    require_reached(missed, tool);
    require_travel(point, height);
    return point;
  }

  void require_reached(const Eigen::Vector3d& missed, std::size_t tool) const {
    if (missed.norm() <= kOnLine) return;
    context_.fail(
        "tool " + context_.machine.tools[tool].name + " does not come onto the line of " + letter_of(axis_) +
            ": it stays " + in_millimetres(missed.norm()) + " mm away",
        "name a tool that stands on the line in tools, leave out heights_mm where no linear axis goes "
        "along it, name other axes in axes, or measure with the linear axes following: kind = "
        "\"r-test\"");
  }

  void require_travel(const CommandedPoint& point, double height) const {
    for (const Axis& axis : part_.axes) {
      const double q = point.position[index_of(axis.name)];
      if (is_rotary(axis.name) ||
          (q >= axis.travel_min - kWithinTravel && q <= axis.travel_max + kWithinTravel))
        continue;
      context_.fail("for a sphere " + in_millimetres(height) + " mm along the line of " + letter_of(axis_) +
                        " from its centre " + letter_of(axis.name) + " would stand at " + in_millimetres(q) +
                        " mm, beyond its travel",
                    "give other heights_mm or another tool");
    }
  }

  /// A turn in equal steps, its end being its start; of an axis that turns less, its travel.
  std::vector<CommandedPoint> turned(const CommandedPoint& on_line) const {
    const std::array<double, 2> range = rotary_range({}, context_.machine.axis(axis_));
    CommandedPoint start = on_line;
    CommandedPoint end = on_line;
    start.position[index_of(axis_)] = range[0];
    end.position[index_of(axis_)] =
        is_whole_turn(range) ? range[1] - (range[1] - range[0]) / settings_.points : range[1];
    return straight_path(start, end, settings_.points, settings_.runs, settings_.bidirectional);
  }

  const AxisOfRotation& settings_;
  AxisName axis_;
  const PlanContext& context_;
  Machine part_;
};

}  // namespace

std::vector<SetupPlan> plan_axis_of_rotation(const AxisOfRotation& settings, const PlanContext& context) {
  check_frame(settings.frame, context);
  context.require_at_least(settings.points, 3, "points");
  context.require_at_least(settings.runs, 1, "runs");
  std::vector<SetupPlan> plans;
  for (const AxisName axis : rotary_axes_of(settings, context)) {
    const LinePlanner planner(settings, axis, context);
    for (const std::size_t tool : tools_named(settings.tools, context)) {
      for (const double height : planner.heights()) plans.push_back(planner.plan(tool, height));
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_drift_at_rest(const DriftAtRest& settings, const PlanContext& context) {
  if (settings.duration < kLeastDuration || settings.seconds_per_reading <= 0.0 ||
      settings.seconds_per_reading > settings.duration)
    context.fail("the test of drift has no duration", "give duration_s, and a reading_s that is shorter");
  const auto count = static_cast<std::size_t>(settings.duration / settings.seconds_per_reading + 1e-9) + 1;
  std::vector<SetupPlan> plans;
  for (const std::size_t tool : tools_named(settings.tools, context)) {
    SetupPlan plan;
    plan.name = context.prefix + "drift_" + context.machine.tools[tool].name;
    plan.instrument = kRTest;
    plan.tool = tool;
    plan.noise = settings.noise;
    plan.seconds_per_reading = settings.seconds_per_reading;
    plan.options.set("sphere", plan.name);
    plan.options.set("frame", std::string("machine"));
    plan.points.assign(count, at_fraction(context.machine, settings.at));
    plan.unseen = plan.points;
    plan.with_setup_before = !plans.empty();
    RandomStream random(context.seed, "sphere " + plan.name);
    plan.truth.sphere = settings.offset_spread * random.normal_vector();
    plans.push_back(std::move(plan));
  }
  return plans;
}

}  // namespace volcal::sim
