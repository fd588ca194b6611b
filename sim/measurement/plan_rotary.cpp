#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/plan_tools.h"
#include "volcal/sim/measurement/rotary_poses.h"

namespace volcal::sim {
namespace {

constexpr std::size_t kFewestPoses = 6;
constexpr std::size_t kFewestPositions = 3;  // of a rotary axis that moves
constexpr std::size_t kMostTools = 3;

std::size_t positions_of(AxisName axis, const std::vector<CommandedPoint>& points) {
  std::set<double> positions;
  for (const CommandedPoint& point : points) positions.insert(point.position[index_of(axis)]);
  return positions.size();
}

/// Rotary axes of which the path takes enough positions and the points, of what is left of it, do not.
std::string axes_left_alone(const Machine& machine, const std::vector<CommandedPoint>& path,
                            const std::vector<CommandedPoint>& points) {
  std::string letters;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    const std::size_t wanted = std::min(kFewestPositions, positions_of(axis.name, path));
    if (positions_of(axis.name, points) < wanted) letters += letter_of(axis.name);
  }
  return letters;
}

std::string listed(const std::string& letters) {
  std::string text;
  for (const char letter : letters) text += (text.empty() ? "" : ", ") + std::string(1, letter);
  return text;
}

void require_enough(const std::vector<CommandedPoint>& path, const PlanContext& context,
                    const SetupPlan& plan, bool all_led_there) {
  const std::string alone = axes_left_alone(context.machine, path, plan.points);
  const std::size_t needed = std::min(kFewestPoses, path.size());
  if (plan.points.size() >= needed && alone.empty()) return;
  const std::vector<AxisName> follow = context.linear_axes();
  if (!all_led_there && follow.size() < 3)
    context.fail(
        std::string("the tool point of setup ") + plan.name + " does not stay on its sphere by " +
            letter_of(follow[0]) + " and " + letter_of(follow[1]) + " alone while rotary axes turn",
        "put the sphere into the plane of both axes and turn about its normal alone, or test one axis "
        "after another: kind = \"angle-lines\" and \"axis-of-rotation\"");
  std::string problem = "of " + std::to_string(path.size()) + " poses of setup " + plan.name + " " +
                        std::to_string(plan.points.size()) + " are within the travel of " +
                        (plan.left_out_by.empty() ? "X, Y, Z" : listed(plan.left_out_by));
  if (!alone.empty()) problem += ", with fewer than three positions of " + listed(alone);
  context.fail(problem, "put the sphere nearer to the rotary axes, use a shorter tool, or narrow range_deg");
}

/// Positions between those of a setup, at which the tool point stays where it shall.
std::vector<CommandedPoint> followed_between(const SetupPlan& plan, const Follower& follower,
                                             const PoseTarget& target, RandomStream& random) {
  std::vector<CommandedPoint> unseen = points_between(plan.points, random);
  for (std::size_t i = 0; i < unseen.size(); ++i) {
    const Eigen::Vector3d place = target(unseen[i]);
    const Follower::Pose pose = follower.at(unseen[i], place);
    unseen[i] = pose.outside.empty() ? pose.point : plan.points[i];
  }
  return unseen;
}

/// The points of a run as they are given.
void take_points(const RotaryPoses::Run& run, const SpherePlace& sphere, const PlanContext& context,
                 SetupPlan& plan) {
  if (run.points.empty()) context.fail("run " + run.name + " has no points", "name a file of positions");
  const TruthMachine nominal(context.machine);
  const Follower follower(nominal, context.machine.tools[plan.tool].offset);
  plan.points = run.points;
  RandomStream elsewhere(context.seed, "unseen positions of " + plan.name);
  plan.unseen = followed_between(
      plan, follower, [&](CommandedPoint&) { return sphere.position_w; }, elsewhere);
}

const SpherePlace& sphere_of(const RotaryPoses::Run& run, const RotaryPoses& poses,
                             const PlanContext& context) {
  const auto found = std::ranges::find(poses.spheres, run.sphere, &SpherePlace::name);
  if (found == poses.spheres.end())
    context.fail("run " + run.name + " names sphere \"" + run.sphere + "\", which is not listed",
                 "list it among the spheres");
  return *found;
}

/// Directions out of the sphere in which a kind of contact touches it, in the axes of the tool. The stylus
/// stands on the sphere's side of the spindle, along -z of the tool.
std::vector<Eigen::Vector3d> sides_of(const std::string& kind, const PlanContext& context) {
  if (kind == "W") return {Eigen::Vector3d::UnitZ()};
  if (kind == "U") return {Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()};
  if (kind == "V") return {Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY()};
  context.fail("\"" + kind + "\" is not a kind of contact",
               "list some of \"W\" (along the tool), \"U\" and \"V\" (across it)");
}

class SpherePlanner {
 public:
  SpherePlanner(const ProbedSphere& settings, const PlanContext& context)
      : settings_(settings), context_(context), nominal_(context.machine) {}

  SetupPlan centres(const SpherePlace& sphere, std::size_t tool) const {
    SetupPlan plan = new_plan(sphere, tool, "");
    follow_poses(
        settings_.poses.grid, [&](CommandedPoint&) { return sphere.position_w; }, context_, plan);
    return plan;
  }

  SetupPlan given_centres(const RotaryPoses::Run& run) const {
    const SpherePlace& sphere = sphere_of(run, settings_.poses, context_);
    SetupPlan plan = new_plan(sphere, context_.tool(run.tool), "");
    plan.name = context_.prefix + run.name;
    take_points(run, sphere, context_, plan);
    return plan;
  }

  SetupPlan contacts(const SpherePlace& sphere, std::size_t tool, const std::string& kind) const {
    SetupPlan plan = new_plan(sphere, tool, "_" + kind);
    plan.column_set = 1;
    plan.options.set("contact", context_.prefix + kind);
    plan.options.set("radius", settings_.radius);
    if (settings_.radius_sigma) plan.options.set("radius_sigma", *settings_.radius_sigma);
    RandomStream random(context_.seed, "contact " + context_.prefix + kind);
    plan.truth.contact_radius =
        settings_.radius + settings_.radius_sigma.value_or(settings_.radius_error) * random.normal();
    for (const Eigen::Vector3d& side : sides_of(kind, context_)) append_side(sphere, side, plan);
    return plan;
  }

 private:
  SetupPlan new_plan(const SpherePlace& sphere, std::size_t tool, const std::string& kind) const {
    SetupPlan plan;
    plan.name = context_.prefix + "probe_" + sphere.name + "_" + context_.machine.tools[tool].name + kind;
    plan.instrument = kProbedSphere;
    plan.tool = tool;
    plan.noise = settings_.noise;
    plan.seconds_per_reading = settings_.seconds_per_reading;
    plan.options.set("sphere", context_.prefix + sphere.name);
    RandomStream random(context_.seed, "sphere " + context_.prefix + sphere.name);
    plan.truth.sphere = sphere.position_w + settings_.place_error * random.normal_vector();
    return plan;
  }

  void append_side(const SpherePlace& sphere, const Eigen::Vector3d& side, SetupPlan& plan) const {
    SetupPlan touched;
    touched.name = plan.name;
    touched.tool = plan.tool;
    const PoseTarget tip = [&](CommandedPoint& rotary) -> Eigen::Vector3d {
      MachineState state;
      state.position = rotary.position;
      rotary.normal_w = nominal_.nominal_tool_axes(state) * side;
      return sphere.position_w + settings_.radius * rotary.normal_w;
    };
    follow_poses(settings_.poses.grid, tip, context_, touched);
    const std::int32_t lines = plan.points.empty() ? 0 : plan.points.back().line + 1;
    for (std::vector<CommandedPoint>* points : {&touched.points, &touched.unseen}) {
      for (CommandedPoint& point : *points) point.line += lines;
    }
    plan.points.insert(plan.points.end(), touched.points.begin(), touched.points.end());
    plan.unseen.insert(plan.unseen.end(), touched.unseen.begin(), touched.unseen.end());
    plan.poses_left_out += touched.poses_left_out;
    for (const char letter : touched.left_out_by) {
      if (plan.left_out_by.find(letter) == std::string::npos) plan.left_out_by += letter;
    }
  }

  const ProbedSphere& settings_;
  const PlanContext& context_;
  TruthMachine nominal_;
};

}  // namespace

void follow_poses(const RotaryGrid& grid, const PoseTarget& target, const PlanContext& context,
                  SetupPlan& plan) {
  const TruthMachine nominal(context.machine);
  const Follower follower(nominal, context.machine.tools[plan.tool].offset);
  RandomStream random(context.seed, "rotary positions of " + plan.name);
  const std::vector<CommandedPoint> path = rotary_path(context.machine, grid, random);
  std::set<char> outside;
  bool all_led_there = true;
  for (CommandedPoint rotary : path) {
    const Eigen::Vector3d place = target(rotary);
    Follower::Pose pose = follower.at(rotary, place);
    if (!pose.outside.empty()) {
      ++plan.poses_left_out;
      all_led_there = all_led_there && pose.leads_there;
      outside.insert(pose.outside.begin(), pose.outside.end());
      continue;
    }
    CommandedPoint before = pose.point;
    before.direction.fill(1);
    approach(plan.points.empty() ? before : plan.points.back(), pose.point);
    plan.points.push_back(pose.point);
  }
  plan.left_out_by.assign(outside.begin(), outside.end());
  require_enough(path, context, plan, all_led_there);
  RandomStream elsewhere(context.seed, "unseen positions of " + plan.name);
  plan.unseen = followed_between(plan, follower, target, elsewhere);
}

std::vector<std::size_t> tools_of(const RotaryPoses& poses, const PlanContext& context) {
  std::vector<std::size_t> tools;
  for (const std::string& name : poses.tools) tools.push_back(context.tool(name));
  if (!tools.empty()) return tools;
  context.tool("");
  for (std::size_t i = 0; i < std::min(kMostTools, context.machine.tools.size()); ++i) tools.push_back(i);
  return tools;
}

void require_rotary_axes(const PlanContext& context) {
  const auto& axes = context.machine.axes;
  if (std::ranges::any_of(axes, [](const Axis& axis) { return is_rotary(axis.name); })) return;
  context.fail("the machine has no rotary axis", "measure rotary axes on a machine with A, B or C");
}

void check_frame(const std::string& frame, const PlanContext& context) {
  if (frame == "workpiece" || frame == "tool" || frame == "machine") return;
  context.fail("\"" + frame + "\" is not a frame", "use workpiece, tool or machine");
}

void check_poses(const RotaryPoses& poses, const PlanContext& context) {
  require_rotary_axes(context);
  if (poses.spheres.empty())
    context.fail("no sphere is listed", "add a [[measurements.spheres]] table with name and position_mm");
  std::set<std::string> names;
  for (const SpherePlace& sphere : poses.spheres) {
    if (!names.insert(sphere.name).second)
      context.fail("two spheres are called " + sphere.name, "give every place a name of its own");
  }
  const auto check_axis = [&](AxisName axis) {
    if (is_rotary(axis) && context.machine.has_axis(axis)) return;
    context.fail(std::string(1, letter_of(axis)) + " is not a rotary axis of the machine",
                 "name A, B or C as the structure has them");
  };
  for (const auto& [axis, count] : poses.grid.points) {
    check_axis(axis);
    context.require_at_least(count, 1, std::string("number of positions of ") + letter_of(axis));
  }
  for (const auto& [axis, range] : poses.grid.range) {
    check_axis(axis);
    const Axis& described = context.machine.axis(axis);
    if (range[0] < range[1] && range[0] >= described.travel_min && range[1] <= described.travel_max) continue;
    context.fail(std::string("range_deg of ") + letter_of(axis) + " is not within its travel",
                 "give [from, to] within travel_deg");
  }
}

namespace {

SetupPlan new_r_test(const RTest& settings, const SpherePlace& sphere, std::size_t tool,
                     const PlanContext& context) {
  RandomStream random(context.seed, "sphere " + context.prefix + sphere.name);
  SetupPlan plan;
  plan.name = context.prefix + "rtest_" + sphere.name + "_" + context.machine.tools[tool].name;
  plan.instrument = kRTest;
  plan.tool = tool;
  plan.noise = settings.noise;
  plan.seconds_per_reading = settings.seconds_per_reading;
  plan.options.set("sphere", context.prefix + sphere.name);
  plan.options.set("frame", settings.frame);
  plan.truth.sphere = settings.offset_spread * random.normal_vector();
  return plan;
}

std::vector<SetupPlan> given_r_tests(const RTest& settings, const PlanContext& context) {
  std::vector<SetupPlan> plans;
  for (const RotaryPoses::Run& run : settings.poses.runs) {
    const SpherePlace& sphere = sphere_of(run, settings.poses, context);
    SetupPlan plan = new_r_test(settings, sphere, context.tool(run.tool), context);
    plan.name = context.prefix + run.name;
    take_points(run, sphere, context, plan);
    plans.push_back(std::move(plan));
  }
  return plans;
}

}  // namespace

std::vector<SetupPlan> plan_r_test(const RTest& settings, const PlanContext& context) {
  check_poses(settings.poses, context);
  check_frame(settings.frame, context);
  if (!settings.poses.runs.empty()) return given_r_tests(settings, context);
  std::vector<SetupPlan> plans;
  for (const SpherePlace& sphere : settings.poses.spheres) {
    for (const std::size_t tool : tools_of(settings.poses, context)) {
      SetupPlan plan = new_r_test(settings, sphere, tool, context);
      follow_poses(
          settings.poses.grid, [&](CommandedPoint&) { return sphere.position_w; }, context, plan);
      plans.push_back(std::move(plan));
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_probed_sphere(const ProbedSphere& settings, const PlanContext& context) {
  check_poses(settings.poses, context);
  const SpherePlanner planner(settings, context);
  std::vector<SetupPlan> plans;
  if (!settings.poses.runs.empty() && settings.contacts)
    context.fail("runs with their own positions are of centres",
                 "leave the runs or record = \"contacts\" out");
  if (settings.contacts && context.linear_axes().size() < 3)
    context.fail("a machine of two linear axes touches a sphere in their plane alone",
                 "record centres, or measure with kind = \"r-test\"");
  for (const RotaryPoses::Run& run : settings.poses.runs) plans.push_back(planner.given_centres(run));
  if (!plans.empty()) return plans;
  for (const SpherePlace& sphere : settings.poses.spheres) {
    for (const std::size_t tool : tools_of(settings.poses, context)) {
      if (!settings.contacts) plans.push_back(planner.centres(sphere, tool));
      for (const std::string& kind : settings.contacts ? settings.kinds : std::vector<std::string>{})
        plans.push_back(planner.contacts(sphere, tool, kind));
    }
  }
  return plans;
}

}  // namespace volcal::sim
