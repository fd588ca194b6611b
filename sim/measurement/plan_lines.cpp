#include <algorithm>
#include <array>

#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/measurement/plan_tools.h"
#include "volcal/sim/measurement/rotary_poses.h"

namespace volcal::sim {
namespace {

template <class Settings>
SetupPlan new_plan(const std::string& name, const std::string& instrument, const Settings& settings,
                   const PlanContext& context) {
  SetupPlan plan;
  plan.name = context.prefix + name;
  plan.instrument = instrument;
  plan.tool = context.tool(settings.tool);
  plan.noise = settings.noise;
  plan.seconds_per_reading = settings.seconds_per_reading;
  return plan;
}

template <class Settings>
void check_line(const Settings& settings, const PlanContext& context) {
  context.require_at_least(settings.points, 2, "points");
  context.require_at_least(settings.runs, 1, "runs");
}

void require_linear_axis(AxisName axis, const PlanContext& context) {
  if (is_rotary(axis))
    context.fail(std::string("axis ") + letter_of(axis) + " is rotary", "use X, Y or Z, or U, V, W");
  context.require_axis(axis);
}

std::vector<AxisName> axes_of(const std::vector<AxisName>& named, const PlanContext& context) {
  return named.empty() ? context.linear_axes() : named;
}

/// Start and end of a diagonal: each bit of `corner` says from which end its axis starts.
LineEnds diagonal(const Machine& machine, const Diagonals& settings, const std::array<bool, 3>& moves,
                  unsigned corner) {
  Eigen::Vector3d start = settings.at;
  Eigen::Vector3d end = settings.at;
  for (int k = 0; k < 3; ++k) {
    if (!moves[static_cast<std::size_t>(k)]) continue;
    const bool from_high = ((corner >> k) & 1U) != 0;
    start[k] = from_high ? 1.0 - settings.margin : settings.margin;
    end[k] = 1.0 - start[k];
  }
  return {at_fraction(machine, start), at_fraction(machine, end)};
}

/// Direction of approach as the name of a diagonal: "body_ppn" starts low in X and Y and high in Z.
std::string diagonal_name(const std::array<bool, 3>& moves, unsigned corner) {
  std::string name;
  for (std::size_t k = 0; k < 3; ++k) {
    if (moves[k]) name += ((corner >> k) & 1U) != 0 ? 'n' : 'p';
  }
  return name;
}

SetupPlan plan_diagonal(const Diagonals& settings, const PlanContext& context, const std::string& kind,
                        const std::array<bool, 3>& moves, unsigned corner) {
  const std::string name = (settings.steps ? "step_" : "") + kind + "_" + diagonal_name(moves, corner);
  SetupPlan plan = new_plan(name, kDisplacementReader, settings, context);
  const LineEnds ends = diagonal(context.machine, settings, moves, corner);
  plan.points =
      settings.steps
          ? step_path(ends.start, ends.end, settings.points, settings.runs, settings.bidirectional)
          : straight_path(ends.start, ends.end, settings.points, settings.runs, settings.bidirectional);
  Eigen::Vector3d beam;
  for (const AxisName axis : kLinearAxes) {
    beam[direction_of(axis)] = ends.end.position[index_of(axis)] - ends.start.position[index_of(axis)];
  }
  plan.options.set("direction", Eigen::Vector3d(beam.normalized()));
  RandomStream random(context.seed, "setup " + plan.name);
  plan.truth.offset = settings.offset_spread * random.normal();
  return plan;
}

/// Straightness of `axis` along `across` against an artefact turned by `rotation`.
template <class Settings>
SetupPlan plan_straightness_line(const std::string& name, AxisName axis, AxisName across,
                                 const Eigen::Vector3d& rotation, const Settings& settings,
                                 const PlanContext& context) {
  SetupPlan plan = new_plan(name, kStraightnessReader, settings, context);
  const LineEnds ends = axis_line(context.machine, axis, settings.at);
  plan.points = straight_path(ends.start, ends.end, settings.points, settings.runs, true);
  plan.options.set("direction", unit(across));
  plan.truth.artefact_rotation = rotation;
  RandomStream random(context.seed, "setup " + plan.name);
  plan.truth.offset = settings.offset_spread * random.normal();
  return plan;
}

/// The angle of a rotary axis about itself, between table and tool (ISO 230-2).
SetupPlan plan_rotary_angle(AxisName axis, const AngleLines& settings, const PlanContext& context) {
  context.require_axis(axis);
  if (settings.body != "relative")
    context.fail(std::string("the angle of the rotary axis ") + letter_of(axis) + " is asked for of one body",
                 "leave body out: it is read between table and tool");
  SetupPlan plan = new_plan(std::string("angle_") + letter_of(axis), kAngleReader, settings, context);
  const LineEnds ends = axis_line(context.machine, axis, settings.at);
  plan.points = straight_path(ends.start, ends.end, settings.points, settings.runs, true);
  plan.options.set("axis", rotary_direction_w(TruthMachine(context.machine), ends.start, axis));
  plan.options.set("body", settings.body);
  RandomStream random(context.seed, "setup " + plan.name);
  plan.truth.offset = settings.offset_spread * random.normal();
  return plan;
}

}  // namespace

std::vector<SetupPlan> plan_diagonals(const Diagonals& settings, const PlanContext& context) {
  check_line(settings, context);
  std::vector<SetupPlan> plans;
  if (settings.kind == Diagonals::Kind::Body) {
    if (context.linear_axes().size() < 3)
      context.fail("a machine of two linear axes has no body diagonals",
                   "measure the diagonals of its plane: diagonals = \"face\"");
    // From the four corners at the low end of Z; the other four are the same diagonals backwards.
    for (unsigned corner = 0; corner < 4; ++corner) {
      plans.push_back(plan_diagonal(settings, context, "body", {true, true, true}, corner));
    }
    return plans;
  }
  const std::array<std::array<bool, 3>, 3> planes = {
      {{true, true, false}, {false, true, true}, {true, false, true}}};
  const std::array<std::string, 3> names = {"face_XY", "face_YZ", "face_XZ"};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto stands = [&](AxisName axis) {
      return planes[i][index_of(axis)] && !context.machine.has_axis(axis);
    };
    if (std::ranges::any_of(kLinearAxes, stands)) continue;
    const unsigned lowest_axis = planes[i][0] ? 1U : 2U;
    for (const unsigned corner : {0U, lowest_axis}) {
      plans.push_back(plan_diagonal(settings, context, names[i], planes[i], corner));
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_axis_lines(const AxisLines& settings, const PlanContext& context) {
  check_line(settings, context);
  std::vector<SetupPlan> plans;
  for (const AxisName axis : axes_of(settings.axes, context)) {
    require_linear_axis(axis, context);
    SetupPlan plan = new_plan(std::string("line_") + letter_of(axis), kDisplacementReader, settings, context);
    const LineEnds ends = axis_line(context.machine, axis, settings.at);
    plan.points = straight_path(ends.start, ends.end, settings.points, settings.runs, true);
    plan.options.set("direction", unit(axis));
    RandomStream random(context.seed, "setup " + plan.name);
    plan.truth.offset = settings.offset_spread * random.normal();
    if (settings.offset_per_line) {
      plan.options.set("offset_per", std::string("line"));
      for (int line = 0; line < 2 * settings.runs; ++line) {
        plan.truth.line_offset[line] = settings.offset_spread * random.normal();
      }
    }
    plans.push_back(std::move(plan));
  }
  return plans;
}

std::vector<SetupPlan> plan_straightness(const StraightnessLines& settings, const PlanContext& context) {
  check_line(settings, context);
  std::vector<SetupPlan> plans;
  for (const AxisName axis : axes_of(settings.axes, context)) {
    require_linear_axis(axis, context);
    for (const AxisName across : kLinearAxes) {
      if (across == main_axis_of(axis)) continue;
      const std::string name = std::string("straightness_") + letter_of(axis) + letter_of(across);
      RandomStream random(context.seed, "artefact " + context.prefix + name);
      const Eigen::Vector3d rotation = settings.rotation_spread * random.normal_vector();
      plans.push_back(plan_straightness_line(name, axis, across, rotation, settings, context));
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_squares(const Squares& settings, const PlanContext& context) {
  check_line(settings, context);
  std::vector<SetupPlan> plans;
  for (const std::string& plane_name : context.planes_of(settings.planes)) {
    const Plane plane = parse_plane(plane_name, context);
    const std::string square = "square_" + plane_name;
    RandomStream random(context.seed, "artefact " + context.prefix + square);
    const Eigen::Vector3d rotation = settings.rotation_spread * random.normal_vector();
    for (const auto& [axis, across] :
         {std::pair(plane.first, plane.second), std::pair(plane.second, plane.first)}) {
      plans.push_back(plan_straightness_line(square + "_along_" + letter_of(axis), axis, across, rotation,
                                             settings, context));
      plans.back().options.set("reference", context.prefix + square);
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_angles(const AngleLines& settings, const PlanContext& context) {
  check_line(settings, context);
  if (settings.body != "relative" && settings.body != "tool" && settings.body != "table") {
    context.fail("\"" + settings.body + "\" is not a body", "use relative, tool or table");
  }
  std::vector<SetupPlan> plans;
  for (const AxisName axis : axes_of(settings.axes, context)) {
    if (is_rotary(axis)) {
      plans.push_back(plan_rotary_angle(axis, settings, context));
      continue;
    }
    require_linear_axis(axis, context);
    const LineEnds ends = axis_line(context.machine, axis, settings.at);
    for (const AxisName about : kLinearAxes) {
      const std::string name = std::string("angle_") + letter_of(axis) + "_about_" +
                               static_cast<char>(letter_of(about) - 'X' + 'x');
      SetupPlan plan = new_plan(name, kAngleReader, settings, context);
      plan.points = straight_path(ends.start, ends.end, settings.points, settings.runs, true);
      plan.options.set("axis", unit(about));
      plan.options.set("body", settings.body);
      RandomStream random(context.seed, "setup " + plan.name);
      plan.truth.offset = settings.offset_spread * random.normal();
      plans.push_back(std::move(plan));
    }
  }
  return plans;
}

std::vector<SetupPlan> plan_point_grid(const PointGrid& settings, const PlanContext& context) {
  for (const int count : settings.grid) context.require_at_least(count, 2, "grid");
  SetupPlan plan = new_plan("points", kVolumetricPoints, settings, context);
  const Eigen::Vector3i grid = counts_of_axes(context.machine, settings.grid);
  for (int k = 0; k < grid.z(); ++k) {
    for (int j = 0; j < grid.y(); ++j) {
      for (int i = 0; i < grid.x(); ++i) {
        const Eigen::Vector3d index(i, j, k);
        const Eigen::Vector3d last = (grid.array() - 1).max(1).cast<double>();
        plan.points.push_back(at_fraction(context.machine, index.cwiseQuotient(last)));
        plan.points.back().line = k * grid.y() + j;
      }
    }
  }
  if (settings.rotary != RotaryMotion::Home) {
    require_rotary_axes(context);
    RandomStream random(context.seed, "rotary positions of " + plan.name);
    add_rotary_motion(context.machine, settings.rotary, settings.rotary_grid, false, random, plan.points);
  }
  if (settings.parallel_moves) {
    RandomStream random(context.seed, "parallel axes of " + plan.name);
    add_parallel_motion(context.machine, false, random, plan.points);
  }
  plan.options.set("alignment", std::string(settings.rigid_alignment ? "rigid" : "none"));
  if (settings.rigid_alignment) {
    RandomStream random(context.seed, "setup " + plan.name);
    plan.truth.alignment.translation = settings.alignment_shift * random.normal_vector();
    plan.truth.alignment.rotation = settings.alignment_rotation * random.normal_vector();
  }
  return {plan};
}

}  // namespace volcal::sim
