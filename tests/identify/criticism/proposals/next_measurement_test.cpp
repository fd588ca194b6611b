// What is proposed, on simulated campaigns with known traps; and that the proposal keeps its promise when it
// is measured. What is hidden comes from sim/, which shares no code with the catalogue.

#include "volcal/identify/criticism/proposals/next_measurement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

const EffectName kLengthScale = EffectName::of_parts("length-scale", "readings", "length", "linear");
const EffectName kDrift = EffectName::of_parts("station-drift", "station P1", "time", "linear");
const EffectName kDeadPath = EffectName::of_parts("dead-path", "readings of P1_short", "time", "linear");
const EffectName kLead = EffectName::of_parts("lead-error", "EXX", "x", "periodic");

/// Four stations, one tool at each; `again`: stations that are then visited once more.
sim::Study one_tool_per_station(const std::vector<std::string>& again = {}) {
  sim::Study study;
  study.machine = sim::reference_machines()[1];
  study.seed = 7;
  study.truth.random.wave_scale = 0.0;  // functions that polynomials() holds
  sim::Tracking tracking;
  tracking.grid = {6, 5, 5};
  for (const char* station : {"P1", "P2", "P3", "P4"}) tracking.runs.push_back({station, "short"});
  for (const std::string& station : again) tracking.runs.push_back({station, "short"});
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  return study;
}

sim::HiddenEffect hidden_next(const std::string& kind, double amplitude) {
  sim::HiddenEffect effect{.kind = kind, .options = {}, .amplitude = amplitude};
  return effect;
}

Diagnosis diagnosed_next(const sim::Study& study, std::vector<EffectSpec> separate = {},
                         const ModelSpec& model = testing_support::polynomials()) {
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  const FitResult result = fit(simulated.campaign, model);
  DiagnoseOptions options;
  options.planning.separate = std::move(separate);
  return diagnose(simulated.campaign, result, options);
}

bool among(const EffectName& name, const std::vector<EffectName>& names) {
  return std::ranges::find(names, name) != names.end();
}

/// Wavelength against the uniform scale of the axes: only a length known without the laser tells.
TEST(NextMeasurement, AnInvisibleLengthScaleAsksForACalibratedLength) {
  const Diagnosis diagnosis = diagnosed_next(one_tool_per_station(), {effect_spec("length-scale", {})});
  ASSERT_EQ(diagnosis.proposals.size(), 1U);
  const MeasurementProposal& proposal = diagnosis.proposals.front();
  EXPECT_EQ(proposal.action, "calibrated-length");
  EXPECT_TRUE(among(kLengthScale, proposal.makes_visible));
  EXPECT_GT(proposal.gain, 100.0);
  EXPECT_LT(proposal.plain_gain, 1.2);
  EXPECT_THAT(sentence(proposal.finding), HasSubstr("ball-bar of calibrated length"));
}

/// A drift of 17 um/h: ONE_OF before, NAMED once the station was visited again.
TEST(NextMeasurement, ADriftThatLooksLikeADeadPathAsksForARevisit) {
  sim::HiddenEffect drift = hidden_next("station-drift", 17e-6);
  drift.options.set("station", std::string("P1"));
  drift.options.set("direction", Eigen::Vector3d(1.0, 0.6, 0.0));
  sim::Study study = one_tool_per_station();
  study.hidden = {drift};
  const Diagnosis before = diagnosed_next(study);
  ASSERT_EQ(before.verdict, Verdict::OneOf) << sentence(before.findings.front());
  ASSERT_FALSE(before.proposals.empty());
  const MeasurementProposal& proposal = before.proposals.front();
  EXPECT_EQ(proposal.action, "revisit");
  EXPECT_EQ(proposal.setup, "P1_short");
  EXPECT_TRUE(among(kDrift, proposal.separates) && among(kDeadPath, proposal.separates));
  EXPECT_GT(proposal.gain, 2.9);
  EXPECT_LT(proposal.plain_gain, 1.1);

  study = one_tool_per_station({"P1"});
  study.hidden = {drift};
  const Diagnosis after = diagnosed_next(study);
  ASSERT_EQ(after.verdict, Verdict::Named) << sentence(after.findings.front());
  EXPECT_EQ(after.effects.front().name, kDrift);

  study = one_tool_per_station({"P3"});
  study.hidden = {drift};
  EXPECT_EQ(diagnosed_next(study).verdict, Verdict::OneOf);  // as many readings elsewhere do not help
}

/// 160 mm from position to position: 16 turns of a screw of 10 mm. Polynomials leave waves of other periods
/// to see.
TEST(NextMeasurement, APeriodThatDividesTheGridStepAsksForJitteredPositions) {
  sim::Study study = one_tool_per_station();
  std::get<sim::Tracking>(study.measurements.front().settings).jitter = 0.0;
  const Diagnosis diagnosis =
      diagnosed_next(study, {effect_spec("lead-error", {{"symbol", std::string("EXX")}})}, ModelSpec{});
  ASSERT_FALSE(diagnosis.proposals.empty());
  const MeasurementProposal& proposal = diagnosis.proposals.front();
  EXPECT_EQ(proposal.action, "jittered-positions");
  EXPECT_TRUE(among(kLead, proposal.makes_visible));
  EXPECT_THAT(sentence(proposal.finding), HasSubstr("period 10 mm"));
  EXPECT_THAT(sentence(proposal.finding), HasSubstr("X off its step of 160 mm"));
  EXPECT_LT(proposal.plain_gain, 1.2);
}

TEST(NextMeasurement, WhatTheModelHasIsRefused) {
  const sim::SimulatedCampaign simulated = sim::simulate(one_tool_per_station());
  ModelSpec model = testing_support::polynomials();
  const EffectSpec reversal = effect_spec("reversal", {{"symbol", std::string("EXX")}});
  model.effects = {reversal};
  const FitResult result = fit(simulated.campaign, model);
  DiagnoseOptions options;
  options.planning.separate = {reversal};
  EXPECT_THROW(diagnose(simulated.campaign, result, options), InputError);
}

/// Every MIB is at least the MDB; of effects that are separated least, the rival is among the nearest.
TEST(Confounding, FiguresOfACampaign) {
  const Diagnosis diagnosis = diagnosed_next(one_tool_per_station());
  ASSERT_FALSE(diagnosis.ranking.empty());
  for (const EffectFinding& finding : diagnosis.ranking) {
    for (const AmplitudeFigure& figure : finding.amplitudes) {
      EXPECT_GE(figure.mib, figure.mdb) << figure.label;
      EXPECT_NE(figure.mib_rival, finding.label);
    }
  }
  const Confounding& confounding = diagnosis.confounding;
  ASSERT_EQ(confounding.names.size(), static_cast<std::size_t>(confounding.cosine.rows()));
  ASSERT_GT(confounding.names.size(), 10U);
  for (Eigen::Index i = 0; i < confounding.cosine.rows(); ++i) {
    EXPECT_NEAR(confounding.cosine(i, i), 1.0, 1e-9);
    for (Eigen::Index j = 0; j < i; ++j) {
      EXPECT_GE(confounding.cosine(i, j), 0.0);
      EXPECT_LE(confounding.cosine(i, j), 1.0);
      EXPECT_EQ(confounding.cosine(i, j), confounding.cosine(j, i));
    }
  }
}

}  // namespace
}  // namespace volcal
