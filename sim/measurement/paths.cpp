#include "volcal/sim/measurement/paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace volcal::sim {
namespace {

/// The same positions in reverse order, approached from the other side.
std::vector<CommandedPoint> returning(const std::vector<CommandedPoint>& forward) {
  std::vector<CommandedPoint> back(forward.rbegin(), forward.rend());
  for (CommandedPoint& point : back) {
    for (std::int8_t& direction : point.direction) direction = static_cast<std::int8_t>(-direction);
  }
  return back;
}

/// Repeats a pass (its axes' directions known) forward and back as numbered lines.
std::vector<CommandedPoint> repeated(const std::vector<CommandedPoint>& forward, int runs,
                                     bool bidirectional) {
  std::vector<CommandedPoint> path;
  std::int32_t line = 0;
  const auto append = [&](std::vector<CommandedPoint> pass, int run) {
    for (CommandedPoint& point : pass) {
      point.line = line;
      point.run = run;
    }
    ++line;
    path.insert(path.end(), pass.begin(), pass.end());
  };
  for (int run = 0; run < runs; ++run) {
    append(forward, run);
    if (!bidirectional) continue;
    std::vector<CommandedPoint> back = returning(forward);
    for (std::size_t k = 0; k < kAxisCount; ++k) {
      if (forward.front().position[k] != forward.back().position[k]) continue;
      for (CommandedPoint& point : back) point.direction[k] = 1;
    }
    append(std::move(back), run);
  }
  return path;
}

/// Commanded positions of the NC program have three decimals of a millimetre.
double programmed(double position) {
  constexpr double kStepsPerMetre = 1e6;
  return std::round(position * kStepsPerMetre) / kStepsPerMetre;
}

CommandedPoint between(const CommandedPoint& start, const CommandedPoint& end, double fraction) {
  CommandedPoint point = start;
  for (std::size_t k = 0; k < kAxisCount; ++k) {
    const double move = end.position[k] - start.position[k];
    point.position[k] = fraction == 1.0 ? end.position[k] : start.position[k] + fraction * move;
    point.direction[k] = move < 0.0 ? std::int8_t{-1} : std::int8_t{1};
  }
  return point;
}

}  // namespace

void approach(const CommandedPoint& from, CommandedPoint& to) {
  constexpr double kResting = 1e-12;
  for (std::size_t k = 0; k < kAxisCount; ++k) {
    const double move = to.position[k] - from.position[k];
    to.direction[k] =
        std::abs(move) < kResting ? from.direction[k] : static_cast<std::int8_t>(move > 0 ? 1 : -1);
  }
}

CommandedPoint at_fraction(const Machine& machine, const Eigen::Vector3d& fraction) {
  CommandedPoint point;
  point.direction.fill(1);
  for (const Axis& axis : machine.axes) {
    const bool stands = is_rotary(axis.name) || is_parallel(axis.name);
    const double share = stands ? 0.0 : fraction[direction_of(axis.name)];
    point.position[index_of(axis.name)] = stands ? axis.home : axis.travel_min + share * axis.travel();
  }
  return point;
}

std::vector<CommandedPoint> straight_path(const CommandedPoint& start, const CommandedPoint& end, int count,
                                          int runs, bool bidirectional) {
  std::vector<CommandedPoint> forward;
  forward.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    forward.push_back(between(start, end, static_cast<double>(i) / (count - 1)));
  }
  return repeated(forward, runs, bidirectional);
}

std::vector<CommandedPoint> step_path(const CommandedPoint& start, const CommandedPoint& end, int steps,
                                      int runs, bool bidirectional) {
  std::vector<CommandedPoint> forward = {between(start, end, 0.0)};
  for (int step = 1; step <= steps; ++step) {
    const CommandedPoint corner = between(start, end, static_cast<double>(step) / steps);
    for (const AxisName axis : kLinearAxes) {
      const std::size_t k = index_of(axis);
      if (start.position[k] == end.position[k]) continue;
      CommandedPoint next = forward.back();
      next.position[k] = corner.position[k];
      forward.push_back(next);
    }
  }
  return repeated(forward, runs, bidirectional);
}

std::vector<CommandedPoint> circular_path(const CommandedPoint& centre, AxisName first, AxisName second,
                                          double radius, int points_per_turn) {
  const double step = 2.0 * std::numbers::pi / points_per_turn;
  const auto at = [&](int i) {
    CommandedPoint point = centre;
    point.position[index_of(first)] += radius * std::cos(i * step);
    point.position[index_of(second)] += radius * std::sin(i * step);
    return point;
  };
  std::vector<CommandedPoint> path;
  for (const int sense : {-1, 1}) {
    CommandedPoint previous = at(-2 * sense);
    for (int i = -1; i <= points_per_turn; ++i) {
      CommandedPoint point = at(sense * i);
      approach(previous, point);
      point.line = point.run = sense < 0 ? 0 : 1;
      if (i >= 0) path.push_back(point);
      previous = point;
    }
  }
  return path;
}

Eigen::Vector3i counts_of_axes(const Machine& machine, Eigen::Vector3i counts) {
  for (const AxisName axis : kLinearAxes) {
    if (!machine.has_axis(axis)) counts[direction_of(axis)] = 1;
  }
  return counts;
}

std::vector<CommandedPoint> jittered_grid_path(const Machine& machine, const Eigen::Vector3i& per_axis,
                                               double jitter, RandomStream& random) {
  const Eigen::Vector3i count = counts_of_axes(machine, per_axis);
  std::vector<CommandedPoint> forward;
  CommandedPoint previous = at_fraction(machine, Eigen::Vector3d::Zero());
  std::int32_t line = 0;
  for (int k = 0; k < count.z(); ++k) {
    for (int row = 0; row < count.y(); ++row) {
      const int j = k % 2 == 0 ? row : count.y() - 1 - row;
      for (int column = 0; column < count.x(); ++column) {
        const int i = line % 2 == 0 ? column : count.x() - 1 - column;
        CommandedPoint point = previous;
        const Eigen::Vector3i index{i, j, k};
        for (const AxisName name : kLinearAxes) {
          if (!machine.has_axis(name)) continue;
          const Axis& axis = machine.axis(name);
          const int d = direction_of(name);
          const double step = axis.travel() / (count[d] - 1);
          const double q = axis.travel_min + step * (index[d] + jitter * random.uniform(-1.0, 1.0));
          point.position[index_of(name)] = std::clamp(programmed(q), axis.travel_min, axis.travel_max);
        }
        approach(previous, point);
        point.line = line;
        forward.push_back(point);
        previous = point;
      }
      ++line;
    }
  }
  std::vector<CommandedPoint> path = forward;
  for (CommandedPoint& point : returning(forward)) {
    point.line = 2 * line - 1 - point.line;
    point.run = 1;
    path.push_back(point);
  }
  return path;
}

std::vector<CommandedPoint> points_between(const std::vector<CommandedPoint>& points, RandomStream& random) {
  constexpr double kNearest = 0.15;
  const auto same_line = [&](std::size_t i, std::size_t j) {
    return points[i].line == points[j].line && points[i].run == points[j].run;
  };
  std::vector<CommandedPoint> between_points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double share = random.uniform(kNearest, 1.0 - kNearest);
    const bool has_next = i + 1 < points.size() && same_line(i, i + 1);
    const bool has_previous = i > 0 && same_line(i - 1, i);
    const std::size_t from = has_next || !has_previous ? i : i - 1;
    const std::size_t to = has_next ? i + 1 : i;
    CommandedPoint point = points[to];
    for (std::size_t k = 0; k < kAxisCount; ++k) {
      const double start = points[from].position[k];
      point.position[k] = programmed(start + share * (points[to].position[k] - start));
      point.velocity[k] =
          points[from].velocity[k] + share * (points[to].velocity[k] - points[from].velocity[k]);
    }
    between_points.push_back(point);
  }
  return between_points;
}

void shuffle_lines(RandomStream& random, SetupPlan& plan) {
  std::vector<std::vector<std::size_t>> lines;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    if (i == 0 || plan.points[i].line != plan.points[i - 1].line) lines.emplace_back();
    lines.back().push_back(i);
  }
  for (std::size_t i = lines.size(); i > 1; --i) {
    const auto j = static_cast<std::size_t>(random.uniform() * static_cast<double>(i));
    std::swap(lines[i - 1], lines[j]);
  }
  const auto in_new_order = [&](std::vector<CommandedPoint>& points) {
    if (points.size() != plan.points.size()) return;
    std::vector<CommandedPoint> ordered;
    for (const auto& line : lines) {
      for (const std::size_t i : line) ordered.push_back(points[i]);
    }
    points = std::move(ordered);
  };
  in_new_order(plan.unseen);
  in_new_order(plan.points);
}

std::vector<CommandedPoint> random_points(const Machine& machine, int count, RandomStream& random,
                                          RotaryMotion rotary) {
  std::vector<CommandedPoint> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform();
    const double y = random.uniform();
    const double z = random.uniform();
    points.push_back(at_fraction(machine, {x, y, z}));
    points.back().direction.fill(0);
    for (const AxisName axis : kLinearAxes) {
      double& q = points.back().position[index_of(axis)];
      q = programmed(q);
    }
    if (rotary == RotaryMotion::Home) continue;
    for (const Axis& axis : machine.axes) {
      if (!is_rotary(axis.name)) continue;
      points.back().position[index_of(axis.name)] = random.uniform(axis.travel_min, axis.travel_max);
    }
  }
  return points;
}

void add_parallel_motion(const Machine& machine, bool there_and_back, RandomStream& random,
                         std::vector<CommandedPoint>& points) {
  const std::size_t half = there_and_back ? points.size() / 2 : points.size();
  for (const AxisName name : machine.parallel_axes()) {
    const Axis& axis = machine.axis(name);
    const std::size_t k = index_of(name);
    for (std::size_t i = 0; i < half; ++i) {
      CommandedPoint& point = points[i];
      point.position[k] = std::clamp(programmed(random.uniform(axis.travel_min, axis.travel_max)),
                                     axis.travel_min, axis.travel_max);
      if (i > 0 && point.direction[k] != 0)
        point.direction[k] = point.position[k] < points[i - 1].position[k] ? std::int8_t{-1} : std::int8_t{1};
      if (!there_and_back) continue;
      CommandedPoint& back = points[points.size() - 1 - i];
      back.position[k] = point.position[k];
      back.direction[k] = static_cast<std::int8_t>(-point.direction[k]);
    }
  }
}

}  // namespace volcal::sim
