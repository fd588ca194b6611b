// Errors stated under conditions that no reading had: a curve by temperature of which every number is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

constexpr double kHeight = 7e-6, kU = 1e-6;  // m

/// EXX = 7 um from 18 to 26 degC in two pieces of 4 K, every coefficient with a standard uncertainty of 1 um
/// of its own: u is 1 um at the ends, where one spline alone is not zero.
class BeyondConditions : public ::testing::Test {
 protected:
  BeyondConditions() {
    ModelSpec model;
    model.default_function.basis = "zero";
    model.effects = {effect_spec("empirical", {{"target", std::string("EXX")},
                                               {"drivers", std::string("T_spindle")},
                                               {"from", std::vector<double>{18.0}},
                                               {"to", std::vector<double>{26.0}},
                                               {"pieces", std::vector<double>{2.0}},
                                               {"coefficients", std::vector<double>(5, kHeight)}})};
    model.conditions.temperature_degC["spindle"] = {18.0, 21.0, 26.0};
    result_ = stated_result(testing_support::effect_campaign().machine, model);
    result_.covariance.diagonal().setConstant(kU * kU);
  }

  VolumetricError at(double temperature_degC) const {
    const Tool& tool = result_.machine.tools.front();
    const ErrorField field(result_, tool, conditions(temperature_degC));
    return volumetric_error(result_, field, AxisPosition{}, tool);
  }

  static Conditions conditions(double temperature_degC) {
    Conditions conditions;
    conditions.temperature_degC["spindle"] = temperature_degC;
    return conditions;
  }

  FitResult result_;
};

TEST_F(BeyondConditions, ACurveHoldsWithinItsReadings) {
  EXPECT_NEAR(at(21.0).value[0], kHeight, 1e-15);
  EXPECT_FALSE(at(21.0).extrapolated);
  EXPECT_NEAR(at(26.0).u[0], kU, 1e-15);
  EXPECT_FALSE(at(26.0).extrapolated);
}

TEST_F(BeyondConditions, WhatHasFadedOutIsUncertain) {
  const VolumetricError half = at(28.0), none = at(40.0);
  EXPECT_TRUE(half.extrapolated);
  EXPECT_NEAR(half.value[0], 3.5e-6, 1e-15);  // half a piece beyond
  EXPECT_NEAR(half.u[0], std::sqrt(1.0 + 3.5 * 3.5) * 1e-6, 1e-15);
  EXPECT_TRUE(none.extrapolated);
  EXPECT_EQ(none.value[0], 0.0);
  EXPECT_NEAR(none.u[0], std::sqrt(1.0 + 7.0 * 7.0) * 1e-6, 1e-15);
}

TEST_F(BeyondConditions, WhatEndsAtZeroIsAsUncertainAsItIsLarge) {
  for (const char* last : {"curve EXX by T_spindle 4", "curve EXX by T_spindle 5"})
    result_.parameters[*result_.layout.find_parameter(last)] = 0.0;
  const double rms = [&] {
    const TensorBasis basis({{18.0, 26.0, 2}});
    double squares = 0.0;
    constexpr int kPlaces = 4001;
    for (int i = 0; i < kPlaces; ++i) {
      const double place = 18.0 + 8.0 * i / (kPlaces - 1.0);
      squares += std::pow(kHeight * basis.row({&place, 1}).head(3).sum(), 2);
    }
    return std::sqrt(squares / kPlaces);
  }();
  EXPECT_NEAR(at(40.0).u[0], std::hypot(kU, rms), 0.05 * rms);  // nine samples for the integral
}

TEST_F(BeyondConditions, GridsAndTablesSayTheSame) {
  for (const VolumetricError& node : volumetric_grid(result_, 3, conditions(40.0))) {
    EXPECT_TRUE(node.extrapolated);
    EXPECT_NEAR(node.u[0], std::sqrt(50.0) * 1e-6, 1e-15);
  }
  ErrorTableOptions options;
  options.conditions = conditions(40.0);
  int rows = 0;
  for (const ErrorTableRow& row : error_table(result_, options)) {
    if (row.symbol != "EXX") continue;
    ++rows;
    EXPECT_TRUE(row.extrapolated);
    EXPECT_EQ(row.value, 0.0);
    EXPECT_NEAR(row.u, std::sqrt(50.0) * 1e-6, 1e-15);
  }
  EXPECT_GT(rows, 10);
}

TEST_F(BeyondConditions, TheErrorDependsOnTheTemperatureThatHidesIt) {
  const Variable spindle = temperature_of("spindle");
  EXPECT_THAT(conditions_that_act(result_, conditions(40.0)), ::testing::ElementsAre(spindle));
  const std::vector<Finding> beyond = conditions_beyond_readings(result_, conditions(40.0));
  ASSERT_EQ(beyond.size(), 1);
  EXPECT_EQ(beyond[0].code, FindingCode::ConditionBeyondReadings);
  EXPECT_EQ(beyond[0].text("condition"), "T_spindle");
  EXPECT_EQ(beyond[0].number("value").si, 40.0);
  EXPECT_EQ(beyond[0].number("measured_from").si, 18.0);
  EXPECT_EQ(beyond[0].number("measured_to").si, 26.0);
  EXPECT_THAT(conditions_beyond_readings(result_, conditions(20.0)), ::testing::IsEmpty());
}

TEST_F(BeyondConditions, StatedModelsHoldForTheMeanOfTheirReadings) {
  EXPECT_EQ(default_conditions(result_).temperature_degC.at("spindle"), 21.0);
}

}  // namespace
}  // namespace volcal
