#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "volcal/model/description/units.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/measurement/plan_tools.h"

namespace volcal::sim {
namespace {

constexpr double kUsualRadius = 0.15;
constexpr double kLargestShareOfTravel = 0.45;
constexpr double kStroke = 2e-3;  // m, between the shortest and the longest that a bar telescopes to

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

/// Speed on the way from the position before to the position behind, on the same line.
void set_velocities_along(double seconds_per_reading, std::vector<CommandedPoint>& points) {
  const auto same_line = [&](std::size_t i, std::size_t j) {
    return points[i].line == points[j].line && points[i].run == points[j].run;
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t from = i > 0 && same_line(i - 1, i) ? i - 1 : i;
    const std::size_t to = i + 1 < points.size() && same_line(i, i + 1) ? i + 1 : i;
    const double time = seconds_per_reading * static_cast<double>(to - from);
    if (!(time > 0.0)) continue;
    for (std::size_t k = 0; k < kAxisCount; ++k)
      points[i].velocity[k] = (points[to].position[k] - points[from].position[k]) / time;
  }
}

class BallBarPlanner {
 public:
  BallBarPlanner(const BallBarCircles& settings, const PlanContext& context)
      : settings_(settings), context_(context), nominal_(context.machine) {}

  SetupPlan circle(const std::string& plane_name) const {
    const Machine& machine = context_.machine;
    const double radius = radius_of(settings_, machine);
    const double step = 2.0 * std::numbers::pi * radius / settings_.points_per_turn;
    const double feed = settings_.feed > 0.0 ? settings_.feed : step / settings_.seconds_per_reading;
    const CommandedPoint centre = at_fraction(machine, settings_.at);
    const Plane plane = parse_plane(plane_name, context_);
    require_within_travel(plane_name, plane, centre, radius);
    SetupPlan plan;
    plan.name = context_.prefix + "ballbar_" + plane_name;
    plan.tool = context_.tool(settings_.tool);
    plan.points = circular_path(centre, plane.first, plane.second, radius, settings_.points_per_turn);
    plan.seconds_per_reading = step / feed;
    set_velocities(plane, centre, feed / radius, plan.points);
    set_up(point_w(centre, plan.tool), plan);
    return plan;
  }

  SetupPlan as_given(const BallBarCircles::Run& run) const {
    SetupPlan plan;
    plan.name = context_.prefix + run.name;
    plan.tool = tool_of(run);
    plan.points = run.points;
    plan.seconds_per_reading = settings_.seconds_per_reading;
    require_within_stroke(run, plan.tool);
    set_velocities_along(settings_.seconds_per_reading, plan.points);
    set_up(run.centre_w, plan);
    return plan;
  }

  SetupPlan at_poses(const BallBarPoses& settings, const SpherePlace& place, std::size_t tool,
                     const std::string& direction) const {
    const auto component = static_cast<int>(std::string("xyz").find(direction));
    SetupPlan plan;
    plan.name =
        context_.prefix + "bar_" + place.name + "_" + context_.machine.tools[tool].name + "_" + direction;
    plan.tool = tool;
    plan.seconds_per_reading = settings_.seconds_per_reading;
    const PoseTarget ball = [&](CommandedPoint& rotary) -> Eigen::Vector3d {
      MachineState state;
      state.position = rotary.position;
      return place.position_w +
             settings.length * axes_of_frame(nominal_, state, settings.frame).col(component);
    };
    follow_poses(settings.poses.grid, ball, context_, plan);
    set_velocities_along(settings_.seconds_per_reading, plan.points);
    set_up(place.position_w, plan);
    return plan;
  }

 private:
  Eigen::Vector3d point_w(const CommandedPoint& point, std::size_t tool) const {
    return nominal_.nominal_point({point.position, point.direction, 0.0, {}},
                                  context_.machine.tools[tool].offset);
  }

  std::size_t tool_of(const BallBarCircles::Run& run) const {
    PlanContext own = context_;
    own.place = run.place;
    return own.tool(run.tool);
  }

  void require_within_travel(const std::string& plane_name, const Plane& plane, const CommandedPoint& centre,
                             double radius) const {
    for (const AxisName name : {plane.first, plane.second}) {
      const Axis& axis = context_.machine.axis(name);
      const double q = centre.position[index_of(name)];
      if (q - radius < axis.travel_min || q + radius > axis.travel_max) {
        context_.fail("the circle in " + plane_name + " leaves the travel of " + letter_of(name),
                      "choose a smaller radius or another centre");
      }
    }
  }

  void require_within_stroke(const BallBarCircles::Run& run, std::size_t tool) const {
    const auto refuse = [&](const std::string& problem, const std::string& remedy) {
      throw InputError(run.place, "run " + run.name + " " + problem, remedy);
    };
    if (run.points.empty()) refuse("has no positions", "name a file of them: points = \"run.csv\"");
    double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
    for (const CommandedPoint& point : run.points) {
      const double length = (point_w(point, tool) - run.centre_w).norm();
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    if (longest - shortest <= kStroke && shortest > kStroke) return;
    const auto in_mm = [](double length) {
      return std::to_string(static_cast<int>(std::lround(length / kMetrePerMillimetre)));
    };
    refuse("has positions from " + in_mm(shortest) + " to " + in_mm(longest) +
               " mm from its centre ball, which is not within the stroke of a bar",
           "give positions on a circle or sphere about centre_mm, for the tool's functional point");
  }

  /// What the campaign file does not know: where the centre ball is exactly, and how long the bar.
  void set_up(const Eigen::Vector3d& centre_w, SetupPlan& plan) const {
    plan.instrument = kBallBar;
    plan.noise = settings_.noise;
    plan.records_feed = settings_.records_feed;
    RandomStream random(context_.seed, "setup " + plan.name);
    plan.truth.centre = centre_w;
    const Eigen::Vector3d guess = centre_w + settings_.centre_error * random.normal_vector();
    plan.options.set("centre", stated_position(guess, 0.001));
    plan.truth.length_error = settings_.length_sigma.value_or(settings_.length_error) * random.normal();
    if (settings_.length_sigma) plan.options.set("length_sigma", *settings_.length_sigma);
  }

  const BallBarCircles& settings_;
  const PlanContext& context_;
  TruthMachine nominal_;
};

}  // namespace

std::vector<SetupPlan> plan_ball_bar_poses(const BallBarPoses& settings, const PlanContext& context) {
  check_poses(settings.poses, context);
  check_frame(settings.frame, context);
  if (!(settings.length > 0.0)) context.fail("the bar has no length", "give length_mm, such as 100");
  for (const std::string& direction : settings.directions) {
    if (direction != "x" && direction != "y" && direction != "z")
      context.fail("\"" + direction + "\" is not a direction of a bar", "list some of \"x\", \"y\", \"z\"");
  }
  const BallBarPlanner planner(settings.bar, context);
  std::vector<SetupPlan> plans;
  for (const SpherePlace& place : settings.poses.spheres) {
    for (const std::size_t tool : tools_of(settings.poses, context)) {
      for (const std::string& direction : settings.directions)
        plans.push_back(planner.at_poses(settings, place, tool, direction));
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_ball_bar(const BallBarCircles& settings, const PlanContext& context) {
  context.require_at_least(settings.points_per_turn, 8, "points_per_turn");
  const BallBarPlanner planner(settings, context);
  std::vector<SetupPlan> plans;
  for (const BallBarCircles::Run& run : settings.runs) plans.push_back(planner.as_given(run));
  if (!plans.empty()) return plans;
  for (const std::string& plane : context.planes_of(settings.planes)) plans.push_back(planner.circle(plane));
  return plans;
}

}  // namespace volcal::sim
