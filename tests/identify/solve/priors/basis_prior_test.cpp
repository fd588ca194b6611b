/// What a basis decides of the priors of its functions.

#include "volcal/identify/solve/priors/basis_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

Axis half_metre() {
  Axis axis;
  axis.name = AxisName::X;
  axis.travel_min = 0.1;
  axis.travel_max = 0.6;
  return axis;
}

FunctionSpec function_of(const std::string& basis, int degree) {
  FunctionSpec spec;
  spec.basis = basis;
  spec.degree = degree;
  spec.breakpoints = uniform_breakpoints(half_metre(), 4);
  return spec;
}

std::unique_ptr<Basis> made(const FunctionSpec& spec) {
  return find_basis(spec.basis)->make(spec, half_metre());
}

TEST(BasisPrior, SplinesWithAutomaticKnotsAreSmoothed) {
  FunctionSpec spec = function_of("bspline", 3);
  EXPECT_TRUE(is_smoothed(spec, *made(spec)));
  spec.knots = KnotChoice::Explicit;
  EXPECT_FALSE(is_smoothed(spec, *made(spec)));
  const FunctionSpec legendre = function_of("legendre", 5);
  EXPECT_FALSE(is_smoothed(legendre, *made(legendre)));
}

/// Splines are a partition of unity: coefficients of 1 are the constant 1, mean square 1. The quadratic form
/// of a straight line a (q - middle), which has no curvature, is its mean square a^2 L^2 / 12.
TEST(BasisPrior, WideIsTheMeanSquareOfWhatIsStraight) {
  const FunctionSpec spec = function_of("bspline", 1);
  const auto basis = made(spec);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(basis->size());
  EXPECT_NEAR(one.dot(wide_precision(*basis, half_metre(), false) * one), 1.0, 1e-12);
  const FunctionSpec cubic = function_of("bspline", 3);
  const auto smooth = made(cubic);
  const Eigen::MatrixXd precision = wide_precision(*smooth, half_metre(), true);
  const Eigen::MatrixXd without_curvature = gram(*smooth, 0) / 0.5;
  EXPECT_TRUE(precision.isApprox(without_curvature + 1e-3 * std::pow(0.5, 3) * gram(*smooth, 2), 1e-12));
}

/// Legendre polynomials say themselves how smooth they are: the mean square alone, 1 / (2 n + 1) of P_n.
TEST(BasisPrior, WideOfPolynomialsIsTheirMeanSquare) {
  const FunctionSpec spec = function_of("legendre", 3);
  const auto basis = made(spec);
  const Eigen::MatrixXd precision = wide_precision(*basis, half_metre(), false);
  for (int n = 0; n < basis->size(); ++n) EXPECT_NEAR(precision(n, n), 1.0 / (2 * n + 1), 1e-12);
}

/// Over a turn of T = 2 pi the mean square of cos nq is 1/2, that of its curvature n^4 / 2: a harmonic that
/// the program chose costs (1 + 1e-3 T^4 n^4) / 2, one that the user stated 1/2.
TEST(BasisPrior, WideOfChosenHarmonicsIsSmooth) {
  Axis turn;
  turn.name = AxisName::C;
  turn.travel_min = -std::numbers::pi;
  turn.travel_max = std::numbers::pi;
  FunctionSpec spec;
  spec.basis = "fourier";
  spec.degree = 12;
  const auto basis = find_basis(spec.basis)->make(spec, turn);
  const Eigen::MatrixXd stated = wide_precision(*basis, turn, false);
  const Eigen::MatrixXd chosen = wide_precision(*basis, turn, true);
  for (const int n : {1, 5, 12}) {
    const int sine = 2 * n;
    EXPECT_NEAR(stated(sine, sine), 0.5, 1e-9) << n;
    const double curvature = 1e-3 * std::pow(2.0 * std::numbers::pi * n, 4);
    EXPECT_NEAR(chosen(sine, sine), 0.5 * (1.0 + curvature), 1e-9 * curvature) << n;
  }
}

}  // namespace
}  // namespace volcal
