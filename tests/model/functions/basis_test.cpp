// Values of the bases against hand-worked ones.

#include "volcal/model/functions/basis.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

Axis axis_of(AxisName name, double travel_min, double travel_max) {
  Axis axis;
  axis.name = name;
  axis.travel_min = travel_min;
  axis.travel_max = travel_max;
  return axis;
}

FunctionSpec spline_spec(int degree, std::vector<double> breakpoints) {
  FunctionSpec spec;
  spec.degree = degree;
  spec.knots = KnotChoice::Explicit;
  spec.breakpoints = std::move(breakpoints);
  return spec;
}

std::unique_ptr<Basis> spline(int degree, const std::vector<double>& breakpoints) {
  const Axis axis = axis_of(AxisName::X, breakpoints.front(), breakpoints.back());
  return find_basis("bspline")->make(spline_spec(degree, breakpoints), axis);
}

std::unique_ptr<Basis> series(const char* name, int degree, const Axis& axis) {
  FunctionSpec spec;
  spec.basis = name;
  spec.degree = degree;
  return find_basis(name)->make(spec, axis);
}

const std::vector<double> kUneven = {-0.2, 0.0, 0.05, 0.3, 0.31, 0.7};

TEST(BSpline, PartitionOfUnity) {
  for (int degree = 1; degree <= 3; ++degree) {
    const auto basis = spline(degree, kUneven);
    EXPECT_EQ(basis->size(), 5 + degree);
    EXPECT_EQ(basis->support(), degree + 1);
    for (int i = 0; i <= 300; ++i) {
      const double q = -0.2 + 0.9 * i / 300.0;
      const Eigen::VectorXd row = basis->row(q);
      EXPECT_NEAR(row.sum(), 1.0, 1e-14);
      EXPECT_GE(row.minCoeff(), -1e-15);
      EXPECT_NEAR(basis->row(q, 1).sum(), 0.0, 1e-10);
    }
  }
}

/// Linear 1-D elements: hat functions, 1 at their own node and 0 at the others.
TEST(BSpline, DegreeOneIsTheLinearElement) {
  const auto basis = spline(1, kUneven);
  for (std::size_t node = 0; node < kUneven.size(); ++node) {
    const Eigen::VectorXd row = basis->row(kUneven[node]);
    const auto at = static_cast<Eigen::Index>(node);
    EXPECT_LT((row - Eigen::VectorXd::Unit(basis->size(), at)).norm(), 1e-15);
  }
  // On the element from 0.05 to 0.3: N = (0.3 - q) / 0.25 and (q - 0.05) / 0.25.
  std::array<double, 2> values;
  EXPECT_EQ(basis->evaluate(0.1, values.data()), 2);
  EXPECT_NEAR(values[0], 0.8, 1e-15);
  EXPECT_NEAR(values[1], 0.2, 1e-15);
}

/// One quadratic 1-D element: Bernstein functions (1 - t)^2, 2 t (1 - t), t^2 span the element's three shape
/// functions; its mid-node value is (c0 + 2 c1 + c2) / 4.
TEST(BSpline, DegreeTwoIsTheQuadraticElement) {
  const auto basis = spline(2, {0.0, 2.0});
  const Eigen::VectorXd row = basis->row(0.5);
  EXPECT_LT((row - Eigen::Vector3d(0.5625, 0.375, 0.0625)).norm(), 1e-15);
  // Nodal values 3, 5, 4: c1 = 2 * 5 - (3 + 4) / 2 = 6.5; at t = 1/4 the shape functions
  // (1 - t)(1 - 2t), 4t(1 - t), t(2t - 1) = 0.375, 0.75, -0.125 give 1.125 + 3.75 - 0.5 = 4.375.
  EXPECT_NEAR(basis->value(0.5, Eigen::Vector3d(3, 6.5, 4)), 4.375, 1e-15);
  EXPECT_NEAR(basis->value(1.0, Eigen::Vector3d(3, 6.5, 4)), 5.0, 1e-15);
}

/// Uniform cubic spline in its inner pieces, at a knot: 1/6, 4/6, 1/6, 0; slopes -1/2h, 0, 1/2h; second
/// derivatives 1, -2, 1 over h squared.
TEST(BSpline, CubicAtAnInnerKnot) {
  const auto basis = spline(3, {0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4});
  std::array<double, 4> values;
  EXPECT_EQ(basis->evaluate(2.0, 0, values.data()), 4);
  const auto expect_values = [&](double a, double b, double c, double tolerance) {
    EXPECT_NEAR(values[0], a, tolerance);
    EXPECT_NEAR(values[1], b, tolerance);
    EXPECT_NEAR(values[2], c, tolerance);
    EXPECT_NEAR(values[3], 0.0, tolerance);
  };
  expect_values(1.0 / 6, 4.0 / 6, 1.0 / 6, 1e-15);
  basis->evaluate(2.0, 1, values.data());
  expect_values(-1, 0, 1, 1e-14);
  basis->evaluate(2.0, 2, values.data());
  expect_values(4, -8, 4, 1e-13);
  basis->evaluate(2.0, 4, values.data());
  expect_values(0, 0, 0, 0.0);
}

/// Greville: sum of the knot averages times B_j is q; clamped ends interpolate.
TEST(BSpline, ReproducesPolynomialsOfItsDegree) {
  for (int degree = 1; degree <= 3; ++degree) {
    const auto basis = spline(degree, kUneven);
    const int size = basis->size();
    Eigen::MatrixXd rows(60, size);
    for (int i = 0; i < 60; ++i) rows.row(i) = basis->row(-0.2 + 0.9 * i / 59.0);
    for (int power = 0; power <= degree; ++power) {
      const auto polynomial = [power](double q) { return std::pow(q - 0.1, power); };
      Eigen::VectorXd values(60);
      for (int i = 0; i < 60; ++i) values[i] = polynomial(-0.2 + 0.9 * i / 59.0);
      const Eigen::VectorXd c = rows.colPivHouseholderQr().solve(values);
      EXPECT_LT((rows * c - values).lpNorm<Eigen::Infinity>(), 1e-14);
      // and beyond the travel, where the end pieces go on
      EXPECT_NEAR(basis->value(-0.35, c), polynomial(-0.35), 1e-11);
      EXPECT_NEAR(basis->value(0.9, c), polynomial(0.9), 1e-11);
    }
  }
}

TEST(BSpline, GrevilleAbscissaeGiveTheIdentity) {
  const auto basis = spline(3, {0, 1, 2, 4});
  // Knots 0 0 0 0 1 2 4 4 4 4: averages of three, 0, 1/3, 1, 7/3, 10/3, 4.
  Eigen::VectorXd greville(6);
  greville << 0, 1.0 / 3, 1, 7.0 / 3, 10.0 / 3, 4;
  for (const double q : {0.0, 0.4, 1.0, 1.9, 3.3, 4.0}) EXPECT_NEAR(basis->value(q, greville), q, 1e-14);
}

/// The coefficients of 2 - 3 q are 2 - 3 times the Greville abscissae, and its integrals with the functions
/// give these back.
TEST(BSpline, CoefficientsFollowFromIntegrals) {
  const auto basis = spline(3, {0, 1, 2, 4});
  Eigen::VectorXd greville(6);
  greville << 0, 1.0 / 3, 1, 7.0 / 3, 10.0 / 3, 4;
  const BasisMoments moment = moments(*basis);
  const Eigen::VectorXd line = coefficients_with_integrals(*basis, 2.0 * moment.zeroth - 3.0 * moment.first);
  for (int j = 0; j < 6; ++j) EXPECT_NEAR(line[j], 2.0 - 3.0 * greville[j], 1e-12) << j;
}

/// Of degree 1 the coefficients are the values at the breakpoints; 20,001 of them take no matrix of 3 GB.
TEST(BSpline, CoefficientsFollowFromIntegralsOfThousands) {
  std::vector<double> breakpoints;
  for (int i = 0; i <= 20000; ++i) breakpoints.push_back(1e-4 * i);
  const auto basis = spline(1, breakpoints);
  const BasisMoments moment = moments(*basis);
  const Eigen::VectorXd line = coefficients_with_integrals(*basis, moment.first);
  for (const int j : {0, 1, 7000, 20000}) EXPECT_NEAR(line[j], 1e-4 * j, 1e-12) << j;
}

TEST(BSpline, UniformAndUnevenBreakpointsFindTheSamePiece) {
  // Equal pieces whose ends are not exact binary numbers.
  const Axis axis = axis_of(AxisName::X, 0.1, 0.8);
  const auto breakpoints = uniform_breakpoints(axis, 7);
  const auto basis = find_basis("bspline")->make(spline_spec(2, breakpoints), axis);
  std::array<double, 3> values;
  for (int piece = 0; piece < 7; ++piece) {
    const double start = breakpoints[static_cast<std::size_t>(piece)];
    EXPECT_EQ(basis->evaluate(start, values.data()), piece);
    EXPECT_EQ(basis->evaluate(std::nextafter(start, 0.0), values.data()), std::max(piece - 1, 0));
  }
  EXPECT_EQ(basis->evaluate(0.8, values.data()), 6);
}

TEST(BSpline, HasNoValueAtWhatIsNoNumber) {
  for (int degree = 1; degree <= 3; ++degree) {
    const auto basis = spline(degree, kUneven);
    std::array<double, 4> values{};
    EXPECT_EQ(basis->evaluate(std::nan(""), 0, values.data()), 0);
    EXPECT_TRUE(std::isnan(values[0]));
  }
}

TEST(BSpline, RefusesBreakpointsThatDoNotAscendOrMissTheTravel) {
  const Axis axis = axis_of(AxisName::X, 0.0, 1.0);
  const BasisKind& kind = *find_basis("bspline");
  for (const std::vector<double>& wrong : std::vector<std::vector<double>>{
           {}, {0.0}, {0.0, 0.5, 0.5, 1.0}, {0.0, 0.7, 0.6, 1.0}, {0.0, NAN, 1.0}, {0.1, 1.0}, {0.0, 0.9}}) {
    EXPECT_THROW(kind.make(spline_spec(3, wrong), axis), std::invalid_argument);
  }
}

/// Hat functions on [0, 1, 3].
TEST(Moments, OfHatFunctions) {
  const BasisMoments m = moments(*spline(1, {0, 1, 3}));
  EXPECT_LT((m.zeroth - Eigen::Vector3d(0.5, 1.5, 1.0)).norm(), 1e-15);
  // int_0^1 q (1 - q) = 1/6; int_0^1 q^2 + int_1^3 q (3 - q) / 2 = 1/3 + 5/3; int_1^3 q (q - 1) / 2 = 7/3.
  EXPECT_LT((m.first - Eigen::Vector3d(1.0 / 6, 2.0, 7.0 / 3)).norm(), 1e-14);
}

/// Hat functions on [0, 1, 3]: mass matrix h/3, h/6 and stiffness matrix +-1/h of linear elements.
TEST(Gram, OfHatFunctions) {
  const auto basis = spline(1, {0, 1, 3});
  Eigen::Matrix3d mass;
  mass << 1.0 / 3, 1.0 / 6, 0, 1.0 / 6, 1.0, 1.0 / 3, 0, 1.0 / 3, 2.0 / 3;
  EXPECT_LT((gram(*basis, 0) - mass).norm(), 1e-15);
  Eigen::Matrix3d stiffness;
  stiffness << 1, -1, 0, -1, 1.5, -0.5, 0, -0.5, 0.5;
  EXPECT_LT((gram(*basis, 1) - stiffness).norm(), 1e-14);
}

/// On one piece of length 2 the second derivatives of (1-t)^2, 2t(1-t), t^2 are 1/2, -1, 1/2.
TEST(Gram, OfSecondDerivatives) {
  Eigen::Matrix3d expected;
  expected << 0.5, -1, 0.5, -1, 2, -1, 0.5, -1, 0.5;
  EXPECT_LT((gram(*spline(2, {0, 2}), 2) - expected).norm(), 1e-14);
}

TEST(Legendre, PolynomialsScaledToTheTravel) {
  const auto basis = series("legendre", 3, axis_of(AxisName::X, 1.0, 5.0));
  // q = 4: t = 1/2; P = 1, 1/2, -1/8, -7/16; derivatives 0, 1, 3/2, 3/8 times dt/dq = 1/2.
  EXPECT_LT((basis->row(4.0) - Eigen::Vector4d(1, 0.5, -0.125, -0.4375)).norm(), 1e-15);
  EXPECT_LT((basis->row(4.0, 1) - Eigen::Vector4d(0, 0.5, 0.75, 0.1875)).norm(), 1e-15);
  // Second derivatives 0, 0, 3, 15 t times 1/4; third 0, 0, 0, 15 times 1/8.
  EXPECT_LT((basis->row(4.0, 2) - Eigen::Vector4d(0, 0, 0.75, 1.875)).norm(), 1e-14);
  EXPECT_LT((basis->row(4.0, 3) - Eigen::Vector4d(0, 0, 0, 1.875)).norm(), 1e-14);
}

TEST(Legendre, OrthogonalOverTheTravel) {
  const auto basis = series("legendre", 12, axis_of(AxisName::X, -0.3, 0.9));
  Eigen::VectorXd norms(13);
  for (int n = 0; n <= 12; ++n) norms[n] = 1.2 / (2 * n + 1);
  EXPECT_LT((gram(*basis, 0) - Eigen::MatrixXd(norms.asDiagonal())).norm(), 1e-14);
}

TEST(Fourier, HarmonicsAndTheirDerivatives) {
  const double turn = 2 * std::numbers::pi;
  const auto basis = series("fourier", 2, axis_of(AxisName::C, 0.0, turn));
  Eigen::VectorXd expected(5);
  const double q = 0.7;
  expected << 1, std::cos(q), std::sin(q), std::cos(2 * q), std::sin(2 * q);
  EXPECT_LT((basis->row(q) - expected).norm(), 1e-15);
  expected << 0, std::sin(q), -std::cos(q), 8 * std::sin(2 * q), -8 * std::cos(2 * q);
  EXPECT_LT((basis->row(q, 3) - expected).norm(), 1e-14);
}

TEST(Fourier, OrthogonalOverAFullTurn) {
  constexpr int kHarmonics = 30;
  const double pi = std::numbers::pi;
  const auto basis = series("fourier", kHarmonics, axis_of(AxisName::C, -pi, pi));
  Eigen::VectorXd norms = Eigen::VectorXd::Constant(2 * kHarmonics + 1, pi);
  norms[0] = 2 * pi;
  EXPECT_LT((gram(*basis, 0) - Eigen::MatrixXd(norms.asDiagonal())).norm(), 1e-12);
  const BasisMoments m = moments(*basis);
  EXPECT_NEAR(m.zeroth[0], 2 * pi, 1e-13);
  EXPECT_LT(m.zeroth.tail(2 * kHarmonics).norm(), 1e-13);
  // int q sin kq = -(-1)^k 2 pi / k
  for (Eigen::Index k = 1; k <= kHarmonics; ++k) {
    EXPECT_NEAR(m.first[2 * k], (k % 2 == 0 ? -2.0 : 2.0) * pi / k, 1e-12) << k;
  }
}

TEST(Fourier, IsForRotaryAxes) {
  EXPECT_THROW(series("fourier", 2, axis_of(AxisName::X, 0, 1)), std::invalid_argument);
}

TEST(Zero, HasNoCoefficients) {
  const auto basis = series("zero", 3, axis_of(AxisName::X, 0, 1));
  EXPECT_EQ(basis->size(), 0);
  EXPECT_EQ(basis->value(0.3, Eigen::VectorXd()), 0.0);
  EXPECT_EQ(moments(*basis).zeroth.size(), 0);
  EXPECT_EQ(gram(*basis, 1).size(), 0);
}

TEST(UniformBreakpoints, EndExactlyWithTheTravel) {
  const Axis axis = axis_of(AxisName::X, 0.1, 0.7);
  const auto breakpoints = uniform_breakpoints(axis, 3);
  ASSERT_EQ(breakpoints.size(), 4U);
  EXPECT_EQ(breakpoints.front(), 0.1);
  EXPECT_EQ(breakpoints.back(), 0.7);
  EXPECT_NEAR(breakpoints[1], 0.3, 1e-15);
  EXPECT_THROW(uniform_breakpoints(axis, 0), std::invalid_argument);
}

}  // namespace
}  // namespace volcal
