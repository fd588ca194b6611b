#pragma once
/// A pose as errors see it: commanded position and direction of approach of every axis.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>

#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// Direction of approach of every axis, by AxisName: -1, +1, 0 = mean of both.
using ApproachDirection = std::array<std::int8_t, kAxisCount>;
inline constexpr ApproachDirection kTowardsPlus = {1, 1, 1, 1, 1, 1, 1, 1, 1};

/// Displacement (ex, ey, ez) of the functional point at a commanded position, actual minus nominal, workpiece
/// coordinates, m.
using DisplacementField = std::function<Eigen::Vector3d(const AxisPosition&, const ApproachDirection&)>;

/// The same position with every rotary axis at 0.
inline AxisPosition without_rotary_axes(const AxisPosition& position) {
  AxisPosition linear{};
  for (const AxisName axis : kLinearAxes) linear[index_of(axis)] = position[index_of(axis)];
  for (const AxisName axis : kParallelAxes) linear[index_of(axis)] = position[index_of(axis)];
  return linear;
}

}  // namespace volcal
