#include "volcal/identify/errors/rotary/identified_lines.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace volcal {
namespace {

using Eigen::Vector3d;
using LineVector = Eigen::Matrix<double, 6, 1>;

LineVector as_vector(const AxisLineErrors& line) {
  LineVector vector;
  vector << line.displacement, line.rotation;
  return vector;
}

/// Derivatives to displacement and rotation of the place `along` the line.
Eigen::Matrix<double, 3, 6> place_rows(AxisName axis, double along) {
  Eigen::Matrix<double, 3, 6> rows = Eigen::Matrix<double, 3, 6>::Zero();
  rows.leftCols<3>().setIdentity();
  const Vector3d direction = Vector3d::Unit(direction_of(axis));
  for (int k = 0; k < 3; ++k) rows.col(3 + k) = along * Vector3d::Unit(k).cross(direction);
  return rows;
}

/// The line is linear in the location errors of all rotary axes.
IdentifiedLine line_at_zero_of(const FitResult& result, const std::vector<const ParameterBlock*>& locations,
                               AxisName axis) {
  const auto count = static_cast<Eigen::Index>(locations.size());
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows(6, count);
  std::vector<int> places;
  Eigen::VectorXd values(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const ParameterBlock& block = *locations[static_cast<std::size_t>(k)];
    PoseErrors<double> unit;
    unit.location[index_of(block.location->axis)][index_of(block.location->component)] = 1.0;
    rows.col(k) = as_vector(line_at_machine_zero(result.machine, unit, axis));
    places.push_back(block.offset);
    values[k] = result.parameters[block.offset];
  }
  const LineVector value = rows * values;
  IdentifiedLine line;
  line.axis = axis;
  line.value = {value.head<3>(), value.tail<3>()};
  const Eigen::MatrixXd covariance = covariance_of(result, places);
  line.covariance = rows * covariance * rows.transpose();
  for (Eigen::Index k = 0; k < rows.rows(); ++k)
    line.by_convention[static_cast<std::size_t>(k)] = rows.row(k).isZero(0.0);
  return line;
}

}  // namespace

Vector3d IdentifiedLine::displacement_at(double along) const {
  return place_rows(axis, along) * as_vector(value);
}

Eigen::Matrix3d IdentifiedLine::covariance_at(double along) const {
  const auto rows = place_rows(axis, along);
  return rows * covariance * rows.transpose();
}

std::vector<IdentifiedLine> identified_lines(const FitResult& result) {
  std::vector<const ParameterBlock*> locations;
  std::vector<AxisName> axes;
  for (const ParameterBlock& block : result.layout.blocks) {
    if (!block.location || !is_rotary(block.location->axis)) continue;
    locations.push_back(&block);
    if (std::ranges::find(axes, block.location->axis) == axes.end()) axes.push_back(block.location->axis);
  }
  std::ranges::sort(axes);
  std::vector<IdentifiedLine> lines;
  for (const AxisName axis : axes) lines.push_back(line_at_zero_of(result, locations, axis));
  return lines;
}

}  // namespace volcal
