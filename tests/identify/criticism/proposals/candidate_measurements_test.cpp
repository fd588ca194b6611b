// Every candidate measurement, and the planner against plain matrix algebra.

#include "volcal/identify/criticism/proposals/candidates/candidate_measurements.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "tests/support/effect_campaign.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/identify/criticism/proposals/measurement_planner.h"
#include "volcal/identify/criticism/proposals/next_measurement.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

std::vector<ExtraMeasurement> possible(const Campaign& campaign, std::size_t readings = 48) {
  const KinematicChain chain(campaign.machine);
  return candidate_measurements({campaign, chain, readings});
}

std::vector<ExtraMeasurement> of_action(const std::vector<ExtraMeasurement>& all, const std::string& action) {
  std::vector<ExtraMeasurement> out;
  std::ranges::copy_if(all, std::back_inserter(out), [&](const auto& each) { return each.action == action; });
  return out;
}

TEST(MeasurementMenu, SetupsAreCompleteAndNew) {
  const Campaign campaign = testing_support::effect_campaign();
  const auto all = possible(campaign);
  std::set<std::string> names;
  for (const volcal::Setup& setup : campaign.setups) names.insert(setup.name);
  for (const ExtraMeasurement& extra : all) {
    EXPECT_FALSE(extra.words.empty());
    EXPECT_GE(extra.readings(), 8U);
    EXPECT_LE(extra.readings(), 96U);
    for (const volcal::Setup& setup : extra.setups) {
      EXPECT_TRUE(names.insert(setup.name).second) << setup.name;
      EXPECT_LT(setup.tool, campaign.machine.tools.size() + extra.tools.size());
      const Readings& readings = setup.readings;
      EXPECT_EQ(readings.time.size(), readings.size());
      EXPECT_EQ(readings.temperature.size(), 2U);
      EXPECT_GT(readings.time.front(), time_span(campaign).second);
      EXPECT_FALSE(setup.options.has("station_sigma"));
      for (const auto& value : readings.value) EXPECT_EQ(value.size(), readings.size());
    }
  }
  for (const CandidateKind& entry : candidate_kinds()) {
    EXPECT_FALSE(entry.summary.empty());
    if (entry.action == "jittered-positions" || entry.action == "opposite-approach") continue;
    EXPECT_FALSE(of_action(all, std::string(entry.action)).empty()) << entry.action;
  }
}

TEST(MeasurementMenu, WithoutTimesThereIsNothingToRevisit) {
  Campaign campaign = testing_support::effect_campaign();
  for (volcal::Setup& setup : campaign.setups) setup.readings.time.clear();
  const auto all = possible(campaign);
  EXPECT_TRUE(of_action(all, "revisit").empty());
  EXPECT_TRUE(of_action(all, "cold-start").empty());
  EXPECT_FALSE(of_action(all, "second-tool").empty());
}

TEST(MeasurementMenu, AColdStartHasTheFirstTemperatures) {
  const Campaign campaign = testing_support::effect_campaign();
  const auto cold = of_action(possible(campaign), "cold-start").front();
  const auto warm = of_action(possible(campaign), "revisit").front();
  EXPECT_DOUBLE_EQ(cold.setups[0].readings.temperature.at("spindle").front(), 20.0);
  EXPECT_DOUBLE_EQ(warm.setups[0].readings.temperature.at("spindle").front(), 24.6);  // 20 + 0.2 * 23
}

TEST(MeasurementMenu, PositionsOnAGridAreMovedInsideTheTravel) {
  Campaign campaign = testing_support::effect_campaign();
  volcal::Setup& setup = campaign.setups.front();
  auto& x = setup.readings.position[index_of(AxisName::X)];
  const Axis& axis = campaign.machine.axis(AxisName::X);
  for (std::size_t row = 0; row < x.size(); ++row) {
    x[row] = axis.travel_min + 0.1 * static_cast<double>(row % 3);
  }
  const auto jittered = of_action(possible(campaign), "jittered-positions");
  ASSERT_EQ(jittered.size(), 1U);
  EXPECT_NE(jittered[0].words.find("X off its step of 100 mm"), std::string::npos) << jittered[0].words;
  std::set<long> distinct;
  for (const double q : jittered[0].setups[0].readings.position[index_of(AxisName::X)]) {
    EXPECT_GE(q, axis.travel_min);
    EXPECT_LE(q, axis.travel_max);
    distinct.insert(std::lround(q * 1e6));
  }
  EXPECT_EQ(distinct.size(), jittered[0].readings());
}

/// Places 0, 100, 200, 300 mm, some of them recorded once more 1 um further and two half a step beside the
/// grid: neighbours are 100 mm apart, or 50 mm twice.
TEST(MeasurementMenu, TheStepOfAGridIsTheOneThatMostPositionsShare) {
  const std::vector<std::vector<double>> places = {
      {0.1, 0.2, 0.3, 0.4},
      {0.1, 0.2, 0.200001, 0.3, 0.3000015, 0.4},
      {0.1, 0.100001, 0.2, 0.200001, 0.3, 0.300001, 0.4, 0.400001},
      {0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.7},
  };
  for (const auto& positions : places) {
    Campaign campaign = testing_support::effect_campaign();
    for (volcal::Setup& setup : campaign.setups) {
      auto& x = setup.readings.position[index_of(AxisName::X)];
      for (std::size_t row = 0; row < x.size(); ++row) x[row] = positions[row % positions.size()];
    }
    const auto jittered = of_action(possible(campaign), "jittered-positions");
    ASSERT_FALSE(jittered.empty()) << positions.size();
    EXPECT_NE(jittered[0].words.find("X off its step of 100 mm"), std::string::npos) << jittered[0].words;
  }
}

/// Where no two gaps are the same, the smallest: 50 mm of 0, 50, 150 and 300 mm.
TEST(MeasurementMenu, OfGapsThatAllDifferTheSmallestCounts) {
  Campaign campaign = testing_support::effect_campaign();
  auto& x = campaign.setups.front().readings.position[index_of(AxisName::X)];
  constexpr double kPlaces[] = {0.1, 0.15, 0.25, 0.4};
  for (std::size_t row = 0; row < x.size(); ++row) x[row] = kPlaces[row % 4];
  const auto jittered = of_action(possible(campaign), "jittered-positions");
  ASSERT_FALSE(jittered.empty());
  EXPECT_NE(jittered[0].words.find("X off its step of 50 mm"), std::string::npos) << jittered[0].words;
}

TEST(MeasurementMenu, OneSidedApproachesAreReversed) {
  Campaign campaign = testing_support::effect_campaign();
  std::ranges::fill(campaign.setups.front().readings.direction[index_of(AxisName::Y)], std::int8_t{1});
  const auto opposite = of_action(possible(campaign), "opposite-approach");
  ASSERT_EQ(opposite.size(), 1U);
  EXPECT_NE(opposite[0].words.find("approaching Y from the other side"), std::string::npos);
  for (const std::int8_t d : opposite[0].setups[0].readings.direction[index_of(AxisName::Y)])
    EXPECT_EQ(d, -1);
}

TEST(MeasurementMenu, RowsAreWholeLinesSpreadOverTheSetup) {
  volcal::Setup setup;
  for (std::size_t row = 0; row < 400; ++row) {
    setup.readings.line.push_back(static_cast<std::int32_t>(row / 8));
    setup.readings.source_line.push_back(static_cast<std::int64_t>(row));
  }
  const auto rows = spread_rows(setup, 48);
  ASSERT_EQ(rows.size(), 48U);
  std::set<std::size_t> lines;
  for (const std::size_t row : rows) lines.insert(row / 8);
  EXPECT_EQ(lines.size(), 6U);
  EXPECT_LT(*lines.begin(), 15U);
  EXPECT_GT(*lines.rbegin(), 35U);
}

class Planner : public ::testing::Test {
 protected:
  static sim::Study study() {
    sim::Study study;
    study.machine = sim::reference_machines()[1];
    study.seed = 11;
    sim::Tracking tracking;
    tracking.grid = {4, 4, 3};
    for (const char* station : {"P1", "P2", "P3"}) tracking.runs.push_back({station, "short"});
    study.measurements.emplace_back().settings = tracking;
    study.validation.points = 10;
    return study;
  }

  Planner() {
    families_ = families(model_);
    tests_ = test_families(model_, families_, projector_, 1);
  }

  PlannedHypothesis planned(const std::string& kind) const {
    const auto found = std::ranges::find_if(
        families_, [&](const Family& each) { return each.effect && each.name().kind == kind; });
    return {{static_cast<std::size_t>(found - families_.begin()), found->scan.front()}, {}};
  }

  Campaign campaign_ = sim::simulate(study()).campaign;
  FitResult result_ = fit(campaign_, ModelSpec{});
  LinearModel model_{campaign_, result_};
  std::vector<NoiseParameters> noise_{NoiseParameters{}};
  Projector projector_{model_.problem(), model_.problem().data, noise_, 1, model_.parts()};
  std::vector<Family> families_;
  std::vector<FamilyTest> tests_;
  CriticismState state_{model_, result_, model_.problem().data, projector_, noise_, families_, tests_, -5.0,
                        0.8,    1};
};

/// Rows that were measured, hypothetical once more, have the derivatives that they had; a dead path of their
/// own.
TEST_F(Planner, HypotheticalRowsAreThoseOfTheSamePositions) {
  const HypotheticalCampaign hypothetical(campaign_, result_, model_.noise_groups(), possible(campaign_));
  const HypotheticalRows rows = hypothetical.rows(0);  // revisit of P1_short
  const auto picked = spread_rows(campaign_.setups[0], 48);
  ASSERT_EQ(rows.model.rows(), static_cast<Eigen::Index>(picked.size()));
  ASSERT_EQ(rows.nuisance.cols(), 1);
  EXPECT_TRUE(rows.nuisance.isApproxToConstant(-1.0));
  const Eigen::MatrixXd& jacobian = model_.problem().jacobian;
  double different = 0.0;
  int dead_paths = 0;
  for (Eigen::Index column = 0; column < jacobian.cols(); ++column) {
    Eigen::VectorXd known(rows.model.rows());
    for (std::size_t i = 0; i < picked.size(); ++i) {
      known[static_cast<Eigen::Index>(i)] = jacobian(static_cast<Eigen::Index>(picked[i]), column);
    }
    if (known.isApproxToConstant(-1.0) && rows.model.col(column).isZero()) {
      ++dead_paths;
      continue;
    }
    different = std::max(different, (known - rows.model.col(column)).cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(dead_paths, 1);
  EXPECT_LT(different, 1e-6);  // the second-order remainder moves the point by that much at most
}

/// Gram matrices of the planner against (H^T S^-1 H - B^T A^-1 B) with everything stacked.
TEST_F(Planner, AgreesWithStackedMatrices) {
  const HypotheticalCampaign hypothetical(campaign_, result_, model_.noise_groups(), possible(campaign_));
  const std::vector<PlannedHypothesis> both = {planned("station-drift"), planned("dead-path")};
  const MeasurementPlanner planner(state_, both, 0, hypothetical);
  const NoiseProblem& problem = model_.problem();
  Eigen::MatrixXd effects(problem.jacobian.rows(), 4);
  effects << family_columns(model_, families_[both[0].hypothesis.family], both[0].hypothesis.shape),
      family_columns(model_, families_[both[1].hypothesis.family], both[1].hypothesis.shape);
  for (std::size_t i = 0; i < hypothetical.measurements().size(); i += 3) {
    const HypotheticalRows rows = hypothetical.rows(i);
    const Eigen::Index n = effects.rows(), m = rows.model.rows(), p = problem.jacobian.cols();
    const Eigen::Index q = rows.nuisance.cols();
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(n + m, p + q), h(n + m, 4);
    Eigen::VectorXd weight(n + m);
    j.topLeftCorner(n, p) = problem.jacobian;
    j.bottomRows(m) << rows.model, rows.nuisance;
    h.topRows(n) = effects;
    h.bottomRows(m) << hypothetical.columns(i, rows, *families_[both[0].hypothesis.family].effect, {}),
        hypothetical.columns(i, rows, *families_[both[1].hypothesis.family].effect, {});
    for (Eigen::Index k = 0; k < n; ++k) weight[k] = 1.0 / problem.data.sigma[static_cast<std::size_t>(k)];
    for (Eigen::Index k = 0; k < m; ++k) weight[n + k] = 1.0 / rows.data.sigma[static_cast<std::size_t>(k)];
    j = weight.asDiagonal() * j;
    h = weight.asDiagonal() * h;
    Eigen::MatrixXd information = j.transpose() * j;
    information.topLeftCorner(p, p) += problem.prior_precision;
    information.diagonal().tail(q) += rows.nuisance_precision;
    const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    const Eigen::MatrixXd cross = scale.asDiagonal() * (j.transpose() * h);
    const Eigen::MatrixXd gram = h.transpose() * h - cross.transpose() * scaled.ldlt().solve(cross);
    const Eigen::VectorXd unit = gram.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd difference = unit.asDiagonal() * (gram - planner.with(i).gram) * unit.asDiagonal();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6) << hypothetical.measurements()[i].words;
  }
}

/// More readings never take separation away.
/// A drift of the station P1 against a dead path of the laser that stands there, `size` m/s large, the one as
/// likely as the other; predictions in the volume differ by 0.3 um, U 0.5 um or a tenth of it.
class ProposedForASet : public Planner {
 protected:
  MeasurementProposal proposed(double size, bool matters) const {
    Diagnosis diagnosis;
    diagnosis.verdict = Verdict::OneOf;
    diagnosis.one_of = {found("station-drift", size), found("dead-path", size)};
    SetFinding set;
    set.chosen = 0;
    set.members.resize(2);
    set.members[0].difference = set.members[0].difference_u = 0.0;
    set.members[1].difference = 0.3e-6;
    set.members[1].difference_u = (matters ? 0.05e-6 : 0.5e-6) / kCoverageFactor;
    set.farthest = 1;
    set.matters = matters;
    diagnosis.sets = {set};
    add_next_measurements(state_, {}, diagnosis);
    EXPECT_EQ(diagnosis.proposals.size(), 1u);
    return diagnosis.proposals.front();
  }

 private:
  EffectFinding found(const std::string& kind, double size) const {
    const auto family = std::ranges::find_if(families_, [&](const Family& each) {
      return each.effect && each.name().kind == kind && each.name().driver.name() == "time" &&
             each.name().target.name().find("P1") != std::string::npos;
    });
    EXPECT_NE(family, families_.end());
    EffectFinding finding;
    finding.name = family->name();
    finding.label = family->label();
    finding.amplitudes.resize(static_cast<std::size_t>(family->amplitudes()));
    for (AmplitudeFigure& amplitude : finding.amplitudes) amplitude.value = size;
    return finding;
  }
};

TEST_F(ProposedForASet, WhatSeparatesIsMeasuredWhetherOrNotItMatters) {
  constexpr double kLarge = 50e-6 / 3600.0;
  for (const bool matters : {true, false}) {
    const MeasurementProposal proposal = proposed(kLarge, matters);
    EXPECT_EQ(proposal.finding.code, FindingCode::MeasurementSeparates);
    EXPECT_GT(proposal.gain, kThresholds.worth_a_name);
  }
}

TEST_F(ProposedForASet, WhereNothingSeparatesItIsSaidWhetherThatMatters) {
  constexpr double kSmall = 0.01e-6 / 3600.0;
  const Finding open = proposed(kSmall, true).finding, same = proposed(kSmall, false).finding;
  EXPECT_EQ(open.code, FindingCode::MeasurementNoneSeparates);
  EXPECT_FALSE(open.has("difference"));
  EXPECT_EQ(same.code, FindingCode::MeasurementNoneSeparates);
  EXPECT_DOUBLE_EQ(same.number("difference").si, 0.3e-6);
  EXPECT_DOUBLE_EQ(same.number("U").si, 0.5e-6);
}

TEST_F(Planner, SeparationGrows) {
  const HypotheticalCampaign hypothetical(campaign_, result_, model_.noise_groups(), possible(campaign_));
  const MeasurementPlanner planner(state_, {planned("station-drift"), planned("dead-path")}, 0, hypothetical);
  const double now = planner.separation(planner.now(), 0, 1);
  EXPECT_GT(now, 0.0);
  for (std::size_t i = 0; i < planner.measurements(); ++i) {
    EXPECT_GE(planner.separation(planner.with(i), 0, 1), now * (1.0 - 1e-6));
    EXPECT_GT(planner.separation(planner.plain(i), 0, 1), now);
  }
}

}  // namespace
}  // namespace volcal
