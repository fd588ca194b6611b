// What the search tells and what it keeps to itself. Campaigns come from sim/.

#include "volcal/identify/criticism/search/search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "tests/support/hidden_studies.h"
#include "tests/support/long_tests.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/scans/scan_variables.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;
using testing_support::hiding;
using testing_support::reversal;

const Eigen::Vector3i kGrid{5, 4, 4};

sim::HiddenEffect hidden_beside(const std::string& kind, const std::string& symbol, double rms) {
  sim::HiddenEffect effect{.kind = kind, .options = {}, .rms = rms};
  effect.options.set("symbol", symbol);
  return effect;
}

Diagnosis searched(const FittedStudy& study, bool climb, std::vector<std::string> leave_out = {}) {
  DiagnoseOptions options;
  options.climb = climb;
  options.leave_out = std::move(leave_out);
  options.figures = false;
  options.compare = false;
  return diagnose(study.simulated.campaign, study.result, options);
}

std::vector<std::string> kinds_and_targets(const std::vector<EffectFinding>& findings) {
  std::vector<std::string> all;
  all.reserve(findings.size());
  for (const EffectFinding& finding : findings)
    all.push_back(finding.name.kind + " " + finding.name.target.name());
  return all;
}

/// A reversal of all axes explains most of two of different size, and is no name for them.
TEST(Search, AStepTellsTheFirstEffectAndThatMoreHasAName) {
  const FittedStudy study(hiding({reversal("EXX", 0.7e-6), reversal("EYY", 0.5e-6)}, kGrid));
  const Diagnosis both = searched(study, true);
  EXPECT_EQ(to_string(both.verdict), "NAMED");
  EXPECT_THAT(kinds_and_targets(both.effects),
              ::testing::UnorderedElementsAre("reversal EXX", "reversal EYY"));
  const Diagnosis step = searched(study, false);
  EXPECT_EQ(to_string(step.verdict), "NAMED_MORE_REMAINS");
  EXPECT_THAT(kinds_and_targets(step.effects), ::testing::ElementsAre("reversal EXX"));
  EXPECT_EQ(step.ladder.size(), 2U);
  EXPECT_EQ(std::ranges::count(step.findings, FindingCode::DiagnosisMoreInCatalogue, &Finding::code), 1);
  EXPECT_THAT(kinds_and_targets(step.ranking), ::testing::Contains("reversal EYY"));
}

/// Two channels that read the same: every thermal effect has a twin, and no set is lost.
TEST(Search, KeepsEverySetOfNamesThatTheReadingsDoNotSeparate) {
  sim::HiddenEffect first = hidden_beside("thermal-tilt", "EAZ", 1.2e-6),
                    second = hidden_beside("thermal-tilt", "ECX", 1.2e-6);
  for (sim::HiddenEffect* effect : {&first, &second}) effect->options.set("channel", "column");
  sim::Study study = hiding({first, second}, kGrid);
  study.environment.channels[0].amplitude = 1.0;
  study.environment.channels.push_back(study.environment.channels[0]);
  study.environment.channels[1].name = "ram";
  const Diagnosis diagnosis = searched(FittedStudy(study), true);
  EXPECT_EQ(to_string(diagnosis.verdict), "ONE_OF");
  EXPECT_TRUE(diagnosis.effects.empty());
  const auto sets = sets_of_alternatives(diagnosis);
  ASSERT_EQ(sets.size(), 2U);
  std::set<std::string> found;
  for (const auto* set : sets) {
    ASSERT_GE(set->size(), 2U);
    EXPECT_EQ(set->at(0).name.target.name(), set->at(1).name.target.name());
    EXPECT_NE(set->at(0).name.driver.name(), set->at(1).name.driver.name());
    found.insert(set->at(0).name.target.name());
  }
  EXPECT_EQ(found, (std::set<std::string>{"EAZ", "ECX"}));
  EXPECT_EQ(std::ranges::count(diagnosis.findings, FindingCode::DiagnosisOneOf, &Finding::code), 2);
  ASSERT_EQ(diagnosis.sets.size(), 2U);
  for (const SetFinding& set : diagnosis.sets) {
    ASSERT_TRUE(set.farthest.has_value());
    EXPECT_FALSE(set.matters) << "twins predict the same";
    for (const MemberFinding& member : set.members)
      EXPECT_LT(member.systematic, diagnosis.ladder.front().systematic);
  }
  EXPECT_EQ(std::ranges::count(diagnosis.findings, FindingCode::DiagnosisChoice, &Finding::code), 2);
}

/// What the user wrote is one more twin: it has the figures that its set gives it, in the place of what the
/// model reached holds, not beside that.
TEST(Search, AnOwnEffectThatIsARivalIsJudgedInThePlaceOfTheOther) {
  sim::HiddenEffect tilt = hidden_beside("thermal-tilt", "EAZ", 1.2e-6);
  tilt.options.set("channel", "column");
  sim::Study campaign = hiding({tilt}, kGrid);
  campaign.environment.channels[0].amplitude = 1.0;
  const FittedStudy study(campaign);
  DiagnoseOptions options;
  options.climb = true;
  options.figures = options.compare = false;
  options.own = {
      effect_spec("custom", {{"target", std::string("EAZ")}, {"expression", std::string("T_column - 20")}})};
  const Diagnosis diagnosis = diagnose(study.simulated.campaign, study.result, options);
  const auto sets = sets_of_alternatives(diagnosis);
  ASSERT_EQ(sets.size(), 1U);
  ASSERT_EQ(diagnosis.tried.size(), 1U);
  const EffectFinding& tried = diagnosis.tried.front();
  const auto member = std::ranges::find(*sets[0], tried.name, &EffectFinding::name);
  ASSERT_NE(member, sets[0]->end());
  EXPECT_LT(tried.log10_p, -10.0);
  EXPECT_EQ(tried.log10_p, member->log10_p);
  EXPECT_EQ(tried.gain, member->gain);
  EXPECT_EQ(tried.amplitudes.front().value, member->amplitudes.front().value);
  const MemberFinding& of_set =
      diagnosis.sets[0].members[static_cast<std::size_t>(member - sets[0]->begin())];
  EXPECT_NEAR(diagnosis.tried_errors.front().systematic, of_set.systematic, 1e-12);
}

/// A scan of both temperatures sees both effects at once, and does better than either name.
TEST(Search, NamesTwoEffectsThatAScanTakesForOne) {
  sim::HiddenEffect first = hidden_beside("thermal-tilt", "EAZ", 2.5e-6), second = first;
  first.options.set("channel", "column");
  second.options.set("channel", "ram");
  sim::Study campaign = hiding({first, second}, kGrid);
  campaign.environment.channels[0].amplitude = 1.0;
  campaign.environment.channels.push_back(
      {.name = "ram", .start = 20.0, .drift = 0.0, .amplitude = 1.0, .period = 2500.0});
  FittedStudy study(campaign);
  Search search(study.model, std::vector<bool>(study.model.size(), false), {});
  search.run();
  double best_name = 0.0, best_scan = 0.0;
  for (const FamilyTest& test : search.given().tests().families) best_name = std::max(best_name, test.gain);
  for (const GenericTest& test : search.given().tests().scans) best_scan = std::max(best_scan, test.gain);
  EXPECT_GT(best_scan, best_name + 2.0);
  std::set<std::string> drivers;
  for (const AddedEffect& added : search.reached().added()) {
    const EffectName name = search.reached().setting().families[added.test.family].name();
    EXPECT_EQ(name.kind, "thermal-drift");
    drivers.insert(name.driver.name());
  }
  EXPECT_EQ(drivers, (std::set<std::string>{"T_column", "T_ram"}));
  EXPECT_EQ(search.reached().added().size(), 2U);
}

/// Three equal reversals, written by three error motions of the simulator: one name with one amplitude, since
/// three of them explain no more.
TEST(Search, NamesOneCauseOnAllAxes) {
  std::vector<sim::HiddenEffect> same;
  for (const char* symbol : {"EXX", "EYY", "EZZ"}) {
    sim::HiddenEffect& one = same.emplace_back(reversal(symbol, 0.0));
    one.rms.reset();
    one.amplitude = 1.6e-6;
  }
  const FittedStudy study(hiding(std::move(same), kGrid));
  const Diagnosis diagnosis = searched(study, true);
  ASSERT_THAT(kinds_and_targets(diagnosis.effects), ::testing::ElementsAre("common-reversal EXX EYY EZZ"));
  ASSERT_EQ(diagnosis.effects[0].amplitudes.size(), 1U);
  const AmplitudeFigure& b = diagnosis.effects[0].amplitudes[0];
  EXPECT_NEAR(b.value, 1.6e-6, 3.0 * b.u);
}

/// What decides says so, what is left out decides nothing, and what decided nothing changes nothing.
TEST(Search, TellsWhichRulesDecide) {
  FittedStudy study(hiding({reversal("EXX", 0.7e-6)}, kGrid));
  const auto searched_without = [&](std::set<SearchRule> off, std::set<SearchRule>& decided) {
    SearchOptions options;
    options.rules = {std::move(off), [&decided](SearchRule rule) { decided.insert(rule); }};
    Search search(study.model, std::vector<bool>(study.model.size(), false), std::move(options));
    search.run();
    return search;
  };
  std::set<SearchRule> by_all, by_others;
  const Search all = searched_without({}, by_all);
  ASSERT_EQ(all.reached().added().size(), 1U);
  EXPECT_TRUE(by_all.contains(SearchRule::DoubtfulScans)) << "a strong effect is seen by most scans";
  EXPECT_FALSE(by_all.contains(SearchRule::OneCause));
  const Search without = searched_without({SearchRule::OneCause, SearchRule::NamesTogether}, by_others);
  EXPECT_EQ(by_others, by_all);
  ASSERT_EQ(without.reached().added().size(), 1U);
  EXPECT_EQ(without.reached().added()[0].test.gain, all.reached().added()[0].test.gain);
}

/// Backlash that grows along the travel and passes through zero on it: of either part there is little alone.
TEST(Search, NamesTwoEffectsThatHideEachOther) {
  sim::HiddenEffect constant = reversal("EYY", 0.0), growing = hidden_beside("reversal-position", "EYY", 0.0);
  constant.rms.reset();
  growing.rms.reset();
  constant.amplitude = 1.6e-6;
  growing.amplitude = -4e-6;
  const Diagnosis diagnosis = searched(FittedStudy(hiding({constant, growing}, kGrid)), true);
  EXPECT_THAT(kinds_and_targets(diagnosis.effects),
              ::testing::UnorderedElementsAre("reversal EYY", "position-reversal EYY"));
}

sim::HiddenEffect bump_in_xy() {
  sim::HiddenEffect bump = hidden_beside("local-bump", "EZX", 1.5e-6);
  bump.options.set("centre", 0.1);
  bump.options.set("width", 0.12);
  bump.options.set("by", std::string("Y"));
  bump.options.set("by_centre", 0.1);
  bump.options.set("by_width", 0.12);
  return bump;
}

const FittedStudy& study_of_bump_in_xy() {
  static const FittedStudy study(hiding({bump_in_xy()}, kGrid));
  return study;
}

/// What the user thinks of is tested beside the catalogue: the right shape is named, the wrong one is not
/// asked for, and both are told.
TEST(Search, NamesWhatTheUserThinksOf) {
  const FittedStudy& study = study_of_bump_in_xy();
  DiagnoseOptions options;
  options.climb = true;
  options.figures = options.compare = false;
  const auto own = [](const char* expression) {
    return effect_spec("custom", {{"target", std::string("EZX")}, {"expression", std::string(expression)}});
  };
  options.own = {own("exp(-((x - 100) / 120)^2 / 2 - ((y - 100) / 120)^2 / 2)"), own("dir_y * x")};
  const Diagnosis diagnosis = diagnose(study.simulated.campaign, study.result, options);
  EXPECT_EQ(to_string(diagnosis.verdict), "NAMED");
  EXPECT_THAT(kinds_and_targets(diagnosis.effects), ::testing::ElementsAre("custom EZX"));
  EXPECT_TRUE(diagnosis.surfaces.empty());
  ASSERT_EQ(diagnosis.tried.size(), 2U);
  std::vector<bool> added;
  for (const Finding& finding : diagnosis.findings) {
    if (finding.code == FindingCode::DiagnosisTried) added.push_back(finding.flag("added"));
  }
  EXPECT_EQ(added, (std::vector<bool>{true, false}));
  EXPECT_LT(diagnosis.tried[0].log10_p, -10.0);
  EXPECT_GT(diagnosis.tried[1].log10_p, -1.0);
}

TEST(Search, WhatIsInNoCatalogueGetsNoName) {
  const Diagnosis diagnosis = searched(study_of_bump_in_xy(), false);
  EXPECT_EQ(to_string(diagnosis.verdict), "UNKNOWN");
  EXPECT_TRUE(diagnosis.effects.empty());
  ASSERT_FALSE(diagnosis.unknown.empty());
  EXPECT_THAT(names_of(diagnosis.unknown[0].variables), ::testing::Contains(::testing::AnyOf("x", "y")));
}

/// Backlash that the axis takes up on its first 50 mm has the reversal's driver and another shape.
TEST(Search, AReversalThatIsTakenUpOnTheWayGetsNoName) {
  VOLCAL_FOR_THE_NIGHT("Constancy.SeesAReversalThatIsTakenUpOnTheWay, by which the search refuses the name");
  sim::HiddenEffect memory = hidden_beside("direction-memory", "EYY", 1.5e-6);
  memory.options.set("length", 0.05);
  const Diagnosis diagnosis = searched(FittedStudy(hiding({memory}, kGrid)), true);
  EXPECT_EQ(to_string(diagnosis.verdict), "UNKNOWN");
  EXPECT_TRUE(diagnosis.effects.empty());
  ASSERT_FALSE(diagnosis.unknown.empty());
  EXPECT_THAT(names_of(diagnosis.unknown[0].variables), ::testing::Contains("dir_y"));
}

/// A screw that no name of the catalogue stands for is reported by its period.
TEST(Search, AWaveWithoutANameIsToldByItsPeriod) {
  sim::HiddenEffect lead = hidden_beside("screw-lead", "EXX", 0.6e-6);
  lead.options.set("period", 10.3e-3);
  const FittedStudy study(hiding({lead}, kGrid));
  const Diagnosis diagnosis = searched(study, true, {"lead-error", "encoder-subdivision"});
  EXPECT_EQ(to_string(diagnosis.verdict), "UNKNOWN");
  ASSERT_FALSE(diagnosis.unknown.empty());
  EXPECT_THAT(names_of(diagnosis.unknown[0].variables), ::testing::ElementsAre("x"));
  EXPECT_EQ(diagnosis.unknown[0].direction, ScanDirection::X);
  EXPECT_NEAR(diagnosis.unknown[0].period, 10.3e-3, 0.1e-3);
  EXPECT_NEAR(diagnosis.unknown[0].rms, 0.6e-6, 0.3e-6) << "in units of the stated noise";
}

sim::BallBarCircles circles_in_xy() {
  sim::BallBarCircles circles;
  circles.planes = {"XY"};
  circles.records_feed = true;
  return circles;
}

const ScanVariable& variable(const std::vector<ScanVariable>& variables, const std::string& name) {
  const auto found = std::ranges::find(variables, name, &ScanVariable::name);
  if (found == variables.end()) throw std::out_of_range(name);
  return *found;
}

/// On a circle the share along X is that of the radius along Y; a tracker's readings are taken at rest.
void expect_shares_of_motion(const LinearModel& model) {
  const std::vector<ScanVariable> variables = scan_variables(model);
  const ScanVariable& along_x = variable(variables, "speed_x");
  const ScanVariable& instrument = variable(variables, "instrument ball-bar");
  EXPECT_TRUE(instrument.two_valued);
  for (Eigen::Index i = 0; i < along_x.value.size(); ++i) {
    const auto& [of, row, channel] = model.observations()[static_cast<std::size_t>(i)];
    const Setup& setup = model.campaign().setups[of];
    const double share = along_x.centre + along_x.scale * along_x.value[i];
    const double of_ball_bar = instrument.centre + instrument.scale * instrument.value[i];
    EXPECT_NEAR(of_ball_bar, setup.instrument == "ball-bar" ? 1.0 : 0.0, 1e-9);
    if (setup.instrument != "ball-bar") {
      EXPECT_NEAR(share, 0.0, 1e-9);
      continue;
    }
    const Eigen::Vector3d radius = model.views()[of].nominal_point_w[row] - *setup.options.vector("centre");
    EXPECT_NEAR(std::abs(share), std::abs(radius.y()) / radius.norm(), 0.1);
    EXPECT_GE(share * setup.readings.direction[index_of(AxisName::X)][row], -0.1);
  }
}

/// What moves along circles is seen where the catalogue has no name for it.
TEST(Search, WhatCirclesShowIsSeenWithoutAName) {
  sim::HiddenEffect servo{.kind = "servo-mismatch", .options = {}, .rms = 1e-6};
  servo.options.set("axis", "X");
  sim::Study study = hiding({servo}, kGrid);
  study.measurements.emplace_back().settings = circles_in_xy();
  const FittedStudy fitted(study);
  expect_shares_of_motion(fitted.model);
  const Diagnosis diagnosis = searched(fitted, true, {"servo-mismatch", "following-error"});
  EXPECT_EQ(to_string(diagnosis.verdict), "UNKNOWN");
  ASSERT_FALSE(diagnosis.unknown.empty());
  EXPECT_THAT(names_of(diagnosis.unknown[0].variables),
              ::testing::Contains(::testing::AnyOf("speed_x", "speed_y", "dir_x", "dir_y")));
}

/// The shortest lag that is looked for explains nearly all of what follows a temperature at once.
TEST(Search, WhatFollowsATemperatureAtOnceIsNotSaidToFollowItLate) {
  sim::HiddenEffect tilt = hidden_beside("thermal-tilt", "EAZ", 5e-6);
  tilt.options.set("channel", "column");
  sim::Study campaign = hiding({tilt}, kGrid);
  campaign.environment.channels[0].amplitude = 1.0;
  FittedStudy study(campaign);
  SearchOptions options;
  options.leave_out = {"thermal-drift"};
  Search search(study.model, std::vector<bool>(study.model.size(), false), options);
  search.run();
  std::vector<std::pair<FindingCode, std::string>> reasons;
  for (const auto& [family, reason] : search.rejected()) {
    if (search.reached().setting().families[family].name().kind == "lagged-temperature")
      reasons.emplace_back(reason.code, reason.has("shape") ? reason.text("shape") : "");
  }
  EXPECT_THAT(reasons, ::testing::Contains(
                           std::pair(FindingCode::RejectedShapeBeyondScan, std::string("time constant"))));
  for (const AddedEffect& added : search.reached().added())
    EXPECT_NE(search.reached().setting().families[added.test.family].name().kind, "lagged-temperature");
}

/// On one circle correlated drift of a few seconds follows a servo mismatch as well as its own shape does.
TEST(Search, FindsWhatTheNoiseHasTakenUp) {
  sim::HiddenEffect servo{.kind = "servo-mismatch", .options = {}, .rms = 0.5e-6};
  servo.options.set("axis", "X");
  sim::Study study = hiding({servo}, kGrid);
  study.measurements.emplace_back().settings = circles_in_xy();
  const FittedStudy fitted(study);
  const NoiseEstimate noise = estimate_noise(fitted.model.problem());
  const auto ball_bar = std::ranges::find(fitted.model.noise_groups(), "ball-bar");
  ASSERT_NE(ball_bar, fitted.model.noise_groups().end());
  const auto group = static_cast<std::size_t>(ball_bar - fitted.model.noise_groups().begin());
  EXPECT_GT(noise.instruments[group].parameters.drift, 0.2e-6);
  EXPECT_THAT(kinds_and_targets(searched(fitted, true).effects), ::testing::ElementsAre("servo-mismatch XY"));
}

TEST(ScanVariables, OfAnEffect) {
  using Names = std::vector<std::string>;
  const auto names = [](const std::string& kind,
                        std::initializer_list<std::pair<std::string, OptionValue>> options) {
    return names_of(scan_variables_of(find_effect(kind)->make(effect_spec(kind, options), {})->name()));
  };
  EXPECT_EQ(names("position-reversal", {{"symbol", "EXX"}}), (Names{"dir_x", "x"}));
  EXPECT_EQ(names("tool-offset", {{"tool", "side x"}}), (Names{"tool side x"}));
  EXPECT_EQ(names("station-drift", {{"station", "P1"}}), (Names{"station P1", "time"}));
  EXPECT_EQ(names("tool-load", {{"symbol", "EAZ"}, {"tool", "long"}}), (Names{"tool long"}));
  EXPECT_EQ(names("tool-load", {{"symbol", "EAZ"}}), Names{}) << "of lengths there is no scan";
  EXPECT_EQ(names("spindle-growth", {}), (Names{"time"}));
  EXPECT_EQ(names("servo-mismatch", {{"axis", "Y"}, {"second_axis", "X"}}), (Names{"dir_x", "dir_y"}));
  EXPECT_EQ(names("servo-mismatch", {{"axis", "X"}, {"second_axis", "Y"}, {"by", "feed"}}),
            (Names{"dir_x", "dir_y", "feed"}));
  EXPECT_EQ(names("following-error", {{"axis", "X"}, {"by", "feed"}}), (Names{"dir_x", "feed"}));
  EXPECT_EQ(names("run-offset", {{"setup", "S1"}, {"run", 2.0}}), (Names{"run"}));
  EXPECT_EQ(names("ball-bar-length", {}), Names{"instrument ball-bar"});
  EXPECT_EQ(names("encoder-eccentricity", {{"encoder", "azimuth"}}), Names{});
  EXPECT_EQ(names("thermal-drift", {{"symbol", "EAZ"}, {"temperature", "front bearing"}}),
            Names{"T_front bearing"})
      << "a channel whose name has a blank";
  EXPECT_EQ(names("empirical", {{"target", "EXX"}, {"drivers", "t since_x"}}),
            (Names{"time", "travel since dir_x"}))
      << "as users write of them";
}

}  // namespace
}  // namespace volcal
