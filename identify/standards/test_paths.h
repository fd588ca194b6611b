#pragma once
/// Recognises the paths of the standards' tests in a setup's commanded positions: straight lines along one,
/// two or three linear axes, and circles in a plane of two. m and rad.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"

namespace volcal {

/// Commanded points farther than this from the ideal path (m) make it no such path.
inline constexpr double kPathTolerance = 10e-6;

/// Readings of one straight line, both directions and all repetitions.
struct StraightPath {
  std::vector<AxisName> moving;  ///< linear axes, in the order X, Y, Z
  std::string name;              ///< "X" for one axis; "+X-Y+Z", by the first pass, for several
  Eigen::Vector3d direction_w = Eigen::Vector3d::Zero();  ///< unit vector; one axis: towards its +
  std::vector<std::size_t> rows;                          ///< in the order of the file
  std::vector<double> along;  ///< one axis: its commanded position; several: distance from the start, m
  std::vector<int> approach;  ///< +1 along `direction_w`, -1 against it, 0 unknown
};

/// Readings of one circle, both senses.
struct CirclePath {
  AxisName first = AxisName::X;  ///< planes XY, YZ and ZX: counter-clockwise goes from first to second
  AxisName second = AxisName::Y;
  Eigen::Vector3d centre_w = Eigen::Vector3d::Zero();  ///< of the commanded points, tool included
  Eigen::Vector3d first_w = Eigen::Vector3d::Zero();   ///< unit vectors of the plane
  Eigen::Vector3d second_w = Eigen::Vector3d::Zero();
  double radius = 0.0;
  std::vector<std::size_t> rows;
  std::vector<double> angle;  ///< rad, from `first_w` towards `second_w`
  std::vector<double> commanded_radius;
  std::vector<int> sense;  ///< +1 counter-clockwise, -1 clockwise, 0 unknown
};

template <class Path>
struct FoundPaths {
  std::vector<Path> paths;
  std::vector<Finding> not_recognised;  ///< why passes are left out, "standards.no-test...": one each reason
};

/// The whole setup is one path when its points fit one; otherwise each `line` is looked at by itself, and
/// lines on the same path are put together.
FoundPaths<StraightPath> straight_paths(const Campaign& campaign, const Setup& setup);
FoundPaths<CirclePath> circle_paths(const Campaign& campaign, const Setup& setup);

/// Nominal functional point of every reading, workpiece coordinates, tool included.
std::vector<Eigen::Vector3d> nominal_points_w(const Campaign& campaign, const Setup& setup);

}  // namespace volcal
