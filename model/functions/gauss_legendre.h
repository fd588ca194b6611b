#pragma once
/// Gauss-Legendre quadrature on [-1, 1]: exact for polynomials of degree 2n - 1.

#include <vector>

namespace volcal {

struct GaussLegendre {
  std::vector<double> points;   ///< ascending, in (-1, 1)
  std::vector<double> weights;  ///< sum 2
};

/// Rule of n >= 1 points, to machine precision (Newton iteration on the Legendre polynomial).
GaussLegendre gauss_legendre(int n);

}  // namespace volcal
