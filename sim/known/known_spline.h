#pragma once
/// Clamped splines by de Boor's algorithm (C. de Boor, A Practical Guide to Splines, 1978, ch. X).

#include <cstddef>
#include <vector>

namespace volcal::sim {

/// One coefficient a function; beyond the breakpoints the end pieces are continued.
class KnownSpline {
 public:
  KnownSpline(int degree, const std::vector<double>& breakpoints, std::vector<double> coefficients);

  double operator()(double q) const { return value(q, coefficients_); }
  /// With other coefficients.
  double value(double q, const std::vector<double>& coefficients) const;

 private:
  std::size_t degree_;
  std::vector<double> coefficients_;
  std::vector<double> knots_;
};

/// n equal pieces.
std::vector<double> equal_pieces(double from, double to, int pieces);

}  // namespace volcal::sim
