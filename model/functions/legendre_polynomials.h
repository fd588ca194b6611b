#pragma once
/// Legendre polynomials on [-1, 1] by their recurrence (M. Abramowitz and I. A. Stegun, Handbook of
/// Mathematical Functions, 1964, 22.7.10).

namespace volcal {

/// P_0 ... P_degree of t into `values`, degree + 1 numbers. Accurate to rounding for |t| <= 1.
inline void write_legendre_polynomials(int degree, double t, double* values) {
  values[0] = 1.0;
  if (degree > 0) values[1] = t;
  for (int n = 2; n <= degree; ++n) {
    values[n] = ((2 * n - 1) * t * values[n - 1] - (n - 1) * values[n - 2]) / n;
  }
}

}  // namespace volcal
