// Shapes between the values of a scan. The readings move exactly as an effect of a known shape, which no
// grid value has.

#include "volcal/identify/criticism/catalogue/shape_refinement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/hidden_studies.h"

namespace volcal {
namespace {

using testing_support::families_of;

const LinearModel& model() {
  static const testing_support::FittedStudy fitted(testing_support::hiding({}));
  return fitted.model;
}

Eigen::VectorXd shape(double value) { return Eigen::VectorXd::Constant(1, value); }

/// Residuals that are the effect alone.
Projector moved_by(const Family& family, double value, const Eigen::VectorXd& amplitude) {
  return testing_support::white_projector(model(), family_columns(model(), family, shape(value)) * amplitude);
}

/// Value between two neighbours of the scan, `share` of the way.
double between(const Family& family, double share) {
  const auto& scan = family.scan;
  const std::size_t at = scan.size() / 2;
  return scan[at][0] + share * (scan[at + 1][0] - scan[at][0]);
}

TEST(ShapeRefinement, FindsThePeriodBetweenTheValuesOfTheScan) {
  const std::vector<Family> lead = families_of(model(), "lead-error", "EXX");
  ASSERT_EQ(lead.size(), 1U);
  const double truth = between(lead[0], 0.37);
  const Projector projector = moved_by(lead[0], truth, Eigen::Vector2d(2e-6, 1e-6));
  FamilyTest test = test_families(model(), lead, projector, 1)[0];
  const double on_grid = test.score.lm, missed = std::abs(test.shape[0] - truth);
  refine_shape(model(), lead[0], projector, test);
  EXPECT_GT(test.score.lm, on_grid);
  EXPECT_LT(std::abs(test.shape[0] - truth), 0.02 * missed);
  EXPECT_NEAR(test.score.amplitude[0], 2e-6, 0.02e-6);
  EXPECT_NEAR(test.score.amplitude[1], 1e-6, 0.02e-6);
}

TEST(ShapeRefinement, FindsTheTimeConstant) {
  const std::vector<Family> growth = families_of(model(), "spindle-growth", "tool");
  ASSERT_EQ(growth.size(), 1U);
  const double truth = between(growth[0], 0.5);
  const Projector projector = moved_by(growth[0], truth, Eigen::Vector3d(0.0, 0.0, 9e-6));
  FamilyTest test = test_families(model(), growth, projector, 1)[0];
  refine_shape(model(), growth[0], projector, test);
  EXPECT_NEAR(test.shape[0], truth, 0.01 * truth);
}

/// Searched together, shapes are where each is found alone; known ones stay.
TEST(ShapeRefinement, SeveralShapesAreThoseOfEachAlone) {
  std::vector<Family> all;
  for (const char* kind : {"lead-error", "growing-lead-error", "station-event", "reversal"}) {
    for (Family& family : families_of(model(), kind)) all.push_back(std::move(family));
  }
  const std::vector<Family> lead = families_of(model(), "lead-error", "EXX");
  Projector projector = moved_by(lead[0], between(lead[0], 0.37), Eigen::Vector2d(2e-6, 1e-6));
  const std::vector<FamilyTest> before = test_families(model(), all, projector, 1);
  std::vector<FamilyTest> alone = before, together = before;
  std::vector<FamilyTest*> of_all;
  for (FamilyTest& test : together) of_all.push_back(&test);
  refine_shapes(model(), all, projector, 2, of_all);
  std::size_t moved = 0, columns = 0;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    refine_shape(model(), all[i], projector, alone[i]);
    columns += 3 * static_cast<std::size_t>(all[i].amplitudes());
    EXPECT_EQ(together[i].shape, alone[i].shape) << all[i].label();
    EXPECT_NEAR(together[i].score.lm, alone[i].score.lm, 1e-11 * (1.0 + alone[i].score.lm)) << all[i].label();
    moved += together[i].shape != before[i].shape ? 1 : 0;
  }
  EXPECT_GT(moved, 5U);
  EXPECT_GT(columns, static_cast<std::size_t>(kColumnBlock)) << "more than are projected together";
}

TEST(ShapeRefinement, LeavesAKnownShape) {
  const std::vector<Family> reversal = families_of(model(), "reversal", "EXX");
  ASSERT_EQ(reversal.size(), 1U);
  const Projector projector = moved_by(reversal[0], 0.0, Eigen::VectorXd::Constant(1, 1e-6));
  FamilyTest test = test_families(model(), reversal, projector, 1)[0];
  const double lm = test.score.lm;
  refine_shape(model(), reversal[0], projector, test);
  EXPECT_EQ(test.score.lm, lm);
  EXPECT_FALSE(shape_derivative(model(), reversal[0], test.shape, test.score.amplitude).has_value());
}

/// sin(2 pi x / p): the derivative to p is -2 pi x / p^2 cos(2 pi x / p), on the readings that feel EXX.
TEST(ShapeRefinement, DerivativeIsThatOfTheSine) {
  const Family lead = std::move(families_of(model(), "lead-error", "EXX").at(0));
  const double period = between(lead, 0.4);
  const Eigen::MatrixXd columns = family_columns(model(), lead, shape(period));
  const auto derivative = shape_derivative(model(), lead, shape(period), Eigen::Vector2d(1e-6, 0.0));
  ASSERT_TRUE(derivative.has_value());
  const double step = 1e-5 * period;
  const Eigen::VectorXd difference = 1e-6 *
                                     (family_columns(model(), lead, shape(period + step)).col(0) -
                                      family_columns(model(), lead, shape(period - step)).col(0)) /
                                     (2.0 * step);
  EXPECT_LT((*derivative - difference).norm(), 0.05 * difference.norm());
  EXPECT_GT(columns.col(0).norm(), 0.0);
}

TEST(ShapeRefinement, KnowsTheEndsOfAScan) {
  const Family heating = std::move(families_of(model(), "screw-heating", "EXX").at(0));
  const auto& scan = heating.scan;
  EXPECT_EQ(end_of_scan(heating, scan.front()[0]), ScanEnd::Lowest);
  EXPECT_EQ(end_of_scan(heating, scan.back()[0]), ScanEnd::Highest);
  EXPECT_EQ(end_of_scan(heating, scan.back()[0] - 0.01 * (scan.back() - scan[scan.size() - 2])[0]),
            ScanEnd::Highest);
  EXPECT_EQ(end_of_scan(heating, scan[1][0]), std::nullopt);
  EXPECT_EQ(end_of_scan(heating, between(heating, 0.5)), std::nullopt);
  const Family reversal = std::move(families_of(model(), "reversal", "EXX").at(0));
  EXPECT_EQ(end_of_scan(reversal, 0.0), std::nullopt);
}

/// A step in time goes from reading to reading.
TEST(ShapeRefinement, AStepHasNoDerivative) {
  const std::vector<Family> event = families_of(model(), "station-event", "station P1");
  ASSERT_EQ(event.size(), 1U);
  const Eigen::VectorXd shape = event[0].scan[event[0].scan.size() / 2];
  EXPECT_FALSE(shape_derivative(model(), event[0], shape, Eigen::Vector3d(1e-6, 0.0, 0.0)).has_value());
}

}  // namespace
}  // namespace volcal
