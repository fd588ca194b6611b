// Scores that follow from products kept, against projections made anew off the model with the accepted
// columns.

#include "volcal/identify/criticism/catalogue/family_products.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/hidden_studies.h"

namespace volcal {
namespace {

using testing_support::families_of;
using testing_support::white_projector;
using testing_support::white_residual;

/// Of |g_w|^2, |g_w| |r_w|: what the header states, over a chain of acceptances.
constexpr double kRounding = 1e-10;

class FamilyProductsTest : public ::testing::Test {
 protected:
  static const LinearModel& model() {
    static const testing_support::FittedStudy fitted(testing_support::hiding({}, {4, 3, 3}));
    return fitted.model;
  }
  static const std::vector<Family>& catalogue() {
    static const std::vector<Family> all = families(model());
    return all;
  }
  static Projector projector() {
    std::mt19937_64 random(5);
    return white_projector(model(), white_residual(model(), random));
  }
  static Eigen::MatrixXd columns_of_kind(const std::string& kind) {
    const Family family = families_of(model(), kind).at(0);
    return family_columns(model(), family, family.scan[family.scan.size() / 2]);
  }
  /// LM is a ratio of both; amplitudes and their covariance carry 1 over the visible share squared.
  static void expect_alike(const std::vector<FamilyTest>& kept, const std::vector<FamilyTest>& anew) {
    ASSERT_EQ(kept.size(), anew.size());
    ASSERT_GT(kept.size(), 100U);
    std::size_t invisible = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const std::string label = catalogue()[i].label();
      const ScoreTest &own = kept[i].score, &other = anew[i].score;
      EXPECT_EQ(kept[i].family, i);
      ASSERT_EQ(own.dof, other.dof) << label;
      invisible += own.dof == 0 ? 1 : 0;
      if (own.dof == 0) continue;
      const double share = other.visible_fraction * other.visible_fraction;
      const double alike = kRounding / share;
      EXPECT_EQ(kept[i].shape, anew[i].shape) << label;
      EXPECT_NEAR(own.lm, other.lm, alike * (1.0 + other.lm)) << label;
      EXPECT_NEAR(kept[i].gain, anew[i].gain, alike * (1.0 + other.lm)) << label;
      EXPECT_NEAR(own.visible_fraction, other.visible_fraction, alike) << label;
      // Of several amplitudes some may be seen by nothing but rounding: against the largest of the family.
      const double u = std::sqrt(other.covariance.diagonal().maxCoeff());
      const double largest = u + other.amplitude.cwiseAbs().maxCoeff();
      EXPECT_LT((own.amplitude - other.amplitude).cwiseAbs().maxCoeff(), alike * largest) << label;
      EXPECT_LT((own.covariance - other.covariance).cwiseAbs().maxCoeff(), alike * u * u) << label;
    }
    EXPECT_GT(invisible, 0U) << "what was accepted is itself no longer visible";
  }
};

TEST_F(FamilyProductsTest, AreThoseOfTheModelWithWhatWasAccepted) {
  Projector now = projector();
  FamilyProducts kept(model(), catalogue(), now, 2);
  for (const char* kind : {"reversal", "lead-error", "tool-expansion"}) {
    const Eigen::MatrixXd columns = columns_of_kind(kind);
    kept = kept.accepting(columns, model(), catalogue(), now, 2);
    now.accept(columns);
    const FamilyProducts anew(model(), catalogue(), now, 2);
    expect_alike(kept.tests(catalogue(), now, 2), anew.tests(catalogue(), now, 2));
  }
}

TEST_F(FamilyProductsTest, AreTheSameToTheBitForAnyNumberOfThreads) {
  const Projector off = projector();
  const Eigen::MatrixXd columns = columns_of_kind("lead-error");
  const auto tests = [&](int threads) {
    return FamilyProducts(model(), catalogue(), off, threads)
        .accepting(columns, model(), catalogue(), off, threads)
        .tests(catalogue(), off, threads);
  };
  const std::vector<FamilyTest> one = tests(1), three = tests(3);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].score.lm, three[i].score.lm);
}

/// A column whose components are not all seen: what nothing is left of takes nothing.
TEST_F(FamilyProductsTest, TakeNoDirectionOfWhichNothingIsLeft) {
  Projector now = projector();
  const Eigen::MatrixXd columns = columns_of_kind("reversal");
  Eigen::MatrixXd twice(columns.rows(), 2);
  twice << columns, 3.0 * columns;
  const FamilyProducts before(model(), catalogue(), now, 2);
  const std::vector<FamilyTest> once =
      before.accepting(columns, model(), catalogue(), now, 2).tests(catalogue(), now, 2);
  const std::vector<FamilyTest> both =
      before.accepting(twice, model(), catalogue(), now, 2).tests(catalogue(), now, 2);
  for (std::size_t i = 0; i < once.size(); ++i)
    EXPECT_NEAR(once[i].score.lm, both[i].score.lm, 1e-6 * (1.0 + once[i].score.lm));
}

}  // namespace
}  // namespace volcal
