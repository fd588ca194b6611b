#include "volcal/identify/solve/priors/basis_prior.h"

#include <cmath>

namespace volcal {
namespace {

// wide functions are smooth: n half waves have (n pi)^2 sqrt(share) less room
constexpr double kCurvatureShare = 1e-3;
constexpr int kOrderOfHarmonics = 2;

}  // namespace

bool is_smoothed(const FunctionSpec& spec, const Basis& basis) {
  return spec.automatic_degree || (spec.knots == KnotChoice::Automatic && basis.roughness_order() > 0);
}

Eigen::MatrixXd wide_precision(const Basis& basis, const Axis& axis, bool smoothed) {
  const double travel = axis.travel();
  const int order = smoothed && basis.harmonics() > 0 ? kOrderOfHarmonics : basis.roughness_order();
  Eigen::MatrixXd roughness = gram(basis, 0) / travel;
  if (order > 0) roughness += kCurvatureShare * std::pow(travel, 2 * order - 1) * gram(basis, order);
  return roughness;
}

}  // namespace volcal
