// What is drawn for an effect without a name, from campaigns of sim/ whose effects no catalogue holds.

#include "volcal/identify/criticism/surface_findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;
using testing_support::hiding;

Diagnosis diagnosed(const FittedStudy& study, std::vector<std::string> leave_out = {}) {
  DiagnoseOptions options;
  options.leave_out = std::move(leave_out);
  options.climb = true;
  options.compare = false;
  return diagnose(study.simulated.campaign, study.result, options);
}

sim::HiddenEffect bump() {
  sim::HiddenEffect effect{.kind = "local-bump", .options = {}, .rms = 1.5e-6};
  effect.options.set("symbol", std::string("EZX"));
  effect.options.set("centre", 0.30);
  effect.options.set("width", 0.10);
  effect.options.set("by", std::string("Y"));
  effect.options.set("by_centre", 0.25);
  effect.options.set("by_width", 0.09);
  return effect;
}

sim::HiddenEffect backlash_that_grows_with_temperature() {
  sim::HiddenEffect effect{.kind = "direction-temperature", .options = {}, .rms = 1.0e-6};
  effect.options.set("symbol", std::string("EXX"));
  effect.options.set("channel", std::string("column"));
  return effect;
}

const FittedStudy& study_of_bump() {
  static const FittedStudy study(hiding({bump()}, {7, 6, 3}));
  return study;
}

const Diagnosis& diagnosis_of_bump() {
  static const Diagnosis diagnosis = diagnosed(study_of_bump());
  return diagnosis;
}

TEST(SurfaceFindings, ABumpIsDrawnWhereItIs) {
  const Diagnosis& diagnosis = diagnosis_of_bump();
  EXPECT_EQ(to_string(diagnosis.verdict), "UNKNOWN");
  ASSERT_EQ(diagnosis.surfaces.size(), 1u);
  const SurfaceFinding& surface = diagnosis.surfaces.front();
  EXPECT_EQ(surface.name.kind, "empirical");
  EXPECT_EQ(written_names(surface.drivers), (std::vector<std::string>{"x", "y"}));
  ASSERT_EQ(surface.at.size(), 2u);
  EXPECT_NEAR(surface.at[0], 300.0, 100.0);
  EXPECT_NEAR(surface.at[1], 250.0, 90.0);
  EXPECT_GT(std::abs(surface.largest), 4.0 * surface.largest_u);
  EXPECT_GT(surface.effective_parameters, 3.0);
  EXPECT_LT(surface.effective_parameters, 60.0);
}

TEST(SurfaceFindings, TheErrorFallsToTheNoiseWithIt) {
  const Diagnosis& diagnosis = diagnosis_of_bump();
  ASSERT_EQ(diagnosis.ladder.size(), 2u);
  EXPECT_EQ(diagnosis.ladder[1].added, diagnosis.surfaces.front().label);
  EXPECT_GT(diagnosis.ladder[0].systematic_low, 0.0);
  EXPECT_LT(diagnosis.ladder[1].systematic, 0.4 * diagnosis.ladder[0].systematic);
  EXPECT_GT(diagnosis.ladder[1].heldout_loglik_gain, 10.0);
}

/// In the full model, with everything identified anew.
TEST(SurfaceFindings, AFitWithItExplainsTheReadings) {
  const Campaign& campaign = study_of_bump().simulated.campaign;
  ModelSpec model = testing_support::polynomials();
  extend_model({model, campaign.machine, &campaign}, diagnosis_of_bump().surfaces.front().spec, {});
  model.effects.back().options = [&] {
    Options open;  // coefficients left to the fit
    for (const auto& [key, value] : model.effects.back().options.all()) {
      if (key.first != "coefficients") open.set(key.first, value);
    }
    return open;
  }();
  FitOptions options;
  options.noise = NoisePolicy::White;
  const FitResult before = fit(campaign, testing_support::polynomials(), options),
                  after = fit(campaign, model, options);
  EXPECT_GT(before.sigma0, 1.3);
  EXPECT_LT(after.sigma0, 1.1);
  const auto kept = *after.identified.effects.front().options.numbers("coefficients");
  const auto linear = *diagnosis_of_bump().surfaces.front().spec.options.numbers("coefficients");
  ASSERT_EQ(kept.size(), linear.size());
  const Eigen::Map<const Eigen::VectorXd> a(kept.data(), static_cast<Eigen::Index>(kept.size())),
      b(linear.data(), static_cast<Eigen::Index>(linear.size()));
  EXPECT_GT(a.dot(b) / (a.norm() * b.norm()), 0.8);  // what is free is not quite the same
}

/// As if the catalogue had no name for it.
TEST(SurfaceFindings, ALawIsFoundInWordsThatCanBeRead) {
  sim::Study hidden = hiding({backlash_that_grows_with_temperature()}, {5, 4, 4});
  hidden.environment.channels[0].amplitude = 1.0;  // so that time is no temperature
  const FittedStudy study(hidden);
  const Diagnosis diagnosis = diagnosed(study, {"thermal-reversal"});
  ASSERT_EQ(diagnosis.surfaces.size(), 1u);
  const SurfaceFinding& surface = diagnosis.surfaces.front();
  EXPECT_THAT(surface.label, ::testing::HasSubstr("dir_x"));
  ASSERT_FALSE(surface.formulas.empty()) << surface.label;
  std::vector<std::string> labels;
  for (const FormulaFinding& formula : surface.formulas) labels.push_back(formula.label);
  EXPECT_THAT(labels, ::testing::Contains(::testing::HasSubstr("dir_x * (T_column - 20)")));
  const std::vector<EffectFinding> accepted = accepted_effects(diagnosis);
  ASSERT_EQ(accepted.size(), diagnosis.effects.size() + 1);
  EXPECT_EQ(accepted.back().spec.kind, "custom");
  EXPECT_EQ(accepted.back().label, surface.formulas.front().label);
}

TEST(SurfaceFindings, NothingIsDrawnWhereNothingIsHidden) {
  const FittedStudy study(hiding({}, {5, 4, 3}));
  EXPECT_TRUE(diagnosed(study).surfaces.empty());
}

}  // namespace
}  // namespace volcal
