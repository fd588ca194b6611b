#pragma once
/// What remains of candidate effects once the model has been allowed to imitate them.
///
/// With Sigma = L L^T, J_w = L^-1 J, prior precision P and A = J_w^T J_w + P, the columns g of a candidate
/// become, projected off the model, g~ with
///
///   g~^T g~ = g_w^T g_w - b^T A^-1 b,    g~^T r~ = g_w^T r_w - b^T A^-1 (J_w^T r_w + P m),    b = J_w^T g_w
///
/// (added variables in generalised least squares; the prior counts as further observations). Nothing of size
/// N x N and no orthogonal basis is formed.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "volcal/identify/criticism/noise_model.h"
#include "volcal/identify/criticism/restricted_likelihood.h"

namespace volcal {

/// Columns of candidates after projection; k columns.
struct ProjectedColumns {
  Eigen::MatrixXd whitened;   ///< N x k, not projected
  Eigen::MatrixXd explained;  ///< p x k: C^-1 b with A = C C^T, so that g~^T h~ = g_w^T h_w - e_g^T e_h
  Eigen::VectorXd score;      ///< g~^T r~
  Eigen::VectorXd norm;       ///< |g_w|: what would be seen if everything else were known

  Eigen::Index count() const { return score.size(); }
  /// g~^T g~ of a stretch of columns.
  Eigen::MatrixXd gram(Eigen::Index first, Eigen::Index columns) const;
};

class Projector {
 public:
  /// `data` may leave out observations of the problem (infinite sigma).
  Projector(const NoiseProblem& problem, const NoiseData& data, std::span<const NoiseParameters> noise,
            int threads);

  /// On `threads` of its own; may be called from several threads at once.
  ProjectedColumns project(Eigen::MatrixXd columns, int threads = 1) const;
  /// Takes columns into the model, without prior.
  void accept(const Eigen::MatrixXd& columns);

  /// Correction of the model's parameters, accepted columns last, from the observations in use.
  Eigen::VectorXd solution() const;
  /// Variance of predictions, one per row of `rows` (derivatives to all parameters, accepted ones last).
  Eigen::VectorXd prediction_variance(const Eigen::MatrixXd& rows) const;
  /// Covariance of the accepted columns' amplitudes.
  Eigen::MatrixXd accepted_covariance() const;
  /// |r~|^2: what the model leaves, in units of the noise.
  double residual_squares() const;
  std::size_t observations() const { return whitener_.observations(); }
  Eigen::Index parameters() const { return whitened_.cols() - 1; }
  Eigen::Index accepted() const { return parameters() - base_parameters_; }

 private:
  void factorise();

  Whitener whitener_;
  int threads_;
  Eigen::Index base_parameters_;
  Eigen::MatrixXd whitened_;   ///< N x (p + 1): columns of the model, residual last
  Eigen::MatrixXd precision_;  ///< of the base parameters, not scaled
  Eigen::VectorXd pull_;       ///< P m, base parameters
  double prior_squares_ = 0.0;
  double residual_squares_ = 0.0;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd lower_;    ///< C of the columns times scale_
  Eigen::VectorXd rotated_;  ///< C^-1 (J_w^T r_w + P m)
};

}  // namespace volcal
