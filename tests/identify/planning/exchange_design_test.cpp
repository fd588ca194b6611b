/// Exact designs against optima of the literature: polynomials on [-1, 1].

#include "volcal/identify/planning/exchange_design.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace volcal {
namespace {

constexpr int kSteps = 20;  // of the candidates between -1 and 1

double place(int candidate) { return -1.0 + 2.0 * candidate / kSteps; }

Eigen::RowVectorXd powers(double x, int degree) {
  Eigen::RowVectorXd row(degree + 1);
  for (int k = 0; k <= degree; ++k) row[k] = std::pow(x, k);
  return row;
}

DesignPool polynomial(int degree, int capacity) {
  DesignPool pool{Eigen::MatrixXd(kSteps + 1, degree + 1), {0}, capacity};
  for (int i = 0; i <= kSteps; ++i) {
    pool.rows.row(i) = powers(place(i), degree);
    pool.first.push_back(i + 1);
  }
  return pool;
}

Eigen::MatrixXd hardly_known(int degree) { return 1e-7 * Eigen::MatrixXd::Identity(degree + 1, degree + 1); }

/// Slope of a line: c-optimal, half of the readings at each end (Fedorov 1972, 2.1); variance 1 / N.
TEST(ExchangeDesign, SlopeOfALineIsMeasuredAtItsEnds) {
  const DesignCriterion slope(Eigen::RowVector2d(0.0, 1.0), Aggregate::Mean);
  const ExchangeResult design = exchange_design(polynomial(1, 10), hardly_known(1), slope, 10);
  EXPECT_TRUE(design.converged);
  EXPECT_EQ(design.taken.front(), 5);
  EXPECT_EQ(design.taken.back(), 5);
  EXPECT_NEAR(design.value, 1.0 / 10.0, 1e-6);
}

/// A-optimal for a quadratic: weights 1/4, 1/2, 1/4 at -1, 0, 1 (Atkinson, Donev and Tobias 2007, 10.1); the
/// trace of the inverse information is then 8 / N.
TEST(ExchangeDesign, QuadraticByItsTrace) {
  const DesignCriterion trace(Eigen::Matrix3d::Identity(), Aggregate::Mean);
  const ExchangeResult design = exchange_design(polynomial(2, 100), hardly_known(2), trace, 40);
  EXPECT_EQ(design.taken.front(), 10);
  EXPECT_EQ(design.taken[kSteps / 2], 20);
  EXPECT_EQ(design.taken.back(), 10);
  EXPECT_NEAR(3.0 * design.value, 8.0 / 40.0, 1e-6);
}

/// Minimax prediction variance is D-optimality (Kiefer and Wolfowitz 1960, Canad. J. Math. 12, 363): a third
/// each at -1, 0, 1, largest variance 3 / N.
TEST(ExchangeDesign, LargestPredictionVarianceOfAQuadratic) {
  const DesignPool pool = polynomial(2, 100);
  const DesignCriterion largest(pool.rows, Aggregate::Largest);
  const ExchangeResult design = exchange_design(pool, hardly_known(2), largest, 30);
  EXPECT_NEAR(design.taken.front(), 10, 1);
  EXPECT_NEAR(design.taken[kSteps / 2], 10, 1);
  EXPECT_NEAR(design.taken.back(), 10, 1);
}

/// Value at 2 of a line, from readings in [-1, 1]: weights (1 + 1/2) / 2 = 3/4 at 1 and 1/4 at -1, variance
/// (|l_1| + |l_2|)^2 / N = (3/2 + 1/2)^2 / N with Lagrange's l (Hoel and Levine 1964, Ann. Math. Statist. 35,
/// 1553).
TEST(ExchangeDesign, ExtrapolationOfALine) {
  const DesignCriterion ahead(powers(2.0, 1), Aggregate::Mean);
  const ExchangeResult design = exchange_design(polynomial(1, 100), hardly_known(1), ahead, 40);
  EXPECT_EQ(design.taken.front(), 10);
  EXPECT_EQ(design.taken.back(), 30);
  EXPECT_NEAR(design.value, 4.0 / 40.0, 1e-6);
}

/// Every place once: the outermost ones, symmetric.
TEST(ExchangeDesign, CandidatesThatCanBeTakenOnce) {
  const DesignCriterion slope(Eigen::RowVector2d(0.0, 1.0), Aggregate::Mean);
  const ExchangeResult design = exchange_design(polynomial(1, 1), hardly_known(1), slope, 8);
  for (int i = 0; i <= kSteps; ++i) EXPECT_EQ(design.taken[i], i < 4 || i > kSteps - 4 ? 1 : 0) << i;
}

/// What is known beforehand makes readings elsewhere worth more: with the value at -1 known, all are taken
/// at 1.
TEST(ExchangeDesign, CountsWhatIsKnown) {
  const DesignCriterion slope(Eigen::RowVector2d(0.0, 1.0), Aggregate::Mean);
  const Eigen::RowVector2d at_lower_end = powers(-1.0, 1);
  const Eigen::MatrixXd known = hardly_known(1) + 1e6 * at_lower_end.transpose() * at_lower_end;
  const ExchangeResult design = exchange_design(polynomial(1, 10), known, slope, 6);
  EXPECT_EQ(design.taken.back(), 6);
}

TEST(ExchangeDesign, DoesNotDependOnThreads) {
  const DesignPool pool = polynomial(4, 3);
  const DesignCriterion criterion(pool.rows, Aggregate::Mean);
  ExchangeOptions four;
  four.threads = 4;
  EXPECT_EQ(exchange_design(pool, hardly_known(4), criterion, 17).taken,
            exchange_design(pool, hardly_known(4), criterion, 17, four).taken);
}

TEST(ExchangeDesign, RefusesWhatDoesNotFit) {
  const DesignCriterion slope(Eigen::RowVector2d(0.0, 1.0), Aggregate::Mean);
  EXPECT_THROW(exchange_design(polynomial(1, 1), hardly_known(1), slope, 22), std::invalid_argument);
  EXPECT_THROW(exchange_design(polynomial(1, 1), hardly_known(2), slope, 4), std::invalid_argument);
}

}  // namespace
}  // namespace volcal
