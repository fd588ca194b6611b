#include "volcal/sim/known/known_spline.h"

#include <utility>

namespace volcal::sim {

KnownSpline::KnownSpline(int degree, const std::vector<double>& breakpoints, std::vector<double> coefficients)
    : degree_(static_cast<std::size_t>(degree)), coefficients_(std::move(coefficients)) {
  knots_.assign(degree_, breakpoints.front());
  knots_.insert(knots_.end(), breakpoints.begin(), breakpoints.end());
  knots_.insert(knots_.end(), degree_, breakpoints.back());
}

double KnownSpline::value(double q, const std::vector<double>& coefficients) const {
  const std::size_t last = coefficients.size() - 1;
  std::size_t span = degree_;
  while (span < last && q >= knots_[span + 1]) ++span;
  std::vector<double> d(coefficients.begin() + static_cast<std::ptrdiff_t>(span - degree_),
                        coefficients.begin() + static_cast<std::ptrdiff_t>(span) + 1);
  for (std::size_t r = 1; r <= degree_; ++r) {
    for (std::size_t j = degree_; j >= r; --j) {
      const double left = knots_[span - degree_ + j], right = knots_[span + 1 + j - r];
      const double share = (q - left) / (right - left);
      d[j] = (1.0 - share) * d[j - 1] + share * d[j];
    }
  }
  return d[degree_];
}

std::vector<double> equal_pieces(double from, double to, int pieces) {
  std::vector<double> ends;
  for (int i = 0; i < pieces; ++i) ends.push_back(from + (to - from) * static_cast<double>(i) / pieces);
  ends.push_back(to);
  return ends;
}

}  // namespace volcal::sim
