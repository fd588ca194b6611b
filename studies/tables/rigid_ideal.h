#pragma once
/// The best that error motions of single axes can do about given errors in a volume: a least-squares fit of
/// free values at every position of every axis (ISO/TR 16907:2015, 7.4.2). Apart from
/// identify/errors/rigid_compromise.h, whose tables it is compared with: dense normal equations over points,
/// each with its share of the volume, in place of moments over the travel.

#include <functional>
#include <span>
#include <vector>

#include "volcal/identify/compensation/checks/volume_check.h"

namespace volcal::studies {

class RigidIdeal {
 public:
  /// Points on a rectangular grid of the linear axes. Where the tables tell no directions apart, the values
  /// do not either.
  RigidIdeal(const Machine& machine, std::span<const VolumePoint> points,
             const std::function<Eigen::Vector3d(const VolumePoint&)>& error, bool both_directions);

  /// What is left at the points, m.
  const std::vector<Eigen::Vector3d>& left() const { return left_; }
  /// Displacement that depends on one axis alone, linear between the positions; direction 0 is the mean, m.
  Eigen::Vector3d along(AxisName axis, double q, int direction) const;

 private:
  struct AxisValues {
    AxisName axis = AxisName::X;
    double middle = 0.0;
    std::vector<double> positions;
    std::size_t first = 0;  ///< column of its first value
  };
  std::size_t value_of(const AxisValues& values, double q, int direction) const;
  void read_axes(const Machine& machine, std::span<const VolumePoint> points);
  Eigen::MatrixXd rows_at(const VolumePoint& point) const;
  /// Share of the volume by the trapezoidal rule, m^3.
  double volume_of(const VolumePoint& point) const;
  void move_means_of_rotations();

  bool both_directions_;
  std::vector<AxisValues> axes_;  ///< from the workpiece to the tool
  std::size_t columns_ = 0;
  Eigen::VectorXd values_;  ///< per axis, position and direction: displacement, then rotation
  std::vector<Eigen::Vector3d> left_;
};

}  // namespace volcal::studies
