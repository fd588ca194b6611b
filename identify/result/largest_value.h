#pragma once
/// Where a surface or curve is largest: the one definition of "up to" for all outputs.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/functions/tensor_basis.h"

namespace volcal {

struct LargestValue {
  double value = 0.0;      ///< of the largest magnitude
  double u = 0.0;          ///< its standard uncertainty
  std::vector<double> at;  ///< its place, one value per variable, in its unit
  Eigen::VectorXd row;     ///< its derivatives to the coefficients
};

/// Over the range of the variables where the function is measured: where its standard uncertainty is at most
/// three times the median over the range. Best of at least four places per piece of every variable, refined
/// to 1/1000 of their distance. An empty covariance: everywhere, u = 0.
LargestValue largest_value(const TensorBasis& basis, const Eigen::VectorXd& coefficients,
                           const Eigen::MatrixXd& covariance);

}  // namespace volcal
