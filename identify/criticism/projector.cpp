#include "volcal/identify/criticism/projector.h"

#include <stdexcept>
#include <utility>

namespace volcal {

Eigen::MatrixXd ProjectedColumns::gram(Eigen::Index first, Eigen::Index columns) const {
  const auto w = whitened.middleCols(first, columns);
  const auto e = explained.middleCols(first, columns);
  return w.transpose() * w - e.transpose() * e;
}

Projector::Projector(const NoiseProblem& problem, const NoiseData& data,
                     std::span<const NoiseParameters> noise, int threads)
    : whitener_(data, noise),
      threads_(threads),
      base_parameters_(problem.jacobian.cols()),
      residual_(whitener_.whiten(problem.residual)),
      precision_(problem.prior_precision.size() > 0
                     ? problem.prior_precision
                     : Eigen::MatrixXd(Eigen::MatrixXd::Zero(base_parameters_, base_parameters_))) {
  const Eigen::VectorXd mean = problem.prior_mean.size() > 0
                                   ? problem.prior_mean
                                   : Eigen::VectorXd(Eigen::VectorXd::Zero(base_parameters_));
  pull_ = precision_ * mean;
  prior_squares_ = mean.dot(pull_);
  whitener_.whiten(problem.jacobian, whitened_, threads_);
  factorise();
}

/// Columns are scaled to unit diagonal of A first: they carry different units.
void Projector::factorise() {
  const Eigen::Index count = whitened_.cols();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
  normal.selfadjointView<Eigen::Lower>().rankUpdate(whitened_.transpose());
  normal.topLeftCorner(base_parameters_, base_parameters_) += precision_;
  scale_ = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
  factor_.compute(normal.selfadjointView<Eigen::Lower>());
  if (factor_.info() != Eigen::Success) {
    normal.diagonal().array() += 1e-12;  // what neither readings nor priors determine stays where it is
    factor_.compute(normal.selfadjointView<Eigen::Lower>());
    if (factor_.info() != Eigen::Success) throw std::runtime_error("the model's columns are not independent");
  }
  Eigen::VectorXd right = whitened_.transpose() * residual_;
  right.head(base_parameters_) += pull_;
  rotated_ = factor_.matrixL().solve(scale_.cwiseProduct(right));
}

ProjectedColumns Projector::project(Eigen::MatrixXd columns) const {
  ProjectedColumns out;
  out.whitened = std::move(columns);
  whitener_.whiten(out.whitened, out.whitened, threads_);
  out.explained = factor_.matrixL().solve(scale_.asDiagonal() * (whitened_.transpose() * out.whitened));
  out.score = out.whitened.transpose() * residual_ - out.explained.transpose() * rotated_;
  out.norm = out.whitened.colwise().norm();
  return out;
}

void Projector::accept(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd added;
  whitener_.whiten(columns, added, threads_);
  whitened_.conservativeResize(Eigen::NoChange, whitened_.cols() + added.cols());
  whitened_.rightCols(added.cols()) = added;
  factorise();
}

Eigen::VectorXd Projector::solution() const { return scale_.cwiseProduct(factor_.matrixU().solve(rotated_)); }

Eigen::VectorXd Projector::prediction_variance(const Eigen::MatrixXd& rows) const {
  const Eigen::MatrixXd rotated = factor_.matrixL().solve(scale_.asDiagonal() * rows.transpose());
  return rotated.colwise().squaredNorm();
}

Eigen::MatrixXd Projector::accepted_covariance() const {
  const Eigen::Index count = accepted();
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(parameters(), count);
  unit.bottomRows(count).setIdentity();
  const Eigen::MatrixXd inverse = factor_.solve(unit).bottomRows(count);
  const auto scale = scale_.tail(count).asDiagonal();
  return scale * inverse * scale;
}

double Projector::residual_squares() const {
  return residual_.squaredNorm() + prior_squares_ - rotated_.squaredNorm();
}

}  // namespace volcal
