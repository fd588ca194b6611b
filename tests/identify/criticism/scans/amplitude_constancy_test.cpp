// Does an amplitude vary? Chance is drawn; variation is put into the readings along the effect's own columns.

#include "volcal/identify/criticism/scans/amplitude_constancy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/hidden_studies.h"

namespace volcal {
namespace {

using testing_support::families_of;
using testing_support::model_of_nothing_hidden;
using testing_support::value_of_variable;
using testing_support::variables_of_nothing_hidden;
using testing_support::white_projector;
using testing_support::white_residual;

class Constancy : public ::testing::Test {
 protected:
  Constancy() : families_(families_of(model_of_nothing_hidden(), "reversal", "EXX")) {}

  /// Of a reversal of 2 um in the model, the residuals being `rest`.
  ConstancyTest test(const Eigen::VectorXd& rest) const {
    Projector projector = white_projector(model_of_nothing_hidden(), rest);
    projector.accept(moved());
    return least_constant(families_.at(0), 2e-6 * moved(), variables_of_nothing_hidden(), projector);
  }

  Eigen::VectorXd moved() const {
    return family_columns(model_of_nothing_hidden(), families_.at(0), Eigen::VectorXd());
  }

  std::vector<Family> families_;
};

TEST_F(Constancy, KeepsItsProbability) {
  std::mt19937_64 random(5);
  constexpr int kDraws = 60;
  int below_fifth = 0;
  for (int draw = 0; draw < kDraws; ++draw)
    below_fifth += test(white_residual(model_of_nothing_hidden(), random)).log10_p < std::log10(0.2) ? 1 : 0;
  RecordProperty("below_fifth", below_fifth);
  EXPECT_LE(below_fifth, 0.2 * kDraws + 3.1 * std::sqrt(0.2 * 0.8 * kDraws));
  EXPECT_GE(below_fifth, 3);
}

TEST_F(Constancy, OfTheSameAmplitudeEverywhere) {
  std::mt19937_64 random(6);
  EXPECT_GT(test(white_residual(model_of_nothing_hidden(), random) + 3e-6 * moved()).log10_p, -1.5);
}

/// Backlash that begins in the middle of the travel is no reversal of one size.
TEST_F(Constancy, SeesAKinkAlongTheTravel) {
  std::mt19937_64 random(6);
  const Eigen::VectorXd kink = moved().cwiseProduct(value_of_variable("x").cwiseMax(0.0));
  const ConstancyTest varies = test(white_residual(model_of_nothing_hidden(), random) + 3e-6 * kink);
  EXPECT_EQ(varies.variable, "x");
  EXPECT_LT(varies.log10_p, -6.0);
}

TEST_F(Constancy, SeesWhatElseAnAmplitudeDependsOn) {
  std::mt19937_64 random(6);
  const ConstancyTest varies = test(white_residual(model_of_nothing_hidden(), random) +
                                    1.5e-6 * moved().cwiseProduct(value_of_variable("T_column")));
  EXPECT_EQ(varies.variable, "T_column");
  EXPECT_LT(varies.log10_p, -4.0);
}

/// A machine does the same whoever reads it: what plainly differs from station to station is no variation of
/// its amplitude.
TEST_F(Constancy, OfTheMachineVariesWithNoStation) {
  std::mt19937_64 random(6);
  const Eigen::VectorXd here = moved().cwiseProduct(value_of_variable("station P1"));
  const Eigen::VectorXd rest = white_residual(model_of_nothing_hidden(), random) + 1.5e-6 * here;
  Projector projector = white_projector(model_of_nothing_hidden(), rest);
  projector.accept(moved());
  EXPECT_LT(score_test(projector.project(here), 0, 1).log10_p, -4.0);
  EXPECT_FALSE(test(rest).variable.starts_with("station "));
}

/// A reversal that is taken up in the first readings after the axis has turned round.
TEST_F(Constancy, SeesAReversalThatIsTakenUpOnTheWay) {
  std::mt19937_64 random(6);
  const std::vector<ScanVariable> turning = travel_since_turning(model_of_nothing_hidden());
  const auto x = std::ranges::find(turning, "travel since dir_x", &ScanVariable::name);
  ASSERT_NE(x, turning.end());
  const Eigen::VectorXd travelled_m = (x->centre + x->scale * x->value.array()).matrix();
  EXPECT_NEAR(travelled_m.minCoeff(), 0.0, 1e-12);
  const Axis& axis = model_of_nothing_hidden().campaign().machine.axis(AxisName::X);
  EXPECT_GT(travelled_m.maxCoeff(), 0.5 * axis.travel());
  EXPECT_LT(travelled_m.maxCoeff(), 1.01 * axis.travel());

  const Eigen::VectorXd late = moved().cwiseProduct((-travelled_m.array() / 0.1).exp().matrix());
  Projector projector = white_projector(model_of_nothing_hidden(),
                                        white_residual(model_of_nothing_hidden(), random) - 6e-6 * late);
  projector.accept(moved());
  std::vector<ScanVariable> variables = variables_of_nothing_hidden();
  variables.insert(variables.end(), turning.begin(), turning.end());
  const ConstancyTest varies = least_constant(families_.at(0), 2e-6 * moved(), variables, projector);
  EXPECT_EQ(varies.variable, "travel since dir_x");
  EXPECT_LT(varies.log10_p, -4.0);
}

}  // namespace
}  // namespace volcal
