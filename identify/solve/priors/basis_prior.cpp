#include "volcal/identify/solve/priors/basis_prior.h"

#include <cmath>

namespace volcal {
namespace {

// wide functions are smooth: n half waves have (n pi)^2 sqrt(share) less room
constexpr double kCurvatureShare = 1e-3;

}  // namespace

bool is_smoothed(const FunctionSpec& spec, const Basis& basis) {
  return spec.automatic_degree || (spec.knots == KnotChoice::Automatic && basis.roughness_order() > 0);
}

Eigen::MatrixXd wide_precision(const Basis& basis, const Axis& axis) {
  const double travel = axis.travel();
  Eigen::MatrixXd roughness = gram(basis, 0) / travel;
  if (basis.roughness_order() > 0) {
    roughness += kCurvatureShare * std::pow(travel, 2 * basis.roughness_order() - 1) *
                 gram(basis, basis.roughness_order());
  }
  return roughness;
}

}  // namespace volcal
