// What every registered basis must keep, on linear and rotary axes, for several degrees.

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

Axis linear_axis() {
  Axis axis;
  axis.name = AxisName::Y;
  axis.travel_min = -0.25;
  axis.travel_max = 0.55;
  return axis;
}

Axis rotary_axis() {
  Axis axis;
  axis.name = AxisName::C;
  axis.travel_min = -std::numbers::pi;
  axis.travel_max = std::numbers::pi;
  return axis;
}

struct Example {
  std::string name;
  Axis axis;
  std::unique_ptr<Basis> basis;
};

FunctionSpec spec_of(const BasisKind& kind, const Axis& axis, int degree) {
  FunctionSpec spec;
  spec.basis = std::string(kind.name);
  spec.degree = degree;
  if (kind.uses_knots) {
    spec.knots = KnotChoice::Explicit;
    spec.breakpoints = uniform_breakpoints(axis, 7);
    spec.breakpoints[3] += 0.04 * axis.travel();
  }
  return spec;
}

std::vector<Example> examples() {
  std::vector<Example> all;
  for (const BasisKind* kind : basis_kinds()) {
    for (const Axis& axis : {linear_axis(), rotary_axis()}) {
      if (is_rotary(axis.name) ? !kind->rotary_axes : !kind->linear_axes) continue;
      for (const int degree : std::set<int>{kind->degree_min, std::min(kind->degree_max, 3),
                                            std::min(kind->degree_max, 8), kind->degree_max}) {
        const std::string name =
            std::string(kind->name) + " of degree " + std::to_string(degree) + " on " + letter_of(axis.name);
        all.push_back({name, axis, kind->make(spec_of(*kind, axis, degree), axis)});
      }
    }
  }
  return all;
}

/// Positions inside the travel, on its ends and somewhat outside.
std::vector<double> positions(const Axis& axis) {
  std::vector<double> all;
  for (int i = -3; i <= 43; ++i) all.push_back(axis.travel_min + axis.travel() * i / 40.0);
  return all;
}

/// Integral of the product of two functions over the pieces.
double integral(const Basis& basis, const std::vector<double>& ends, int i, int j, int order) {
  constexpr int kSteps = 2000;  // Simpson's rule on every piece
  double sum = 0.0;
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const double step = (ends[piece + 1] - ends[piece]) / kSteps;
    for (int k = 0; k <= kSteps; ++k) {
      double q = ends[piece] + k * step;
      if (k == kSteps) q = std::nextafter(ends[piece + 1], ends[piece]);
      const Eigen::VectorXd row = basis.row(q, order);
      sum += (k == 0 || k == kSteps ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * step / 3.0 * row[i] * row[j];
    }
  }
  return sum;
}

TEST(BasisContract, KindsDescribeThemselves) {
  std::set<std::string_view> names;
  for (const BasisKind* kind : basis_kinds()) {
    EXPECT_FALSE(kind->name.empty());
    EXPECT_FALSE(kind->summary.empty()) << kind->name;
    EXPECT_FALSE(kind->source.empty()) << kind->name;
    EXPECT_LE(kind->degree_min, kind->degree_max) << kind->name;
    EXPECT_TRUE(kind->linear_axes || kind->rotary_axes) << kind->name;
    EXPECT_TRUE(names.insert(kind->name).second) << kind->name << " is registered twice";
    EXPECT_EQ(find_basis(kind->name), kind);
  }
  EXPECT_EQ(find_basis("wavelet"), nullptr);
  EXPECT_EQ(basis_names().size(), names.size());
  for (const char* promised : {"bspline", "legendre", "fourier", "zero"}) {
    EXPECT_TRUE(names.contains(promised)) << promised;
  }
}

TEST(BasisContract, ZeroCoefficientsGiveZero) {
  for (const Example& example : examples()) {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(example.basis->size());
    for (const double q : positions(example.axis)) EXPECT_EQ(example.basis->value(q, none), 0.0);
  }
}

TEST(BasisContract, ActiveFunctionsAreWithinTheBasis) {
  for (const Example& example : examples()) {
    const Basis& basis = *example.basis;
    ASSERT_LE(basis.support(), kMaxBasisSupport) << example.name;
    ASSERT_LE(basis.support(), basis.size()) << example.name;
    std::array<double, kMaxBasisSupport + 1> values;
    for (const double q : positions(example.axis)) {
      values.fill(-7.0);
      const int first = basis.evaluate(q, values.data());
      EXPECT_GE(first, 0) << example.name;
      EXPECT_LE(first + basis.support(), basis.size()) << example.name;
      EXPECT_EQ(values[static_cast<std::size_t>(basis.support())], -7.0)
          << example.name << " writes too much";
    }
  }
}

TEST(BasisContract, ValueIsTheSumOverTheRow) {
  for (const Example& example : examples()) {
    const Eigen::VectorXd c = Eigen::VectorXd::LinSpaced(example.basis->size(), 1.0, 2.0);
    for (const double q : positions(example.axis)) {
      const Eigen::VectorXd row = example.basis->row(q);
      EXPECT_NEAR(example.basis->value(q, c), row.dot(c), 1e-13 * (1.0 + row.lpNorm<1>())) << example.name;
    }
  }
}

TEST(BasisContract, ConstantsAreInTheBasis) {
  for (const Example& example : examples()) {
    const int size = example.basis->size();
    if (size == 0) continue;
    const auto at = positions(example.axis);
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(at.size()), size);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double inside = std::clamp(at[i], example.axis.travel_min, example.axis.travel_max);
      rows.row(static_cast<Eigen::Index>(i)) = example.basis->row(inside);
    }
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(rows.rows());
    const Eigen::VectorXd c = rows.completeOrthogonalDecomposition().solve(ones);
    EXPECT_LT((rows * c - ones).norm(), 1e-11) << example.name;
  }
}

/// Derivatives of order k + 1 against central differences of order k.
TEST(BasisContract, DerivativesAgreeWithDifferences) {
  for (const Example& example : examples()) {
    const double step = 1e-6 * example.axis.travel();
    for (int i = 0; i < 40; ++i) {
      const double q = example.axis.travel_min + example.axis.travel() * (i + 0.37) / 40.0;
      for (int order = 0; order <= 2; ++order) {
        const Eigen::VectorXd slope = example.basis->row(q, order + 1);
        const Eigen::VectorXd difference =
            (example.basis->row(q + step, order) - example.basis->row(q - step, order)) / (2.0 * step);
        const double scale = 1.0 + slope.lpNorm<Eigen::Infinity>();
        EXPECT_LT((slope - difference).lpNorm<Eigen::Infinity>(), 1e-4 * scale)
            << example.name << " at " << q;
      }
    }
  }
}

/// The travel outside the ends: the end pieces continued, so that a Taylor expansion about the end holds.
TEST(BasisContract, EndPiecesAreContinued) {
  for (const Example& example : examples()) {
    for (const double end : {example.axis.travel_min, example.axis.travel_max}) {
      const double outside = (end == example.axis.travel_min ? -1e-3 : 1e-3) * example.axis.travel();
      Eigen::VectorXd taylor = Eigen::VectorXd::Zero(example.basis->size());
      double factor = 1.0;
      for (int order = 0; order <= 8; ++order) {
        taylor += factor * example.basis->row(end, order);
        factor *= outside / (order + 1);
      }
      const Eigen::VectorXd row = example.basis->row(end + outside);
      EXPECT_LT((row - taylor).norm(), 1e-7 * (1.0 + row.norm())) << example.name;
    }
  }
}

TEST(BasisContract, DegreeIsThatOfThePolynomialsOnThePieces) {
  for (const Example& example : examples()) {
    const std::optional<int> degree = example.basis->degree();
    if (!degree || *degree > 8) continue;
    const std::vector<double> ends = example.basis->pieces();
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double middle = 0.5 * (ends[i] + ends[i + 1]);
      EXPECT_EQ(example.basis->row(middle, *degree + 1).norm(), 0.0) << example.name;
      Eigen::VectorXd taylor = Eigen::VectorXd::Zero(example.basis->size());
      const double step = 0.49 * (ends[i + 1] - ends[i]);
      double factor = 1.0;
      for (int order = 0; order <= *degree; ++order) {
        taylor += factor * example.basis->row(middle, order);
        factor *= step / (order + 1);
      }
      EXPECT_LT((example.basis->row(middle + step) - taylor).norm(), 1e-12) << example.name;
    }
  }
}

TEST(BasisContract, PiecesRunOverTheTravel) {
  for (const Example& example : examples()) {
    const std::vector<double> ends = example.basis->pieces();
    ASSERT_GE(ends.size(), 2U) << example.name;
    EXPECT_EQ(ends.front(), example.axis.travel_min) << example.name;
    EXPECT_EQ(ends.back(), example.axis.travel_max) << example.name;
    EXPECT_TRUE(std::ranges::is_sorted(ends)) << example.name;
    EXPECT_GE(example.basis->quadrature_order(), 1) << example.name;
  }
}

TEST(BasisContract, GramMatrixAgreesWithSimpsonsRule) {
  for (const Example& example : examples()) {
    const int size = example.basis->size();
    if (size == 0 || size > 12) continue;
    for (const int order : {0, 1, 2}) {
      const Eigen::MatrixXd products = gram(*example.basis, order);
      for (const int i : {0, size / 2}) {
        for (const int j : {i, std::min(i + 1, size - 1)}) {
          const double expected = integral(*example.basis, example.basis->pieces(), i, j, order);
          EXPECT_NEAR(products(i, j), expected, 1e-8 * products.norm()) << example.name << " order " << order;
        }
      }
    }
  }
}

TEST(BasisContract, MomentsAreProductsWithConstantAndPosition) {
  for (const Example& example : examples()) {
    if (example.basis->size() == 0) continue;
    const BasisMoments found = moments(*example.basis);
    // Products of the basis' own constant and of q: by the trapezoidal rule on a fine grid.
    constexpr int kSteps = 40000;
    const double step = example.axis.travel() / kSteps;
    Eigen::VectorXd zeroth = Eigen::VectorXd::Zero(example.basis->size());
    Eigen::VectorXd first = zeroth;
    for (int k = 0; k < kSteps; ++k) {
      const double q = example.axis.travel_min + (k + 0.5) * step;
      const Eigen::VectorXd row = example.basis->row(q) * step;
      zeroth += row;
      first += q * row;
    }
    EXPECT_LT((found.zeroth - zeroth).norm(), 1e-6 * example.axis.travel()) << example.name;
    EXPECT_LT((found.first - first).norm(), 1e-6 * example.axis.travel()) << example.name;
  }
}

TEST(BasisContract, SmoothingPriorAsksForADerivativeThatExists) {
  for (const Example& example : examples()) {
    const int order = example.basis->roughness_order();
    ASSERT_GE(order, 0) << example.name;
    if (order == 0) continue;
    EXPECT_GT(gram(*example.basis, order).norm(), 0.0) << example.name;
  }
}

TEST(BasisContract, DegreesOutsideTheRangeAreRefused) {
  for (const BasisKind* kind : basis_kinds()) {
    if (kind->name == "zero") continue;  // has no degree
    const Axis axis = kind->linear_axes ? linear_axis() : rotary_axis();
    for (const int degree : {kind->degree_min - 1, kind->degree_max + 1}) {
      EXPECT_THROW(kind->make(spec_of(*kind, axis, degree), axis), std::invalid_argument) << kind->name;
    }
  }
}

}  // namespace
}  // namespace volcal
