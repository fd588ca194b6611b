#include "volcal/identify/criticism/projector.h"

#include <stdexcept>
#include <utility>

#include "volcal/identify/solve/dense.h"

namespace volcal {

Eigen::MatrixXd ProjectedColumns::gram(Eigen::Index first, Eigen::Index columns) const {
  return gram_of_columns(whitened.middleCols(first, columns)) -
         gram_of_columns(explained.middleCols(first, columns));
}

Projector::Projector(const NoiseProblem& problem, const NoiseData& data,
                     std::span<const NoiseParameters> noise, int threads)
    : whitener_(data, noise),
      threads_(threads),
      base_parameters_(problem.jacobian.cols()),
      precision_(problem.prior_precision.size() > 0
                     ? problem.prior_precision
                     : Eigen::MatrixXd(Eigen::MatrixXd::Zero(base_parameters_, base_parameters_))) {
  const Eigen::VectorXd mean = problem.prior_mean.size() > 0
                                   ? problem.prior_mean
                                   : Eigen::VectorXd(Eigen::VectorXd::Zero(base_parameters_));
  pull_ = precision_ * mean;
  prior_squares_ = mean.dot(pull_);
  whitened_.resize(problem.jacobian.rows(), base_parameters_ + 1);
  whitened_ << problem.jacobian, problem.residual;
  whitener_.whiten(whitened_, whitened_, threads_);
  factorise();
}

/// Columns are scaled to unit diagonal of A first: they carry different units.
void Projector::factorise() {
  const Eigen::Index count = parameters();
  const Eigen::MatrixXd products = gram_of_columns(whitened_);
  residual_squares_ = products(count, count);
  Eigen::MatrixXd normal = products.topLeftCorner(count, count);
  normal.topLeftCorner(base_parameters_, base_parameters_) += precision_;
  scale_ = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
  auto lower = cholesky_lower(normal);
  if (!lower) {
    normal.diagonal().array() += 1e-12;  // what neither readings nor priors determine stays where it is
    lower = cholesky_lower(normal);
    if (!lower) throw std::runtime_error("the model's columns are not independent");
  }
  lower_ = std::move(*lower);
  Eigen::MatrixXd right = products.col(count).head(count);
  right.col(0).head(base_parameters_) += pull_;
  right = scale_.asDiagonal() * right;
  solve_lower(lower_, right);
  rotated_ = right;
}

ProjectedColumns Projector::project(Eigen::MatrixXd columns, int threads) const {
  ProjectedColumns out;
  out.whitened = std::move(columns);
  whitener_.whiten(out.whitened, out.whitened, threads);
  const Eigen::MatrixXd products = transposed_product(whitened_, out.whitened);
  out.explained = scale_.asDiagonal() * products.topRows(parameters());
  solve_lower(lower_, out.explained);
  out.score = products.bottomRows(1).transpose() - out.explained.transpose() * rotated_;
  out.norm = out.whitened.colwise().norm();
  return out;
}

void Projector::accept(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd added;
  whitener_.whiten(columns, added, threads_);
  const Eigen::Index before = parameters();
  whitened_.conservativeResize(Eigen::NoChange, whitened_.cols() + added.cols());
  whitened_.rightCols(1) = whitened_.col(before).eval();
  whitened_.middleCols(before, added.cols()) = added;
  factorise();
}

Eigen::VectorXd Projector::solution() const {
  return scale_.cwiseProduct(lower_.triangularView<Eigen::Lower>().transpose().solve(rotated_));
}

Eigen::VectorXd Projector::prediction_variance(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd rotated = scale_.asDiagonal() * rows.transpose();
  solve_lower(lower_, rotated);
  return rotated.colwise().squaredNorm();
}

Eigen::MatrixXd Projector::accepted_covariance() const {
  const Eigen::Index count = accepted();
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(parameters(), count);
  unit.bottomRows(count).setIdentity();
  solve_lower(lower_, unit);
  const Eigen::MatrixXd inverse = unit.transpose() * unit;
  const auto scale = scale_.tail(count).asDiagonal();
  return scale * inverse * scale;
}

double Projector::residual_squares() const {
  return residual_squares_ + prior_squares_ - rotated_.squaredNorm();
}

}  // namespace volcal
