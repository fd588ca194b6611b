#include "volcal/studies/tables/rigid_ideal.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <set>

namespace volcal::studies {
namespace {

constexpr std::size_t kPerPosition = 6;
constexpr double kSamePosition = 1e-9;   // m
constexpr double kUndetermined = 1e-12;  // eigenvalues below this share of the largest: least norm

Eigen::Matrix3d cross_with(const Eigen::Vector3d& arm) {
  Eigen::Matrix3d matrix;  // rotation x arm
  matrix << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return matrix;
}

Eigen::Vector3d unit_along(AxisName axis) { return Eigen::Vector3d::Unit(static_cast<int>(index_of(axis))); }

Eigen::VectorXd least_norm(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const double least = kUndetermined * eigen.eigenvalues().maxCoeff();
  const Eigen::VectorXd inverse =
      eigen.eigenvalues().unaryExpr([least](double value) { return value > least ? 1.0 / value : 0.0; });
  return eigen.eigenvectors() * (inverse.asDiagonal() * (eigen.eigenvectors().transpose() * right));
}

}  // namespace

RigidIdeal::RigidIdeal(const Machine& machine, std::span<const VolumePoint> points,
                       const std::function<Eigen::Vector3d(const VolumePoint&)>& error, bool both_directions)
    : both_directions_(both_directions) {
  read_axes(machine, points);
  const auto size = static_cast<Eigen::Index>(columns_);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  std::vector<Eigen::MatrixXd> rows;
  for (const VolumePoint& point : points) {
    left_.push_back(error(point));
    rows.push_back(rows_at(point));
  }
  Eigen::MatrixXd all(static_cast<Eigen::Index>(3 * rows.size()), size);
  Eigen::VectorXd errors(all.rows()), weights(all.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    all.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = rows[i];
    errors.segment<3>(static_cast<Eigen::Index>(3 * i)) = left_[i];
    weights.segment<3>(static_cast<Eigen::Index>(3 * i)).setConstant(volume_of(points[i]));
  }
  gram.noalias() = all.transpose() * weights.asDiagonal() * all;
  right.noalias() = all.transpose() * weights.asDiagonal() * errors;
  values_ = least_norm(gram, right);
  const Eigen::VectorXd rest = errors - all * values_;
  for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = rest.segment<3>(static_cast<Eigen::Index>(3 * i));
  move_means_of_rotations();
}

void RigidIdeal::read_axes(const Machine& machine, std::span<const VolumePoint> points) {
  for (const Joint& joint : machine.structure.joints) {
    if (is_rotary(joint.axis)) continue;
    AxisValues values;
    values.axis = joint.axis;
    std::set<double> positions;
    for (const VolumePoint& point : points) positions.insert(point.position[index_of(joint.axis)]);
    values.positions.assign(positions.begin(), positions.end());
    for (const double q : values.positions) values.middle += q / static_cast<double>(positions.size());
    values.first = columns_;
    columns_ += kPerPosition * values.positions.size() * (both_directions_ ? 2 : 1);
    axes_.push_back(values);
  }
}

std::size_t RigidIdeal::value_of(const AxisValues& values, double q, int direction) const {
  const auto found = std::ranges::find_if(
      values.positions, [q](double position) { return std::abs(position - q) < kSamePosition; });
  const auto place = static_cast<std::size_t>(found - values.positions.begin());
  return values.first + kPerPosition * (both_directions_ ? 2 * place + (direction > 0 ? 1 : 0) : place);
}

double RigidIdeal::volume_of(const VolumePoint& point) const {
  double volume = 1.0;
  for (const AxisValues& values : axes_) {
    const auto at = std::ranges::lower_bound(values.positions, point.position[index_of(values.axis)]);
    const auto place = static_cast<std::size_t>(at - values.positions.begin());
    const std::size_t below = place > 0 ? place - 1 : 0;
    const std::size_t above = std::min(place + 1, values.positions.size() - 1);
    volume *= 0.5 * (values.positions[above] - values.positions[below]);
  }
  return volume;
}

Eigen::MatrixXd RigidIdeal::rows_at(const VolumePoint& point) const {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(columns_));
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::size_t a = index_of(axes_[i].axis);
    const auto column = static_cast<Eigen::Index>(value_of(axes_[i], point.position[a], point.direction[a]));
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();
    for (std::size_t k = i + 1; k < axes_.size(); ++k)
      arm += (point.position[index_of(axes_[k].axis)] - axes_[k].middle) * unit_along(axes_[k].axis);
    rows.middleCols<3>(column).setIdentity();
    rows.middleCols<3>(column + 3) = cross_with(arm);
  }
  return rows;
}

/// A constant rotation of an axis turns the axes behind it: it is put with their displacements.
void RigidIdeal::move_means_of_rotations() {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::size_t count = axes_[i].positions.size() * (both_directions_ ? 2 : 1);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    const auto rotation = [&](std::size_t n) {
      return values_.segment<3>(static_cast<Eigen::Index>(axes_[i].first + kPerPosition * n + 3));
    };
    for (std::size_t n = 0; n < count; ++n) mean += rotation(n) / static_cast<double>(count);
    for (std::size_t n = 0; n < count; ++n) rotation(n) -= mean;
    for (std::size_t k = i + 1; k < axes_.size(); ++k) {
      for (const double q : axes_[k].positions) {
        for (const int direction : both_directions_ ? std::vector<int>{-1, 1} : std::vector<int>{0})
          values_.segment<3>(static_cast<Eigen::Index>(value_of(axes_[k], q, direction))) +=
              mean.cross((q - axes_[k].middle) * unit_along(axes_[k].axis));
      }
    }
  }
}

Eigen::Vector3d RigidIdeal::along(AxisName axis, double q, int direction) const {
  if (both_directions_ && direction == 0) return 0.5 * (along(axis, q, -1) + along(axis, q, 1));
  const AxisValues& values = *std::ranges::find(axes_, axis, &AxisValues::axis);
  const auto above = std::ranges::upper_bound(values.positions, q);
  const std::size_t upper = std::clamp<std::size_t>(
      static_cast<std::size_t>(above - values.positions.begin()), 1, values.positions.size() - 1);
  const double low = values.positions[upper - 1], high = values.positions[upper];
  const double share = std::clamp((q - low) / (high - low), 0.0, 1.0);
  const auto at = [&](double position) {
    return values_.segment<3>(static_cast<Eigen::Index>(value_of(values, position, direction)));
  };
  return (1.0 - share) * at(low) + share * at(high);
}

}  // namespace volcal::studies
