#include "volcal/identify/errors/volume/volume_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "volcal/model/kinematics/chain.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

/// Every combination of these shares of the travel of these linear axes, others at home.
std::vector<AxisPosition> at_shares(const Machine& machine, const std::vector<AxisName>& axes,
                                    const std::vector<double>& shares) {
  std::vector<AxisPosition> positions = {home_of(machine)};
  for (const AxisName name : axes) {
    const Axis& axis = machine.axis(name);
    std::vector<AxisPosition> extended;
    for (const AxisPosition& position : positions) {
      for (const double share : shares) {
        AxisPosition next = position;
        next[index_of(name)] = axis.travel_min + axis.travel() * share;
        extended.push_back(next);
      }
    }
    positions = std::move(extended);
  }
  return positions;
}

std::vector<double> middles(int cells) {
  std::vector<double> shares;
  for (int i = 0; i < cells; ++i) shares.push_back((i + 0.5) / cells);
  return shares;
}

using AxesByName = std::array<bool, kAxisCount>;

constexpr AxesByName kAllDirected = [] {
  AxesByName all{};
  all.fill(true);
  return all;
}();

AxesByName directed_axes(const MachineEffects& effects) {
  AxesByName directed{};
  for (const std::size_t effect : effects.numbers()) {
    for (std::size_t axis = 0; axis < kAxisCount; ++axis)
      directed[axis] |= effects.reach(effect).direction[axis];
  }
  return directed;
}

/// Every position by all combinations of the directions of these axes; those that are not `directed` from -.
void add_approaches(const std::vector<AxisPosition>& positions, std::span<const AxisName> axes,
                    const AxesByName& directed, bool inside, std::vector<VolumePoint>& points) {
  for (const AxisPosition& position : positions) {
    const std::size_t first = points.size();
    points.push_back({position, {}, inside});
    for (const AxisName axis : axes) {
      const std::size_t a = index_of(axis);
      for (std::size_t i = first; i < points.size(); ++i) points[i].direction[a] = -1;
      if (!directed[a]) continue;
      for (std::size_t i = first, end = points.size(); i < end; ++i) {
        points.push_back(points[i]);
        points.back().direction[a] = 1;
      }
    }
  }
}

/// Positions of rotary axes, one set after another, spread evenly and without a period in common with a grid
/// of other axes: multiples of powers of the inverse of the root of x^7 = x + 1, less whole numbers (additive
/// recurrence). Every axis is approached from either side as often.
class SpreadRotaryAxes {
 public:
  SpreadRotaryAxes(const Machine& machine, std::vector<AxisName> axes)
      : machine_(machine), axes_(std::move(axes)) {
    double root = 1.0;
    for (int k = 0; k < kIterations; ++k) root = std::pow(1.0 + root, 1.0 / kPower);
    step_ = 1.0 / root;
  }

  void place(std::size_t number, AxisPosition& position, ApproachDirection& direction) const {
    double step = 1.0;
    const auto next = [&] {
      step *= step_;
      const double share = 0.5 + static_cast<double>(number) * step;
      return share - std::floor(share);
    };
    for (const AxisName name : axes_) {
      const Axis& axis = machine_.axis(name);
      const double span = std::min(axis.travel(), 2.0 * std::numbers::pi);
      position[index_of(name)] = axis.travel_min + next() * span;
      direction[index_of(name)] = next() < 0.5 ? -1 : 1;
    }
  }

 private:
  static constexpr double kPower = 7.0;  // one more than dimensions: position and approach of three axes
  static constexpr int kIterations = 60;

  const Machine& machine_;
  std::vector<AxisName> axes_;
  double step_ = 0.0;
};

}  // namespace

Eigen::Vector3d movable_directions(const Machine& machine) {
  Eigen::Vector3d movable = Eigen::Vector3d::Zero();
  for (const AxisName axis : machine.main_linear_axes()) movable[direction_of(axis)] = 1.0;
  return movable;
}

AxisPosition middle_of_travel(const Machine& machine) {
  AxisPosition middle{};
  for (const AxisName axis : machine.main_linear_axes())
    middle[index_of(axis)] = 0.5 * (machine.axis(axis).travel_min + machine.axis(axis).travel_max);
  for (const AxisName axis : machine.parallel_axes()) middle[index_of(axis)] = machine.axis(axis).home;
  return middle;
}

AxisPosition home_of(const Machine& machine) {
  AxisPosition home{};
  for (const AxisName axis : machine.main_linear_axes()) home[index_of(axis)] = machine.axis(axis).home;
  for (const AxisName axis : machine.parallel_axes()) home[index_of(axis)] = machine.axis(axis).home;
  return home;
}

Eigen::Vector3d place_of(const Machine& machine, const AxisPosition& position) {
  Eigen::Vector3d place(position[0], position[1], position[2]);
  for (const AxisName axis : machine.parallel_axes())
    place[direction_of(axis)] += position[index_of(axis)] - machine.axis(axis).home;
  return place;
}

std::vector<AxisPosition> spread_places(const Machine& machine, const std::vector<AxisName>& axes,
                                        int cells) {
  constexpr int kFewest = 100;
  const int cells_of_all = static_cast<int>(std::lround(std::pow(cells, static_cast<double>(axes.size()))));
  const int count = axes.empty() ? 1 : std::max(cells_of_all, kFewest);
  std::vector<AxisPosition> places;
  for (const AxisPosition& pose : spread_poses(machine, count)) {
    places.push_back(home_of(machine));
    for (const AxisName axis : axes) places.back()[index_of(axis)] = pose[index_of(axis)];
  }
  return places;
}

std::vector<AxisPosition> ends_of_travel(const Machine& machine, const std::vector<AxisName>& axes) {
  return at_shares(machine, axes, {0.0, 0.5, 1.0});
}

std::vector<VolumePoint> volume_points(const Machine& machine, int cells_per_axis) {
  std::vector<VolumePoint> points;
  const std::vector<AxisName> axes = machine.main_linear_axes();
  add_approaches(spread_places(machine, axes, cells_per_axis), kLinearAxes, kAllDirected, true, points);
  add_approaches(ends_of_travel(machine, axes), kLinearAxes, kAllDirected, false, points);
  return points;
}

std::vector<VolumePose> volume_poses(const Machine& machine, const Tool& tool, const MachineEffects& effects,
                                     const std::vector<AxisName>& turned, int cells_per_axis) {
  const std::vector<AxisName> axes = machine.linear_axes();
  const AxesByName directed = turned.empty() ? directed_axes(effects) : kAllDirected;
  std::vector<VolumePoint> points;
  add_approaches(spread_places(machine, axes, cells_per_axis), axes, directed, true, points);
  add_approaches(ends_of_travel(machine, axes), axes, directed, false, points);
  const SpreadRotaryAxes rotary(machine, turned);
  const KinematicChain chain(machine);
  std::vector<VolumePose> poses;
  for (VolumePoint& point : points) {
    rotary.place(poses.size(), point.position, point.direction);
    poses.push_back({point, turned.empty() ? place_of(machine, point.position)
                                           : chain.nominal_point_w(point.position, tool.offset)});
  }
  return poses;
}

std::vector<VolumePoint> volume_lattice(const Machine& machine, int cells_per_axis) {
  std::vector<VolumePoint> points;
  add_approaches(at_shares(machine, machine.main_linear_axes(), middles(cells_per_axis)), kLinearAxes,
                 kAllDirected, true, points);
  return points;
}

}  // namespace volcal
