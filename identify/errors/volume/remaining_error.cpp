#include "volcal/identify/errors/volume/remaining_error.h"

#include <cstdint>
#include <random>

#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr std::uint64_t kSeedOfExample = 1;

Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return {};
  const SymmetricEigen eigen = eigen_decomposition(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

}  // namespace

RemainingErrors::RemainingErrors(const Eigen::MatrixXd& covariance)
    : root_(root_of(covariance)), draw_(root_.cols()) {
  std::mt19937_64 random(kSeedOfExample);
  std::normal_distribution<double> normal;
  for (double& value : draw_) value = normal(random);
}

RemainingError RemainingErrors::at(std::span<const Eigen::Vector3d> points,
                                   const Eigen::MatrixXd& derivatives) const {
  RemainingError remaining;
  remaining.u.assign(points.size(), Eigen::Vector3d::Zero());
  remaining.example = remaining.u;
  if (root_.size() == 0) return remaining;
  const Eigen::MatrixXd fields = derivatives * root_;
  std::vector<Eigen::Vector3d> field(points.size());
  for (Eigen::Index k = 0; k < fields.cols(); ++k) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      field[i] = fields.col(k).segment<3>(static_cast<Eigen::Index>(3 * i));
    }
    const auto aligned = without_rigid_motion(points, field);
    for (std::size_t i = 0; i < field.size(); ++i) {
      remaining.u[i] += aligned[i].cwiseAbs2();
      remaining.example[i] += draw_[k] * aligned[i];
    }
  }
  for (Eigen::Vector3d& u : remaining.u) u = u.cwiseSqrt();
  return remaining;
}

}  // namespace volcal
