// Rotary axes are identified whenever they move: readings of an R-test on machines with known errors, made by
// exact transforms, against what the fit predicts at other poses.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/support/five_axis.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using testing_support::error_after_datums;
using testing_support::five_axis_machine;
using testing_support::five_axis_truth;
using testing_support::FiveAxisErrors;
using testing_support::GridPlan;
using testing_support::r_test_campaign;

/// Rotary errors and locations alone: linear axes hold what they are.
ModelSpec rotary_model() {
  ModelSpec model;
  for (const AxisName axis : kLinearAxes) {
    for (const Component component : kAllComponents) model.functions[{component, axis}].basis = "zero";
  }
  return model;
}

double predicted_error(const FitResult& result, const sim::TruthMachine& truth) {
  std::vector<ErrorField> fields;
  for (const Tool& tool : truth.machine().tools) fields.emplace_back(result, tool);
  return error_after_datums(
      truth,
      [&](const AxisPosition& position, std::size_t tool) -> Eigen::Vector3d {
        return fields[tool].at(position).head<3>();
      },
      91);
}

double uncorrected_error(const sim::TruthMachine& truth) {
  return error_after_datums(
      truth, [](const AxisPosition&, std::size_t) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); }, 91);
}

class RotaryAxes : public ::testing::TestWithParam<const char*> {};

/// um RMS at poses that no reading stands at; printed with what no correction leaves.
double left_by_a_fit(const char* structure, const FiveAxisErrors& errors) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine(structure), errors, 5);
  const FitResult result = fit(r_test_campaign(truth, GridPlan{}, 17), rotary_model(), {});
  const double left = predicted_error(result, truth) * 1e6;
  std::printf("%s: %.2f -> %.2f um RMS, sigma0 %.3f\n", structure, uncorrected_error(truth) * 1e6, left,
              result.sigma0);
  return left;
}

/// Noise of 1.5 um a component on 972 poses.
TEST_P(RotaryAxes, AreIdentifiedByDefault) { EXPECT_LT(left_by_a_fit(GetParam(), {}), 0.6); }

/// Errors of linear axes that the model does not know: their share at other places of the travel remains.
TEST_P(RotaryAxes, AreIdentifiedBesideErrorsOfLinearAxes) {
  FiveAxisErrors errors;
  errors.linear_displacement = 1e-6;
  errors.linear_rotation = 2e-6;
  EXPECT_LT(left_by_a_fit(GetParam(), errors), 3.0);
}

INSTANTIATE_TEST_SUITE_P(Structures, RotaryAxes,
                         ::testing::Values("w C' A' b X Y Z t", "w X' b Y Z C B t", "w C' X' b Y Z B t",
                                           "w C' B' b X Y Z t"));

TEST(RotaryErrors, OfAModelThatHasNoneAreMissedAloud) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  GridPlan plan;
  plan.turns = plan.tilts = 3;
  const Campaign campaign = r_test_campaign(truth, plan, 17);
  const std::vector<Finding> missing = missing_rotary_errors(campaign, ModelSpec{});
  ASSERT_EQ(missing.size(), 2U);
  EXPECT_EQ(missing[0].code, FindingCode::RotaryErrorsNotInModel);
  EXPECT_EQ(missing[0].text("axis"), "C");
  EXPECT_EQ(missing[1].text("axis"), "A");
  ModelSpec located;
  located.locations[{Component::X, AxisName::C}] = 12e-6;
  EXPECT_EQ(missing_rotary_errors(campaign, located).size(), 1U);
}

/// Tens of micrometres of errors that the model does not have, readings of 1.5 um: what they may be, a
/// millimetre and a milliradian, is in the uncertainty of what is predicted.
TEST(RotaryErrors, OfAModelThatHasNoneAreInTheUncertaintyOfAValidation) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  GridPlan plan;
  plan.turns = 6;
  plan.tilts = 5;
  const Campaign campaign = r_test_campaign(truth, plan, 17);
  ModelSpec none;
  none.default_function.basis = "zero";
  const FitResult result = fit(campaign, none, {});
  const Validation validation = validate(campaign, result);
  EXPECT_LT(validation.figures.reduced_chi2, 1.0);
  EXPECT_EQ(validation.figures.coverage95, 1.0);
  for (const double u : validation.after.model_u) {
    EXPECT_GT(u, 0.1e-3);
    EXPECT_LT(u, 5e-3);
  }
}

/// A tilt that is stated for one of two axes leaves the other's errors open.
TEST(RotaryErrors, OfOneAxisLeaveThoseOfTheOtherOpen) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  GridPlan plan;
  plan.turns = 6;
  plan.tilts = 5;
  const Campaign campaign = r_test_campaign(truth, plan, 17);
  const FitResult all = fit(campaign, rotary_model(), {});
  const Validation known = validate(campaign, all);
  EXPECT_LT(*std::ranges::max_element(known.after.model_u), 50e-6);
  ModelSpec of_c;
  of_c.default_function.basis = "zero";
  of_c.locations[{Component::A, AxisName::C}] = 0.0;
  const Validation open = validate(campaign, fit(campaign, of_c, {}));
  std::vector<double> u = open.after.model_u;
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_GT(u[i], known.after.model_u[i]) << i;
  std::ranges::nth_element(u, u.begin() + static_cast<std::ptrdiff_t>(u.size() / 2));
  EXPECT_GT(u[u.size() / 2], 0.1e-3);  // where the other axis stands at home its errors are small
}

/// What turns with the table, Rot(-q) eta of EXC and EYC, is a shift of the workpiece and stays in no error
/// motion; what turns the other way is an error motion.
TEST(RotaryGauge, LeavesWhatTurnsWithTheTableToTheWorkpiece) {
  constexpr double kSize = 10e-6;
  for (const double sense : {-1.0, 1.0}) {
    sim::TruthMachine truth(five_axis_machine("w C' A' b X Y Z t"));
    truth.set_error({Component::X, AxisName::C}, [](double q) { return kSize * std::cos(q); });
    truth.set_error({Component::Y, AxisName::C}, [=](double q) { return sense * kSize * std::sin(q); });
    const FitResult result = fit(r_test_campaign(truth, GridPlan{}, 17), rotary_model(), {});
    const ErrorSymbol radial{Component::X, AxisName::C};
    const auto group = static_cast<std::size_t>(result.layout.find(radial)->group);
    const Eigen::VectorXd coefficients = result.layout.coefficients(radial, result.parameters);
    const double at_zero = result.layout.groups[group].basis->value(0.0, coefficients);
    EXPECT_NEAR(at_zero, sense < 0.0 ? 0.0 : kSize, 0.3e-6);
  }
}

/// Constants are locations: a tilt EBA of 30 urad at every position is EB0A, with the sign of its side.
TEST(RotaryLocations, TakeTheConstantPartOfErrorMotions) {
  for (const char* structure : {"w C' A' b X Y Z t", "w X' b Y Z C B t"}) {
    sim::TruthMachine truth(five_axis_machine(structure));
    const bool table = std::string(structure).starts_with("w C'");
    const ErrorSymbol across =
        table ? ErrorSymbol{Component::B, AxisName::A} : ErrorSymbol{Component::A, AxisName::B};
    truth.set_error(across, [](double) { return 30e-6; });
    const FitResult result = fit(r_test_campaign(truth, GridPlan{}, 17), rotary_model(), {});
    const auto block = result.layout.find_location(LocationSymbol{across.component, across.axis});
    ASSERT_TRUE(block);
    EXPECT_NEAR(result.parameters[block->offset], table ? -30e-6 : 30e-6, 3e-6) << structure;
  }
}

}  // namespace
}  // namespace volcal
