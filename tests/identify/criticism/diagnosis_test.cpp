// Diagnosis of simulated campaigns. What is hidden comes from sim/, which shares no code with the catalogue.

#include "volcal/identify/criticism/diagnosis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/solve/fit.h"

namespace volcal {
namespace {

using testing_support::hiding;
using testing_support::reversal;

struct Diagnosed {
  sim::SimulatedCampaign simulated;
  FitResult result;
  Diagnosis diagnosis;
};

/// Of a machine whose functions lie outside every basis, with the default model.
Diagnosed diagnosed(sim::Study study) {
  study.truth.random.wave_scale = 1.0;
  Diagnosed out{sim::simulate(study), {}, {}};
  out.result = fit(out.simulated.campaign, ModelSpec{});
  DiagnoseOptions options;
  options.climb = true;
  out.diagnosis = diagnose(out.simulated.campaign, out.result, options);
  return out;
}

/// Made once.
const Diagnosed& diagnosed_reversal() {
  static const Diagnosed found = diagnosed(hiding({reversal("EYY", 0.5e-6)}));
  return found;
}

/// A reversal of Y by b moves the functional point by b/2 at every position.
void expect_figures_of_reversal(const Diagnosed& found) {
  const AmplitudeFigure& amplitude = found.diagnosis.effects[0].amplitudes[0];
  const DiagnosisFigures& figures = found.diagnosis.figures;
  EXPECT_TRUE(figures.leading.accepted);
  EXPECT_EQ(figures.leading.label, "reversal EYY");
  EXPECT_NEAR(figures.leading.slope, amplitude.value, 0.02 * amplitude.u);
  EXPECT_NEAR(figures.leading.u, amplitude.u, 0.01 * amplitude.u);
  EXPECT_LE(figures.observations.size(), 2500U);
  EXPECT_EQ(figures.observation_count, found.simulated.campaign.reading_count());
  const auto variable = std::ranges::find(figures.variables, "dir_y", &VariableFigure::name);
  ASSERT_NE(variable, figures.variables.end());
  ASSERT_EQ(variable->given[0].count.size(), 2U);
  EXPECT_EQ(variable->given[0].count[0] + variable->given[0].count[1], figures.observation_count);
  EXPECT_EQ(variable->given[0].count, variable->reached[0].count);
  const BinnedMean &given = variable->given[3], &reached = variable->reached[3];  // along Y
  ASSERT_EQ(given.mean.size(), 2U);
  EXPECT_NEAR(given.mean[1] - given.mean[0], amplitude.value, 0.15 * std::abs(amplitude.value));
  EXPECT_LT(std::abs(reached.mean[1] - reached.mean[0]), 0.2 * std::abs(amplitude.value));
  const auto& names = figures.generic.variables;
  const auto y = std::ranges::find(names, "dir_y") - names.begin();
  EXPECT_LT(figures.generic.given[1](y, y), log10_scan_risk());
  EXPECT_GT(figures.generic.reached[1](y, y), log10_scan_risk());
  const auto detectable =
      std::ranges::find(found.diagnosis.detectable, found.diagnosis.effects[0].name, &DetectableEffect::name);
  ASSERT_NE(detectable, found.diagnosis.detectable.end());
  EXPECT_NEAR(detectable->volumetric, 0.5 * detectable->mdb, 1e-3 * detectable->mdb);
}

void expect_all_detectable(const Diagnosis& diagnosis) {
  std::size_t invisible = 0;
  for (const DetectableEffect& effect : diagnosis.detectable) {
    if (!effect.visible) {
      ++invisible;
      continue;
    }
    EXPECT_GT(effect.mdb, 0.0) << effect.label;
    EXPECT_FALSE(effect.volumetric <= 0.0) << effect.label;  // not-a-number for effects of the instrument
  }
  EXPECT_EQ(invisible, diagnosis.not_visible.size());
  EXPECT_GT(diagnosis.detectable.size(), 100U);
}

TEST(Diagnosis, NothingHiddenIsNothingAbove) {
  const Diagnosis diagnosis = diagnosed(hiding({})).diagnosis;
  EXPECT_EQ(to_string(diagnosis.verdict), "NOTHING_ABOVE");
  EXPECT_TRUE(diagnosis.effects.empty());
  ASSERT_EQ(diagnosis.ladder.size(), 1U);
  EXPECT_GT(diagnosis.families, 100U);
  EXPECT_GT(diagnosis.generic_tests, 100U);
  expect_all_detectable(diagnosis);
}

TEST(Diagnosis, AReversalIsNamedWithItsAmplitude) {
  const Diagnosed& found = diagnosed_reversal();
  EXPECT_EQ(to_string(found.diagnosis.verdict), "NAMED");
  ASSERT_EQ(found.diagnosis.effects.size(), 1U);
  const EffectFinding& effect = found.diagnosis.effects[0];
  EXPECT_EQ(effect.name, EffectName::of_parts("reversal", "EYY", "dir_y", "step"));
  const double truth = found.simulated.hidden.at(0).amplitude;
  EXPECT_NEAR(effect.amplitudes[0].value, truth, 3.0 * effect.amplitudes[0].u);
  EXPECT_LT(effect.amplitudes[0].u, 0.1 * std::abs(truth));
  ASSERT_EQ(found.diagnosis.ladder.size(), 2U);
  EXPECT_LT(found.diagnosis.ladder[1].rms_heldout, found.diagnosis.ladder[0].rms_heldout);
  EXPECT_GT(found.diagnosis.ladder[1].heldout_loglik_gain, 10.0);
  EXPECT_GT(found.diagnosis.ladder[0].systematic_low, found.diagnosis.ladder[1].systematic_high);
  expect_figures_of_reversal(found);
}

/// To the bit.
TEST(Diagnosis, TheNumberOfThreadsChangesNothing) {
  const Diagnosis& one = diagnosed_reversal().diagnosis;
  DiagnoseOptions options;
  options.climb = true;
  ASSERT_EQ(options.threads, 1);
  options.threads = 3;
  const Diagnosis three =
      diagnose(diagnosed_reversal().simulated.campaign, diagnosed_reversal().result, options);
  ASSERT_EQ(one.ranking.size(), three.ranking.size());
  for (std::size_t i = 0; i < one.ranking.size(); ++i) {
    EXPECT_EQ(one.ranking[i].name, three.ranking[i].name);
    EXPECT_EQ(one.ranking[i].lm, three.ranking[i].lm);
  }
  ASSERT_EQ(one.ladder.size(), three.ladder.size());
  EXPECT_EQ(one.ladder.back().rms_heldout, three.ladder.back().rms_heldout);
  EXPECT_EQ(one.noise.front().value, three.noise.front().value);
  EXPECT_EQ(one.figures.leading.residual, three.figures.leading.residual);
  EXPECT_EQ(one.figures.generic.reached.at(0), three.figures.generic.reached.at(0));
  ASSERT_EQ(one.figures.variables.size(), three.figures.variables.size());
  EXPECT_EQ(one.figures.variables[0].reached[0].mean, three.figures.variables[0].reached[0].mean);
}

/// The extended model, fitted, explains what was hidden.
TEST(Diagnosis, ItsEffectCanBeFitted) {
  const Diagnosed& found = diagnosed_reversal();
  ASSERT_EQ(found.diagnosis.effects.size(), 1U);
  ModelSpec extended;
  extended.effects.push_back(found.diagnosis.effects[0].spec);
  const FitResult with = fit(found.simulated.campaign, extended);
  EXPECT_LT(with.chi2, found.result.chi2 - 100.0);
  const ParameterBlock* block = with.layout.find_block("reversal EYY");
  ASSERT_NE(block, nullptr);
  EXPECT_NEAR(with.parameters[block->offset], found.simulated.hidden.at(0).amplitude, 0.3e-6);
}

/// Two axes move, the third stands still.
Campaign circle_in(const std::string& plane) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 12;
  sim::BallBarCircles circles;
  circles.planes = {plane};
  study.measurements.emplace_back().settings = circles;
  study.validation.points = 5;
  return sim::simulate(study).campaign;
}

TEST(Diagnosis, NamesNothingOfAnAxisThatStandsStill) {
  for (const auto& [plane, still] : {std::pair("XY", "z"), std::pair("YZ", "x"), std::pair("ZX", "y")}) {
    const Campaign campaign = circle_in(plane);
    const FitResult result = fit(campaign, ModelSpec{});
    const Diagnosis diagnosis = diagnose(campaign, result, DiagnoseOptions{});
    EXPECT_FALSE(diagnosis.findings.empty()) << plane;
    const std::vector<std::string>& variables = diagnosis.figures.generic.variables;
    EXPECT_EQ(std::ranges::find(variables, still), variables.end()) << plane;
    EXPECT_GE(variables.size(), 2U) << plane;
    EXPECT_EQ(static_cast<std::size_t>(diagnosis.figures.generic.given.front().rows()), variables.size());
  }
}

}  // namespace
}  // namespace volcal
