// Diagnosis of simulated campaigns. What is hidden comes from sim/, which shares no code with the catalogue.

#include "volcal/identify/criticism/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/solve/fit.h"
#include "volcal/sim/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

sim::Study hiding(std::vector<sim::HiddenEffect> hidden) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 31;
  study.environment.channels = {
      {.name = "column", .start = 20.0, .drift = 0.6 / 3600.0, .amplitude = 0.2, .period = 9000.0}};
  study.hidden = std::move(hidden);
  sim::Tracking tracking;
  tracking.grid = {6, 5, 5};
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  return study;
}

sim::HiddenEffect reversal(const std::string& symbol, double rms) {
  sim::HiddenEffect effect{.kind = "reversal", .options = {}, .rms = rms};
  effect.options.set("symbol", symbol);
  return effect;
}

struct Diagnosed {
  sim::SimulatedCampaign simulated;
  Diagnosis diagnosis;
};

Diagnosed diagnosed(const sim::Study& study) {
  Diagnosed out{sim::simulate(study), {}};
  const FitResult result = fit(out.simulated.campaign, ModelSpec{});
  DiagnoseOptions options;
  options.climb = true;
  out.diagnosis = diagnose(out.simulated.campaign, result, options);
  return out;
}

TEST(Diagnosis, NothingHiddenIsNothingAbove) {
  const Diagnosis diagnosis = diagnosed(hiding({})).diagnosis;
  EXPECT_EQ(to_string(diagnosis.verdict), "NOTHING_ABOVE");
  EXPECT_TRUE(diagnosis.effects.empty());
  ASSERT_EQ(diagnosis.ladder.size(), 1U);
  EXPECT_GT(diagnosis.families, 100U);
  EXPECT_GT(diagnosis.generic_tests, 100U);
}

TEST(Diagnosis, AReversalIsNamedWithItsAmplitude) {
  const Diagnosed found = diagnosed(hiding({reversal("EYY", 0.5e-6)}));
  EXPECT_EQ(to_string(found.diagnosis.verdict), "NAMED");
  ASSERT_EQ(found.diagnosis.effects.size(), 1U);
  const EffectFinding& effect = found.diagnosis.effects[0];
  EXPECT_EQ(effect.name, (EffectName{"reversal", "EYY", "dir_y", "step"}));
  const double truth = found.simulated.hidden.at(0).amplitude;
  EXPECT_NEAR(effect.amplitudes[0].value, truth, 3.0 * effect.amplitudes[0].u);
  EXPECT_LT(effect.amplitudes[0].u, 0.1 * std::abs(truth));
  ASSERT_EQ(found.diagnosis.ladder.size(), 2U);
  EXPECT_LT(found.diagnosis.ladder[1].rms_heldout, found.diagnosis.ladder[0].rms_heldout);
  EXPECT_GT(found.diagnosis.ladder[1].heldout_loglik_gain, 10.0);
}

/// To the bit.
TEST(Diagnosis, TheNumberOfThreadsChangesNothing) {
  const sim::SimulatedCampaign simulated = sim::simulate(hiding({reversal("EZZ", 0.4e-6)}));
  const FitResult result = fit(simulated.campaign, ModelSpec{});
  DiagnoseOptions options;
  const Diagnosis one = diagnose(simulated.campaign, result, options);
  options.threads = 3;
  const Diagnosis three = diagnose(simulated.campaign, result, options);
  ASSERT_EQ(one.ranking.size(), three.ranking.size());
  for (std::size_t i = 0; i < one.ranking.size(); ++i) {
    EXPECT_EQ(one.ranking[i].name, three.ranking[i].name);
    EXPECT_EQ(one.ranking[i].lm, three.ranking[i].lm);
  }
  ASSERT_EQ(one.ladder.size(), three.ladder.size());
  EXPECT_EQ(one.ladder.back().rms_heldout, three.ladder.back().rms_heldout);
  EXPECT_EQ(one.noise.front().value, three.noise.front().value);
}

/// The extended model, fitted, explains what was hidden.
TEST(Diagnosis, ItsEffectCanBeFitted) {
  const Diagnosed found = diagnosed(hiding({reversal("EXX", 0.6e-6)}));
  ASSERT_EQ(found.diagnosis.effects.size(), 1U);
  ModelSpec extended;
  extended.effects.push_back(found.diagnosis.effects[0].spec);
  const FitResult without = fit(found.simulated.campaign, ModelSpec{});
  const FitResult with = fit(found.simulated.campaign, extended);
  EXPECT_LT(with.chi2, without.chi2 - 100.0);
  const ParameterBlock* block = with.layout.find_block("reversal EXX");
  ASSERT_NE(block, nullptr);
  EXPECT_NEAR(with.parameters[block->offset], found.simulated.hidden.at(0).amplitude, 0.3e-6);
}

}  // namespace
}  // namespace volcal
