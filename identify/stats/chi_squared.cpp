#include "volcal/identify/stats/chi_squared.h"

#include <Eigen/Core>
#include <unsupported/Eigen/SpecialFunctions>

namespace volcal {

double chi_squared_exceedance(double chi2, double dof) {
  if (chi2 <= 0.0) return 1.0;
  return Eigen::numext::igammac(dof / 2.0, chi2 / 2.0);
}

}  // namespace volcal
