#include <algorithm>
#include <numbers>

#include "volcal/sim/paths.h"
#include "volcal/sim/plan_tools.h"
#include "volcal/sim/truth_machine.h"

namespace volcal::sim {
namespace {

constexpr double kUsualRadius = 0.15;
constexpr double kLargestShareOfTravel = 0.45;

double radius_of(const BallBarCircles& settings, const Machine& machine) {
  if (settings.radius > 0.0) return settings.radius;
  double radius = kUsualRadius;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) radius = std::min(radius, kLargestShareOfTravel * axis.travel());
  }
  return radius;
}

/// Run 0 is clockwise, run 1 counter-clockwise; `rate` in rad/s.
void set_velocities(const Plane& plane, const CommandedPoint& centre, double rate,
                    std::vector<CommandedPoint>& points) {
  const std::size_t first = index_of(plane.first);
  const std::size_t second = index_of(plane.second);
  for (CommandedPoint& point : points) {
    const double turn = point.run == 0 ? -rate : rate;
    point.velocity[first] = -turn * (point.position[second] - centre.position[second]);
    point.velocity[second] = turn * (point.position[first] - centre.position[first]);
  }
}

}  // namespace

std::vector<SetupPlan> plan_ball_bar(const BallBarCircles& settings, const PlanContext& context) {
  context.require_at_least(settings.points_per_turn, 8, "points_per_turn");
  const double radius = radius_of(settings, context.machine);
  const double step = 2.0 * std::numbers::pi * radius / settings.points_per_turn;
  const double feed = settings.feed > 0.0 ? settings.feed : step / settings.seconds_per_reading;
  const double seconds_per_reading = step / feed;
  const CommandedPoint centre = at_fraction(context.machine, settings.at);
  const std::size_t tool = context.tool(settings.tool);
  const Eigen::Vector3d centre_w =
      TruthMachine(context.machine)
          .nominal_point({centre.position, centre.direction, 0.0, {}}, context.machine.tools[tool].offset);
  std::vector<SetupPlan> plans;
  for (const std::string& plane_name : settings.planes) {
    const Plane plane = parse_plane(plane_name, context);
    for (const AxisName name : {plane.first, plane.second}) {
      const Axis& axis = context.machine.axis(name);
      const double q = centre.position[index_of(name)];
      if (q - radius < axis.travel_min || q + radius > axis.travel_max) {
        context.fail("the circle in " + plane_name + " leaves the travel of " + letter_of(name),
                     "choose a smaller radius or another centre");
      }
    }
    SetupPlan plan;
    plan.name = context.prefix + "ballbar_" + plane_name;
    plan.instrument = "ball-bar";
    plan.tool = tool;
    plan.points = circular_path(centre, plane.first, plane.second, radius, settings.points_per_turn);
    plan.noise = settings.noise;
    plan.seconds_per_reading = seconds_per_reading;
    plan.records_feed = settings.records_feed;
    set_velocities(plane, centre, feed / radius, plan.points);
    RandomStream random(context.seed, "setup " + plan.name);
    plan.truth.centre = centre_w;
    const Eigen::Vector3d guess = centre_w + settings.centre_error * random.normal_vector();
    plan.options.set("centre", stated_position(guess, 0.001));
    const double length_error = settings.length_sigma.value_or(settings.length_error) * random.normal();
    plan.truth.length_error = length_error;
    if (settings.length_sigma) plan.options.set("length_sigma", *settings.length_sigma);
    plans.push_back(std::move(plan));
  }
  return plans;
}

}  // namespace volcal::sim
