#pragma once
/// Gaussian-process priors for the coefficients of a surface (model/functions/tensor_basis.h): how a function
/// without a formula may look before any reading is seen. The covariance of two coefficients is the product
/// over the variables of Matern 5/2 covariances (Rasmussen and Williams 2006, eq. 4.17) of the distance of
/// their nodes, a share of the range, scaled so that the function's mean variance over the range is 1. Which
/// lengths it has, one per variable, and its amplitude are for the evidence (smoothing.h).
///
/// A part of a surface that the rest of the model can imitate, as a function of y alone added to EYY, is not
/// defined by readings. It belongs to the rest: the surface keeps the representative of least norm, K^-1-
/// orthogonal to what is imitated.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "volcal/identify/solve/priors/function_prior.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {

class SurfacePriors {
 public:
  explicit SurfacePriors(const TensorBasis& basis);

  /// Every combination of lengths, those of the last variable next to each other, ascending.
  const std::vector<std::shared_ptr<const PriorShape>>& shapes() const { return shapes_; }
  /// Those with one length longer or shorter by one.
  std::vector<std::size_t> neighbours(std::size_t shape) const;
  /// All lengths in the middle.
  std::size_t middle() const;
  /// Lengths of a shape, shares of the ranges, one per variable.
  std::vector<double> lengths(std::size_t shape) const;

  /// `imitated`: columns span the coefficients that the rest of the model imitates.
  SurfacePriors without(const Eigen::MatrixXd& imitated) const;
  /// What without() was given; no columns: nothing.
  const Eigen::MatrixXd& imitated() const { return imitated_; }

 private:
  std::vector<std::vector<double>> lengths_;  ///< per variable
  std::vector<std::shared_ptr<const PriorShape>> shapes_;
  Eigen::MatrixXd imitated_;
};

/// Coefficients of a surface that the rest of the model imitates to 99 % of what the readings see of them.
/// `own`: J_s^T W J_s of its coefficients, `coupling`: J_m^T W J_s with the rest, `rest`: J_m^T W J_m and the
/// priors of the rest; `prior`: covariance of the coefficients. One column each.
Eigen::MatrixXd imitated_coefficients(const Eigen::MatrixXd& own, const Eigen::MatrixXd& coupling,
                                      const Eigen::MatrixXd& rest, const Eigen::MatrixXd& prior);

/// Share of what the readings see of each function (coefficients, one column each) that the rest imitates,
/// 0..1; 1 of what they do not see.
Eigen::VectorXd imitated_shares(const Eigen::MatrixXd& own, const Eigen::MatrixXd& coupling,
                                const Eigen::MatrixXd& rest, const Eigen::MatrixXd& functions);

}  // namespace volcal
