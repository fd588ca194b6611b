#pragma once
/// The volumetric error of many poses in three ways: exact transforms, transforms with small angles, error
/// twists.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "volcal/model/kinematics/chain.h"

namespace volcal::bench {

/// kLanes poses side by side, by AxisName.
struct PoseLanes {
  std::array<Lanes, kAxisCount> position;
  std::array<std::array<Lanes, 6>, kAxisCount> motion;
  std::array<std::array<Lanes, 6>, kAxisCount> location;
};

/// Poses of a machine, each with errors of its own; the same one by one and side by side.
struct Poses {
  Machine machine;
  Eigen::Vector3d tool_offset = Eigen::Vector3d::Zero();
  std::vector<AxisPosition> position;
  std::vector<PoseErrors<double>> errors;
  std::vector<PoseLanes> lanes;
};

/// At random over the travel: displacements within +-10 um, rotations within +-10 urad; `count` is a multiple
/// of kLanes.
Poses random_poses(const std::string& structure, std::size_t count);

/// Actual minus nominal of the functional point in workpiece coordinates, m.
enum class Transforms { Exact, SmallAngles, Twists, TwistsInLanes };
void volumetric_errors(const Poses& poses, Transforms transforms, std::vector<Eigen::Vector3d>& errors);

}  // namespace volcal::bench
