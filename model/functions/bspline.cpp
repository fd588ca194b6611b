#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr int kMaxSplineDegree = 3;
constexpr int kStride = kMaxSplineDegree + 1;
/// Power coefficients of a polynomial in the local coordinate t = (q - a) / (b - a) of one piece [a, b].
using Polynomial = std::array<double, kStride>;

/// (slope t + constant) * p
Polynomial times_linear(const Polynomial& p, double slope, double constant) {
  Polynomial product{};
  for (int i = 0; i < kStride; ++i) {
    product[i] += constant * p[i];
    if (i + 1 < kStride) product[i + 1] += slope * p[i];
  }
  return product;
}

/// Clamped B-spline of degree 1 to 3. The Cox-de Boor recursion runs once, on polynomials, for every piece;
/// evaluation is Horner's rule.
class BSpline final : public Basis {
 public:
  BSpline(int degree, std::vector<double> breakpoints)
      : degree_(degree), breakpoints_(std::move(breakpoints)) {
    const auto pieces = breakpoints_.size() - 1;
    const double length = breakpoints_.back() - breakpoints_.front();
    pieces_per_unit_ = static_cast<double>(pieces) / length;
    for (std::size_t piece = 0; piece < pieces; ++piece) append_piece(static_cast<int>(piece));
  }

  int size() const override { return piece_count() + degree_; }
  int support() const override { return degree_ + 1; }
  std::vector<double> pieces() const override { return breakpoints_; }
  std::optional<int> degree() const override { return degree_; }
  int quadrature_order() const override { return degree_ + 1; }
  int roughness_order() const override { return degree_ == 1 ? 1 : 2; }

  int evaluate(double q, int order, double* values) const override {
    const int piece = find_piece(q);
    const auto at = static_cast<std::size_t>(piece);
    const double t = (q - breakpoints_[at]) * inverse_width_[at];
    const double* coefficients = &coefficients_[at * kStride * kStride];
    if (order == 0) {
      for (int j = 0; j <= degree_; ++j, coefficients += kStride) {
        values[j] = coefficients[0] + t * (coefficients[1] + t * (coefficients[2] + t * coefficients[3]));
      }
    } else {
      const double scale = std::pow(inverse_width_[at], order);
      for (int j = 0; j <= degree_; ++j, coefficients += kStride) {
        values[j] = scale * derivative(coefficients, t, order);
      }
    }
    return piece;
  }

 private:
  int piece_count() const { return static_cast<int>(breakpoints_.size()) - 1; }

  /// Breakpoint `i` of the clamped knot vector: ends repeat.
  double knot(int i) const { return breakpoints_[static_cast<std::size_t>(std::clamp(i, 0, piece_count()))]; }

  void append_piece(int piece) {
    const double a = knot(piece);
    const double width = knot(piece + 1) - a;
    inverse_width_.push_back(1.0 / width);
    // active[j]: function piece - d + j of degree d, on this piece; knots numbered by their breakpoint.
    std::array<Polynomial, kStride> active{};
    active[0][0] = 1.0;
    for (int d = 1; d <= degree_; ++d) {
      std::array<Polynomial, kStride> raised{};
      for (int j = 0; j < d; ++j) {
        const double left = knot(piece - d + 1 + j);
        const double right = knot(piece + 1 + j);
        const double slope = width / (right - left);
        const double constant = (a - left) / (right - left);
        const Polynomial rising = times_linear(active[j], slope, constant);
        const Polynomial falling = times_linear(active[j], -slope, (right - a) / (right - left));
        for (int k = 0; k < kStride; ++k) {
          raised[j][k] += falling[k];
          raised[j + 1][k] += rising[k];
        }
      }
      active = raised;
    }
    for (const Polynomial& polynomial : active) {
      coefficients_.insert(coefficients_.end(), polynomial.begin(), polynomial.end());
    }
  }

  int find_piece(double q) const {
    const int last = piece_count() - 1;
    // Right for equal pieces; a few steps of search mend it for others. NaN is in the first piece.
    const double guess = (q - breakpoints_.front()) * pieces_per_unit_;
    int piece = !(guess > 0.0) ? 0 : guess >= last ? last : static_cast<int>(guess);
    while (piece < last && q >= breakpoints_[static_cast<std::size_t>(piece) + 1]) ++piece;
    while (piece > 0 && q < breakpoints_[static_cast<std::size_t>(piece)]) --piece;
    return piece;
  }

  double derivative(const double* coefficients, double t, int order) const {
    double sum = 0.0;
    for (int power = degree_; power >= order; --power) {
      double factor = 1.0;
      for (int k = 0; k < order; ++k) factor *= power - k;
      sum = sum * t + factor * coefficients[power];
    }
    return sum;
  }

  int degree_;
  std::vector<double> breakpoints_;
  double pieces_per_unit_ = 0.0;
  std::vector<double> inverse_width_;  ///< per piece
  std::vector<double> coefficients_;   ///< [piece][function][power]
};

std::vector<double> checked_breakpoints(const FunctionSpec& spec, const Axis& axis) {
  std::vector<double> breakpoints = spec.breakpoints;
  if (breakpoints.size() < 2) throw std::invalid_argument("a B-spline needs at least two breakpoints");
  const auto out_of_order = [](double a, double b) { return !(a < b); };
  if (std::ranges::adjacent_find(breakpoints, out_of_order) != breakpoints.end()) {
    throw std::invalid_argument("breakpoints must ascend, each greater than the one before");
  }
  const double tolerance = 1e-9 * axis.travel();
  if (std::abs(breakpoints.front() - axis.travel_min) > tolerance ||
      std::abs(breakpoints.back() - axis.travel_max) > tolerance) {
    throw std::invalid_argument(std::string("breakpoints must start and end with the travel of axis ") +
                                letter_of(axis.name));
  }
  breakpoints.front() = axis.travel_min;
  breakpoints.back() = axis.travel_max;
  return breakpoints;
}

std::unique_ptr<Basis> make_bspline(const FunctionSpec& spec, const Axis& axis) {
  if (spec.degree < 1 || spec.degree > kMaxSplineDegree) {
    throw std::invalid_argument("degree of a B-spline must be 1, 2 or 3");
  }
  return std::make_unique<BSpline>(spec.degree, checked_breakpoints(spec, axis));
}

}  // namespace

extern const BasisKind kBSplineBasis = {
    .name = "bspline",
    .summary = "clamped B-spline of degree 1 to 3; degrees 1 and 2 are the linear and quadratic 1-D elements",
    .source = "C. de Boor, A Practical Guide to Splines, 1978, ch. IX-X",
    .degree_min = 1,
    .degree_max = kMaxSplineDegree,
    .linear_axes = true,
    .rotary_axes = true,
    .uses_knots = true,
    .make = make_bspline,
};

}  // namespace volcal
