// What to add so that an error of a rotary axis becomes visible.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/support/five_axis.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/rank_causes.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing_support::five_axis_machine;
using testing_support::five_axis_truth;
using testing_support::GridPlan;
using testing_support::r_test_campaign;

/// Errors of the rotary axes alone, in so many harmonics where an axis turns fully.
ModelSpec rotary_model_of(int harmonics) {
  ModelSpec model;
  for (const AxisName axis : kLinearAxes) {
    for (const Component component : kAllComponents) model.functions[{component, axis}].basis = "zero";
  }
  for (const Component component : kAllComponents) {
    FunctionSpec function;
    function.basis = "fourier";
    function.degree = harmonics;
    model.functions[{component, AxisName::C}] = function;
  }
  return model;
}

std::optional<Finding> cause_of(const FitResult& result, const std::string& error) {
  const auto found =
      std::ranges::find(result.rank.errors, MachineError::parse(error), &Observability::symbol);
  return found == result.rank.errors.end() ? std::nullopt : found->cause;
}

/// C at 12 positions, 30 degrees apart: a wave of 8 periods takes the values of one of 4 there.
TEST(RotaryRank, SaysWhichHarmonicsRegularPositionsHide) {
  GridPlan plan;
  plan.turns = 12;
  plan.tilts = 5;
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  const FitResult result = fit(r_test_campaign(truth, plan, 17), rotary_model_of(8), {});
  const auto cause = cause_of(result, "EXC");
  ASSERT_TRUE(cause);
  ASSERT_EQ(cause->code, FindingCode::NotVisibleFewPositions) << sentence(*cause);
  EXPECT_EQ(cause->count("positions"), 12);
  EXPECT_EQ(cause->count("told"), 5);
  EXPECT_EQ(cause->count("harmonics"), 8);
  EXPECT_NEAR(cause->number("spacing").in_unit(), 30.0, 1e-9);
  const FitResult of_five = fit(r_test_campaign(truth, plan, 17), rotary_model_of(5), {});
  EXPECT_FALSE(cause_of(of_five, "EXC"));
  const auto note = std::ranges::find(of_five.findings, FindingCode::RotaryHarmonicsHidden, &Finding::code);
  ASSERT_NE(note, of_five.findings.end());
  EXPECT_EQ(note->text("axis"), "C");
  EXPECT_EQ(note->count("told"), 5);
}

/// A head that one tool on the spindle's axis reads, and beside it the other tools with both axes at rest.
TEST(RotaryRank, AsksForToolsThatTheAxisMoves) {
  GridPlan plan;
  plan.turns = 6;
  plan.tilts = 5;
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w X' b Y Z C B t"), {}, 5);
  Campaign campaign = r_test_campaign(truth, plan, 17);
  for (volcal::Setup& setup : campaign.setups) {
    if (setup.tool == 0) continue;
    for (const AxisName axis : kAllAxes) {
      auto& position = setup.readings.position[index_of(axis)];
      if (!position.empty()) std::ranges::fill(position, position.front());
    }
    for (auto& channel : setup.readings.value) std::ranges::fill(channel, channel.front());
  }
  const auto cause = cause_of(fit(campaign, rotary_model_of(2), {}), "ECB");
  ASSERT_TRUE(cause);
  ASSERT_EQ(cause->code, FindingCode::NotVisibleExchangeable) << sentence(*cause);
  EXPECT_THAT(cause->texts("remedies"), Contains("mandrel"));
  EXPECT_THAT(cause->texts("remedies"), Contains("second-tool"));
  EXPECT_EQ(cause->text("turning"), "B");
  EXPECT_THAT(sentence(*cause), HasSubstr("turn B with a mandrel"));
  EXPECT_THAT(sentence(*cause), Not(HasSubstr("too few positions")));
}

/// R-tests alone: where a location error of the table is one with errors of the linear axes that follow, no
/// tool and no place on the table tells them apart, but readings of the linear axes. With errors of the other
/// rotary axis it is another matter.
TEST(RotaryRank, AsksForTheLinearAxesWhereTheyFollowUnmeasured) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  const Campaign campaign = r_test_campaign(truth, GridPlan{}, 17);
  const MeasurementModel model(campaign, resolve_knots(rotary_model_of(2), campaign));
  const Finding beside = cause_exchangeable(
      model, MachineError::parse("EX0C"),
      {MachineError::parse("EZX"), MachineError::parse("EB0Z"), MachineError::parse("EB0A")});
  EXPECT_THAT(beside.texts("remedies"), Contains("linear-axes"));
  EXPECT_THAT(sentence(beside), HasSubstr("measure the linear axes, too, with the rotary axes at 0"));
  EXPECT_THAT(
      cause_exchangeable(model, MachineError::parse("EX0C"), {MachineError::parse("EB0A")}).texts("remedies"),
      Not(Contains("linear-axes")));
}

/// A model file of other errors alone, one that names motions of C, and one that leaves nothing out.
TEST(RotaryRank, SaysWhatTheModelFileLeavesOut) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  const Campaign campaign = r_test_campaign(truth, GridPlan{}, 17);
  const auto left_out = [&](const ModelSpec& model) {
    std::map<std::string, std::vector<std::string>> axes;
    for (const Finding& finding : fit(campaign, model, {}).findings) {
      if (finding.code != FindingCode::RotaryErrorsNotInModel) continue;
      EXPECT_TRUE(finding.flag("by_model"));
      axes[finding.text("axis")] = finding.texts("locations");
    }
    return axes;
  };
  ModelSpec model = rotary_model_of(2);
  EXPECT_TRUE(left_out(model).empty());
  model.default_function.basis = "zero";
  const auto of_motions = left_out(model);
  EXPECT_THAT(of_motions.at("C"), Contains("EX0C"));
  EXPECT_TRUE(of_motions.at("A").empty()) << "all of its errors";
}

/// A cradle that travels a radian farther than it was measured.
TEST(RotaryRank, AsksForTheTravelThatWasNotMeasured) {
  const sim::TruthMachine truth = five_axis_truth(five_axis_machine("w C' A' b X Y Z t"), {}, 5);
  Campaign campaign = r_test_campaign(truth, GridPlan{}, 17);
  const auto remedies = [&] {
    const MeasurementModel model(campaign, resolve_knots(rotary_model_of(2), campaign));
    return cause_exchangeable(model, MachineError::parse("EBA"), {MachineError::parse("EB0A")})
        .texts("remedies");
  };
  Axis& cradle = *std::ranges::find(campaign.machine.axes, AxisName::A, &Axis::name);
  const MeasuredRange measured = measured_range(campaign, AxisName::A);
  cradle.travel_min = measured.min;
  cradle.travel_max = measured.max;
  EXPECT_THAT(remedies(), Not(Contains("measured-travel")));
  cradle.travel_max += 1.0;
  EXPECT_THAT(remedies(), Contains("measured-travel"));
}

}  // namespace
}  // namespace volcal
