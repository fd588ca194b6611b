#include "volcal/identify/planning/design_criterion.h"

#include <cmath>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr double kLargestPower = 12.0;
constexpr double kLeastShare = 1e-6;  // of the largest: functionals below do not steer
constexpr double kRankShare = 1e-14;

/// Cholesky factor of the information with unit diagonal; its columns carry different units.
struct ScaledFactor {
  Eigen::VectorXd scale;
  Eigen::MatrixXd lower;
};

std::optional<ScaledFactor> scaled_factor(const Eigen::MatrixXd& information) {
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  auto lower = cholesky_lower(scale.asDiagonal() * information * scale.asDiagonal());
  if (!lower) return std::nullopt;
  return ScaledFactor{scale, std::move(*lower)};
}

}  // namespace

DesignCriterion::DesignCriterion(Eigen::MatrixXd functionals, Aggregate aggregate)
    : functionals_(std::move(functionals)), aggregate_(aggregate) {
  const SymmetricEigen eigen =
      eigen_decomposition(functionals_.transpose() * functionals_ / static_cast<double>(functionals_.rows()));
  const double least = kRankShare * eigen.values.maxCoeff();
  const Eigen::Index rank = (eigen.values.array() > least).count();
  mean_root_ = eigen.vectors.rightCols(rank) * eigen.values.tail(rank).cwiseSqrt().asDiagonal();
}

double DesignCriterion::aggregated(const Eigen::VectorXd& variances) const {
  if (aggregate_ == Aggregate::Mean) return variances.mean();
  const double largest = variances.maxCoeff();
  if (!(largest > 0.0)) return 0.0;
  const double mean = (variances.array() / largest).max(0.0).pow(kLargestPower).mean();
  return largest * std::pow(mean, 1.0 / kLargestPower);
}

Eigen::VectorXd DesignCriterion::variances(const Eigen::MatrixXd& covariance) const {
  const Eigen::Index size = functionals_.cols();
  return product(functionals_, covariance.topLeftCorner(size, size))
      .cwiseProduct(functionals_)
      .rowwise()
      .sum();
}

std::optional<double> DesignCriterion::value(const Eigen::MatrixXd& information) const {
  const auto factor = scaled_factor(information);
  if (!factor) return std::nullopt;
  const bool mean = aggregate_ == Aggregate::Mean;
  Eigen::MatrixXd right =
      Eigen::MatrixXd::Zero(information.rows(), mean ? mean_root_.cols() : functionals_.rows());
  if (mean) {
    right.topRows(functionals_.cols()) = mean_root_;
  } else {
    right.topRows(functionals_.cols()) = functionals_.transpose();
  }
  right = factor->scale.asDiagonal() * right;
  solve_lower(factor->lower, right);
  if (mean) return right.squaredNorm();
  return aggregated(right.colwise().squaredNorm().transpose());
}

std::optional<DesignCriterion::State> DesignCriterion::state(const Eigen::MatrixXd& information) const {
  const auto factor = scaled_factor(information);
  if (!factor) return std::nullopt;
  State state;
  state.covariance =
      factor->scale.asDiagonal() * inverse_from_cholesky(factor->lower) * factor->scale.asDiagonal();
  const Eigen::Index size = functionals_.cols();
  const auto towards = state.covariance.leftCols(size);
  if (aggregate_ == Aggregate::Mean) {
    state.root = product(towards, mean_root_);
    state.value = (mean_root_.transpose() * state.root.topRows(size)).trace();
    return state;
  }
  const Eigen::VectorXd all = variances(state.covariance);
  state.value = aggregated(all);
  const Eigen::VectorXd share = (all.array() / all.maxCoeff()).max(0.0).pow(kLargestPower - 1.0);
  std::vector<Eigen::Index> steering;
  for (Eigen::Index k = 0; k < share.size(); ++k) {
    if (share[k] > kLeastShare) steering.push_back(k);
  }
  const Eigen::VectorXd weight = share(steering).cwiseSqrt() / std::sqrt(share.sum());
  state.root = towards * functionals_(steering, Eigen::all).transpose() * weight.asDiagonal();
  return state;
}

}  // namespace volcal
