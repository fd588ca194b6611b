#include "volcal/identify/errors/volume/volume_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

void add_approaches(const std::vector<AxisPosition>& positions, bool inside,
                    std::vector<VolumePoint>& points) {
  for (const AxisPosition& position : positions) {
    for (unsigned signs = 0; signs < 8; ++signs) {
      VolumePoint point{position, {}, inside};
      for (std::size_t i = 0; i < 3; ++i) point.direction[i] = ((signs >> i) & 1U) != 0 ? 1 : -1;
      points.push_back(point);
    }
  }
}

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
  add_approaches(spread_places(machine, axes, cells_per_axis), true, points);
  add_approaches(ends_of_travel(machine, axes), false, points);
  return points;
}

std::vector<VolumePoint> volume_lattice(const Machine& machine, int cells_per_axis) {
  std::vector<VolumePoint> points;
  add_approaches(at_shares(machine, machine.main_linear_axes(), middles(cells_per_axis)), true, points);
  return points;
}

}  // namespace volcal
