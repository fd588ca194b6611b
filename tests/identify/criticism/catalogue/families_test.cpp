// Tests of families: how probable the largest of a scan is by chance, and what components of a displacement
// cost. Chance is simulated: residuals are drawn, and the families tested on them.

#include "volcal/identify/criticism/catalogue/families.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "tests/support/hidden_studies.h"

namespace volcal {
namespace {

using testing_support::families_of;
using testing_support::white_projector;
using testing_support::white_residual;

const LinearModel& model_of_families() {
  static const testing_support::FittedStudy fitted(testing_support::hiding({}, {4, 3, 3}));
  return fitted.model;
}

/// Signals of functions as the model expects them: drawn from the prior where it holds a direction to less
/// than a millimetre or milliradian.
class ExpectedFunctions {
 public:
  ExpectedFunctions() {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(model_of_families().problem().prior_precision);
    const Eigen::ArrayXd held = (eigen.eigenvalues().array() > 1e6).cast<double>();
    const Eigen::ArrayXd spread = held * eigen.eigenvalues().array().max(1.0).rsqrt();
    signals_ = model_of_families().problem().jacobian * eigen.eigenvectors() * spread.matrix().asDiagonal();
  }
  Eigen::VectorXd draw(std::mt19937_64& random) const {
    std::normal_distribution<double> normal;
    Eigen::VectorXd amounts(signals_.cols());
    for (double& amount : amounts) amount = normal(random);
    return signals_ * amounts;
  }

 private:
  Eigen::MatrixXd signals_;
};

/// Upper 99.9 % limit of a count whose expectation is no more than n p.
double most_by_chance(double n, double p) { return n * p + 3.1 * std::sqrt(n * p * (1.0 - p)) + 1.0; }

TEST(Families, ScansKeepTheirProbability) {
  const std::vector<Family> scanned = families_of(model_of_families(), "lead-error");
  ASSERT_EQ(scanned.size(), 3U);
  for (const Family& family : scanned) ASSERT_GT(family.scan.size(), 20U);
  std::mt19937_64 random(7);
  constexpr int kDraws = 150;
  int below_tenth = 0, below_hundredth = 0, unpriced = 0;
  const ExpectedFunctions functions;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Projector projector = white_projector(
        model_of_families(), white_residual(model_of_families(), random) + functions.draw(random));
    for (const FamilyTest& test : test_families(model_of_families(), scanned, projector, 2)) {
      below_tenth += test.log10_p < -1.0 ? 1 : 0;
      below_hundredth += test.log10_p < -2.0 ? 1 : 0;
      unpriced += test.score.log10_p < -1.0 ? 1 : 0;
      EXPECT_GE(test.multiplicity, 1.0);
      EXPECT_LE(test.multiplicity, static_cast<double>(scanned[test.family].scan.size()));
    }
  }
  const double count = 3.0 * kDraws;
  RecordProperty("below_tenth", below_tenth);
  RecordProperty("unpriced", unpriced);
  EXPECT_LE(below_tenth, most_by_chance(count, 0.1));
  EXPECT_LE(below_hundredth, most_by_chance(count, 0.01));
  EXPECT_GE(below_tenth, 0.02 * count) << "the price is no more than five times too high";
  EXPECT_GT(unpriced, most_by_chance(count, 0.1)) << "the largest of a scan, not priced, is too often large";
}

/// 2 log-likelihood of k further amplitudes must exceed k ln n: components that bring nothing cost nothing.
TEST(Families, ADisplacementPaysForTheComponentsThatItNeeds) {
  const std::vector<Family> offsets = families_of(model_of_families(), "tool-expansion");
  ASSERT_EQ(offsets.size(), 1U);
  const Family& family = offsets[0];
  ASSERT_EQ(family.amplitudes(), 3);
  ASSERT_TRUE(family.independent_components());

  std::mt19937_64 random(11);
  const Eigen::VectorXd noise = white_residual(model_of_families(), random);
  const Eigen::MatrixXd columns = family_columns(model_of_families(), family, family.scan[0]);
  const Eigen::MatrixXd second = columns.col(1);
  const double u =
      1.0 / std::sqrt(white_projector(model_of_families(), noise).project(second).gram(0, 1)(0, 0));
  const Projector projector = white_projector(model_of_families(), noise + 12.0 * u * columns.col(1));
  const FamilyTest test = test_families(model_of_families(), offsets, projector, 1)[0];

  const double price = std::log(static_cast<double>(model_of_families().size()));
  const ScoreTest alone = score_test(projector.project(second), 0, 1);
  EXPECT_NEAR(alone.lm, test.score.lm_of({1}), 1e-6 * alone.lm);
  EXPECT_NEAR(alone.lm, 144.0, 60.0);
  EXPECT_NEAR(test.gain, alone.lm - price, 1e-6 * alone.lm);
  EXPECT_GT(test.gain, test.score.lm - 3.0 * price);
}

/// Products of two columns that nothing imitates.
ProjectedColumns apart(const Eigen::Vector2d& norm, const Eigen::Vector2d& score) {
  ProjectedColumns projected;
  projected.norm = norm;
  projected.score = score;
  projected.first = {0};
  projected.grams = {norm.cwiseAbs2().asDiagonal()};
  return projected;
}

/// A lead error of 4 um, and one whose sine is rounding at every position: it has no phase. One of 20 mm is
/// larger than a model file takes.
TEST(Families, AWaveIsSeenWithItsSineAndInASizeThatIsBelieved) {
  const Family family = families_of(model_of_families(), "lead-error").at(0);
  const Eigen::VectorXd largest = family.largest_amplitudes();
  ASSERT_EQ(largest.size(), 2);
  EXPECT_NEAR(largest[0], 1e-2, 1e-12);
  const ScoreTest seen = family_score(family, apart({1e7, 1e7}, {4e8, 0.0}), 0, largest);
  EXPECT_EQ(seen.dof, 2);
  EXPECT_NEAR(seen.amplitude[0], 4e-6, 1e-15);
  EXPECT_EQ(family_score(family, apart({1e7, 1e-6}, {4e8, 1e-6}), 0, largest).dof, 0);
  EXPECT_EQ(family_score(family, apart({1e7, 1e7}, {2e12, 0.0}), 0, largest).dof, 0);
}

/// A displacement may lack a component.
TEST(Families, ADisplacementIsSeenWithoutAComponentThatIsRounding) {
  const Family family = families_of(model_of_families(), "tool-expansion").at(0);
  ProjectedColumns projected;
  projected.norm = Eigen::Vector3d(1e6, 1e6, 1e-9);
  projected.score = Eigen::Vector3d(3e6, 0.0, 1e-9);
  projected.first = {0};
  projected.grams = {projected.norm.cwiseAbs2().asDiagonal()};
  const ScoreTest test = family_score(family, projected, 0, family.largest_amplitudes());
  EXPECT_EQ(test.dof, 2);
  EXPECT_NEAR(test.amplitude[0], 3e-6, 1e-15);
  EXPECT_EQ(test.amplitude[2], 0.0);
}

TEST(Families, OneAmplitudeAndOneSineAreNoComponents) {
  EXPECT_FALSE(families_of(model_of_families(), "reversal").at(0).independent_components());
  EXPECT_FALSE(families_of(model_of_families(), "lead-error").at(0).independent_components());
  EXPECT_FALSE(families_of(model_of_families(), "resolution").at(0).independent_components());
}

}  // namespace
}  // namespace volcal
