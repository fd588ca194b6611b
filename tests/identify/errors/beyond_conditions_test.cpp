// Errors stated under conditions that no reading had: a curve by temperature of which every number is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/error_oracles.h"
#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/machine_effects.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/faded_in_volume.h"
#include "volcal/identify/errors/volume/volume_uncertainty.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

constexpr double kHeight = 7e-6, kU = 1e-6;  // m

/// A constant curve by temperature from 18 to 26 degC in two pieces of 4 K, every coefficient with a standard
/// uncertainty of its own: u is theirs at the ends, where one spline alone is not zero.
FitResult result_of_curve(const std::string& target, double height, double u) {
  ModelSpec model;
  model.default_function.basis = "zero";
  model.effects = {effect_spec("empirical", {{"target", target},
                                             {"drivers", std::string("T_spindle")},
                                             {"from", std::vector<double>{18.0}},
                                             {"to", std::vector<double>{26.0}},
                                             {"pieces", std::vector<double>{2.0}},
                                             {"coefficients", std::vector<double>(5, height)}})};
  model.conditions.temperature_degC["spindle"] = {18.0, 21.0, 26.0};
  FitResult result = stated_result(testing_support::effect_campaign().machine, model);
  if (u > 0.0) result.covariance = u * u * Eigen::MatrixXd::Identity(result.layout.size, result.layout.size);
  return result;
}

class BeyondConditions : public ::testing::Test {
 protected:
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

  FitResult result_ = result_of_curve("EXX", kHeight, kU);
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
  for (const VolumetricError& node : testing::volumetric_grid(result_, 3, conditions(40.0))) {
    EXPECT_TRUE(node.extrapolated);
    EXPECT_NEAR(node.u[0], std::sqrt(50.0) * 1e-6, 1e-15);
  }
  ErrorTableOptions options;
  options.conditions = conditions(40.0);
  int rows = 0;
  for (const ErrorTableRow& row : error_table(result_, options)) {
    if (row.symbol.name() != "EXX") continue;
    ++rows;
    EXPECT_TRUE(row.extrapolated);
    EXPECT_EQ(row.value, 0.0);
    EXPECT_NEAR(row.u, std::sqrt(50.0) * 1e-6, 1e-15);
  }
  EXPECT_GT(rows, 10);
}

/// A shift of the whole volume is taken up by the workpiece's frame, before its curve has faded out and
/// after.
TEST_F(BeyondConditions, AShiftLeavesNothingInTheVolume) {
  const ErrorBudget budget = error_budget(result_, result_.machine.tools.front(), conditions(40.0), 3);
  EXPECT_NEAR(budget.total.u_rms, 0.0, 1e-12);
}

double u_in_volume(const FitResult& result, double temperature_degC) {
  Conditions conditions;
  conditions.temperature_degC["spindle"] = temperature_degC;
  return error_budget(result, result.machine.tools.front(), conditions, 3).total.u_rms;
}

/// 7 urad of EBY, gone at 40 degC, turn what Y carries; what they may still be, beside the u of the last
/// coefficient, is sqrt(7^2 + 1) times what 1 urad leaves after a rigid motion.
TEST(FadedInVolume, IsAsACovarianceOfItsSize) {
  const FitResult faded = result_of_curve("EBY", 7e-6, 1e-6);
  const double inside = u_in_volume(faded, 26.0);  // the last spline alone: 1 urad
  ASSERT_GT(inside, 1e-8);
  EXPECT_NEAR(u_in_volume(faded, 40.0), std::sqrt(50.0) * inside, 1e-6 * inside);
  const FitResult stated = result_of_curve("EBY", 7e-6, 0.0);
  EXPECT_EQ(u_in_volume(stated, 26.0), 0.0);
  EXPECT_NEAR(u_in_volume(stated, 40.0), 7.0 * inside, 1e-6 * inside) << "of errors without uncertainty, too";
}

/// Nothing is left of the values, so the budget states what is exceeded with 5 %: of one normal variable 1.96
/// of its standard deviation.
TEST(FadedInVolume, IsExceededByFivePercentOfMachines) {
  Conditions hot;
  hot.temperature_degC["spindle"] = 40.0;
  const FitResult stated = result_of_curve("EBY", 7e-6, 0.0);
  const ErrorBudget budget = error_budget(stated, stated.machine.tools.front(), hot, 3);
  ASSERT_EQ(budget.total.rms, 0.0);
  EXPECT_NEAR(budget.rms_95, 1.959964 * budget.total.u_rms, 0.01 * budget.rms_95);
}

/// Tables that take away what was identified leave it as well.
TEST(FadedInVolume, IsLeftByTables) {
  const FitResult stated = result_of_curve("EBY", 7e-6, 0.0);
  std::vector<AxisPosition> positions;
  for (const double x : {0.0, 0.4}) {
    for (const double z : {0.0, 0.3}) positions.insert(positions.end(), {{x, 0.0, z}, {x, 0.5, z}});
  }
  const std::vector<ApproachDirection> directions(positions.size());
  Conditions warm, hot;
  warm.temperature_degC["spindle"] = 26.0;
  hot.temperature_degC["spindle"] = 40.0;
  const Tool& tool = stated.machine.tools.front();
  EXPECT_EQ(volume_uncertainty(stated, tool, warm, positions, directions), 0.0);
  const FitResult known = result_of_curve("EBY", 7e-6, 7e-6);
  const double of_seven = volume_uncertainty(known, tool, warm, positions, directions);
  ASSERT_GT(of_seven, 1e-8);
  EXPECT_NEAR(volume_uncertainty(stated, tool, hot, positions, directions), of_seven, 1e-6 * of_seven);
}

/// Of a surface that depends on a position the shift counts too: of 2 um at one of two points and 0 at the
/// other 2 um^2 are the mean square, of 2 um at both nothing is left.
TEST(FadedInVolume, CountsWhatChangesFromPointToPointAsItIs) {
  FadedError two{4, 2e-6}, none{4, 0.0};
  two.u[0] = 2e-6;
  FadedInVolume changes, same;
  changes.add({0.0, 0.0, 0.0}, {&two, 1});
  changes.add({1.0, 0.0, 0.0}, {&none, 1});
  EXPECT_NEAR(changes.mean_square(), 2e-12, 1e-20);
  const int other = 5, own = 4;
  EXPECT_EQ(changes.mean_square({&other, 1}), 0.0);
  EXPECT_NEAR(changes.mean_square({&own, 1}), 2e-12, 1e-20);
  same.add({0.0, 0.0, 0.0}, {&two, 1});
  same.add({1.0, 0.0, 0.0}, {&two, 1});
  EXPECT_NEAR(same.mean_square(), 0.0, 1e-20);
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

/// The reference temperature, at which the expansion is none, is the same whether it is assumed or stated.
TEST(ConditionsBeyondReadings, AreTheSameWhoeverNamesTheReferenceTemperature) {
  FitResult result = result_of_curve("EXX", 0.0, 0.0);
  result.machine.axes[0].expansion = ScaleExpansion{10e-6, 1e-6, "scale"};
  result.conditions.temperature_degC["scale"] = {23.0, 23.5, 24.2};
  const Conditions assumed = default_conditions(result);
  ASSERT_EQ(assumed.temperature_degC.at("scale"), 20.0);
  EXPECT_THAT(conditions_beyond_readings(result, assumed), ::testing::IsEmpty());
  Conditions stated = assumed;
  stated.stated = {temperature_of("scale")};
  EXPECT_THAT(conditions_beyond_readings(result, stated), ::testing::IsEmpty());
  stated.temperature_degC["scale"] = 30.0;
  EXPECT_EQ(conditions_beyond_readings(result, stated).size(), 1);
}

TEST_F(BeyondConditions, StatedModelsHoldForTheMeanOfTheirReadings) {
  EXPECT_EQ(default_conditions(result_).temperature_degC.at("spindle"), 21.0);
}

/// Products of temperatures, and steps in time, act where several conditions are far from the stated ones.
TEST(ActingConditions, AreThoseThatAnEffectIsWrittenOf) {
  for (const auto& [expression, acting] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"x * (T_air - 20) * (T_spindle - 20)", {"T_air", "T_spindle"}},
           {"x * (T_air - 20) * t", {"T_air", "time"}},
           {"x * max(T_air - 22, 0)", {"T_air"}},
           {"x * (t > 8000)", {"time"}},
           {"feed * (T_air - 20)", {"T_air", "feed"}},
       }) {
    ModelSpec model;
    model.default_function.basis = "zero";
    model.effects = {effect_spec(
        "custom", {{"target", std::string("EXX")}, {"expression", expression}, {"amplitude", 1e-9}})};
    const FitResult result = stated_result(testing_support::effect_campaign().machine, model);
    EXPECT_TRUE(effects_on_no_pose(result).empty()) << expression;
    std::set<std::string> names;
    for (const Variable& variable : conditions_that_act(result, default_conditions(result)))
      names.insert(variable.name());
    EXPECT_EQ(names, std::set<std::string>(acting.begin(), acting.end())) << expression;
  }
}

}  // namespace
}  // namespace volcal
