/// Plans against what a fit of a simulated campaign states, and what a plan must find.

#include "volcal/identify/planning/campaign_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/io/plan_writer.h"
#include "volcal/identify/planning/expected_effects.h"
#include "volcal/identify/report/text/plan_text.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

ModelSpec few_knots() {
  ModelSpec model;
  model.default_function.knots = KnotChoice::IntervalCount;
  model.default_function.intervals = 2;
  return model;
}

/// 500 x 400 x 330 mm, few readings: quick.
PlanSettings small_plan() {
  PlanSettings settings;
  settings.machine = sim::reference_machines()[3];
  settings.model = few_knots();
  settings.budget.readings = 360;
  settings.threads = 2;
  return settings;
}

sim::Study study_of(const PlanLayout& layout, const PlanSettings& settings) {
  sim::Tracking tracking;
  tracking.noise.constant = settings.noise.constant;
  tracking.noise.per_metre = settings.noise.per_metre;
  tracking.noise.repeatability = settings.noise.repeatability;
  for (std::size_t i = 0; i < layout.stations_w.size(); ++i)
    tracking.stations.push_back({layout.station_names[i], layout.stations_w[i]});
  for (const PlanRun& run : layout.runs) {
    tracking.runs.push_back({layout.station_names[run.station], settings.machine.tools[run.tool].name, {}});
    for (const PlanReading& reading : readings_of(run)) {
      sim::CommandedPoint point;
      point.position = reading.position;
      point.direction = reading.direction;
      point.line = reading.line;
      point.run = reading.run;
      tracking.runs.back().points.push_back(point);
    }
  }
  sim::Study study;
  study.machine = settings.machine;
  study.seed = 5;
  study.truth.perfect = true;  // outside no basis: chi2 is that of the noise
  study.measurements.emplace_back().settings = tracking;
  return study;
}

TEST(CampaignPlan, PredictsTheUncertaintyThatTheFitStates) {
  const PlanSettings settings = small_plan();
  const LineOfSight sight(settings);
  const PlanLayout layout = textbook_layout(settings, sight);
  const FitResult expected = expected_result(campaign_of(layout, settings), settings.model, {}, 1);
  FitOptions white;
  white.variance_components = false;
  white.noise = NoisePolicy::White;
  const sim::SimulatedCampaign simulated = sim::simulate(study_of(layout, settings));
  const FitResult fitted = fit(simulated.campaign, settings.model, white);
  ASSERT_EQ(expected.rank.errors.size(), fitted.rank.errors.size());
  for (std::size_t i = 0; i < fitted.rank.errors.size(); ++i) {
    const Observability &ours = expected.rank.errors[i], &theirs = fitted.rank.errors[i];
    EXPECT_EQ(ours.symbol, theirs.symbol);
    EXPECT_NEAR(ours.u_rms / theirs.u_rms, 1.0, 0.02) << ours.symbol.name();
    EXPECT_NEAR(ours.visible_fraction, theirs.visible_fraction, 0.02) << ours.symbol.name();
  }
  EXPECT_NEAR(volumetric_uncertainty(expected, settings.machine.tools, 4).rms /
                  volumetric_uncertainty(fitted, settings.machine.tools, 4).rms,
              1.0, 0.01);
}

/// Of least volumetric uncertainty; made once.
const CampaignPlan& volumetric_plan() {
  static const CampaignPlan plan = plan_campaign(small_plan(), nullptr);
  return plan;
}

/// What a diagnosis of another campaign has left in a model: laws and surfaces of temperatures and a feed,
/// what moved its stations.
std::vector<EffectSpec> effects_of_another_campaign() {
  return {
      effect_spec("custom", {{"target", std::string("EXX")},
                             {"expression", std::string("x * (T_air - 20)")},
                             {"amplitude", 1e-9}}),
      effect_spec("empirical", {{"target", std::string("EAY")},
                                {"drivers", std::string("y T_column")},
                                {"from", std::vector<double>{0.0, 18.0}},
                                {"to", std::vector<double>{400.0, 24.0}},
                                {"pieces", std::vector<double>{1.0, 1.0}}}),
      effect_spec("scale-expansion", {{"axis", std::string("Z")}, {"temperature", std::string("column")}}),
      effect_spec("custom", {{"target", std::string("EYY")}, {"expression", std::string("y * feed")}}),
      effect_spec("station-drift", {{"station", std::string("P9")}})};
}

TEST(CampaignPlan, TakesAsKnownWhatItsReadingsCannotShow) {
  PlanSettings settings = small_plan();
  settings.model.effects = effects_of_another_campaign();
  const CampaignPlan plan = plan_campaign(settings, nullptr);
  ASSERT_EQ(plan.findings.size(), 1u);
  const Finding& known = plan.findings.front();
  EXPECT_EQ(known.code, FindingCode::PlanEffectsKnown);
  EXPECT_EQ(known.texts("effects").size(), 5u);
  EXPECT_EQ(known.texts("columns"), (std::vector<std::string>{"T_air_degC", "T_column_degC", "feed_mm_min"}));
  EXPECT_THAT(plan_text(plan), HasSubstr("The plan takes as known, as the model states it: EXX by x * "));
  // With these known the others are as certain as in a model without.
  EXPECT_EQ(plan.plan.volumetric.rms, volumetric_plan().plan.volumetric.rms);
  EXPECT_THAT(volumetric_plan().findings, IsEmpty());
}

TEST(CampaignPlan, PlansForWhatItsReadingsShow) {
  const PlanSettings settings = small_plan();
  const Campaign planned = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
  ModelSpec model;
  model.effects = {
      effect_spec("reversal", {{"symbol", std::string("EXX")}}),
      effect_spec("custom", {{"target", std::string("EXX")}, {"expression", std::string("z * z")}})};
  EXPECT_FALSE(hold_effects_unseen(planned, model));
  EXPECT_EQ(model.effects.size(), 2u);
}

/// Beside the error motions, in the unit of its amplitude.
TEST(CampaignPlan, ListsTheAmplitudesThatItDetermines) {
  CampaignPlan plan;
  plan.settings = small_plan();
  plan.settings.model.effects = {effect_spec("position-reversal", {{"symbol", std::string("EXX")}})};
  const PlanLayout textbook = textbook_layout(plan.settings, LineOfSight(plan.settings));
  plan.textbook = expected_campaign("textbook", campaign_of(textbook, plan.settings), plan.settings, false);
  plan.plan = plan.textbook;
  plan.searched.layout = textbook;
  const Observability& amplitude = plan.plan.result.rank.errors.back();
  ASSERT_FALSE(amplitude.symbol.has_symbol());
  EXPECT_TRUE(amplitude.visible);
  EXPECT_EQ(amplitude.effective_parameters, 1.0);
  EXPECT_THAT(plan_text(plan), ::testing::ContainsRegex(amplitude.symbol.name() + " +um/m "));
  EXPECT_THAT(plan_json(plan), HasSubstr("\"unit\": \"um/m\""));
}

/// A mistake is none of these.
TEST(CampaignPlan, RefusesAnEffectOfAToolThatTheMachineLacks) {
  PlanSettings settings = small_plan();
  settings.model.effects = {
      effect_spec("custom", {{"target", std::string("tool lang z")}, {"expression", std::string("x")}})};
  EXPECT_THROW(plan_campaign(settings, nullptr), InputError);
}

TEST(CampaignPlan, BeatsTheTextbookWithinItsLimits) {
  const PlanSettings settings = small_plan();
  const CampaignPlan& plan = volumetric_plan();
  EXPECT_LT(plan.plan.volumetric.rms, 0.85 * plan.textbook.volumetric.rms);
  EXPECT_LE(plan.plan.campaign.reading_count(), 360U);
  EXPECT_EQ(plan.searched.layout.stations_w.size(), 4U);
  EXPECT_THAT(plan.plan.invisible(), IsEmpty());
  const LineOfSight sight(settings);
  for (const Eigen::Vector3d& station : plan.searched.layout.stations_w)
    EXPECT_TRUE(sight.can_stand(station));
  for (const PlanRun& run : plan.searched.layout.runs) {
    for (const PlanPosition& each : run.positions) {
      EXPECT_TRUE(sight.sees(plan.searched.layout.stations_w[run.station], each.position, run.tool));
      for (const Axis& axis : settings.machine.axes) {
        EXPECT_GE(each.position[index_of(axis.name)], axis.travel_min);
        EXPECT_LE(each.position[index_of(axis.name)], axis.travel_max);
      }
    }
  }
  EXPECT_FALSE(plan.plan.detectable.empty());
}

/// A search's plan as sure as the textbook's times a factor, whose first station stands elsewhere.
CampaignPlan plan_beside_textbook(const PlanLayout& textbook, double factor) {
  CampaignPlan plan;
  plan.settings = small_plan();
  plan.textbook = expected_campaign("textbook", campaign_of(textbook, plan.settings), plan.settings, false);
  plan.plan = plan.textbook;
  plan.plan.name = "plan";
  plan.plan.target_u = factor * plan.textbook.target_u;
  plan.searched.layout = textbook;
  plan.searched.layout.stations_w.front().x() += 0.2;
  plan.searched.station_tolerance = {0.1};
  return plan;
}

TEST(CampaignPlan, KeepsTheTextbookWhereThatIsSurer) {
  const PlanSettings settings = small_plan();
  const PlanLayout textbook = textbook_layout(settings, LineOfSight(settings));
  CampaignPlan surer = plan_beside_textbook(textbook, 0.9);
  keep_the_surer(textbook, surer);
  EXPECT_FALSE(surer.replaced);
  EXPECT_EQ(replaced_words(surer), "");
  EXPECT_NE(surer.searched.layout.stations_w, textbook.stations_w);

  CampaignPlan plan = plan_beside_textbook(textbook, 1.29);
  keep_the_surer(textbook, plan);
  ASSERT_TRUE(plan.replaced);
  EXPECT_NEAR(plan.replaced->target_ratio, 1.29, 1e-9);
  EXPECT_EQ(
      replaced_words(plan),
      "The plan is the textbook layout. What the search found: volumetric uncertainty, RMS of the vector, "
      "29.0 % more.");
  EXPECT_EQ(plan.searched.layout.stations_w, textbook.stations_w);
  EXPECT_EQ(plan.plan.name, "plan");
  EXPECT_EQ(plan.plan.target_u, plan.textbook.target_u);
  EXPECT_TRUE(plan.searched.station_tolerance.empty()) << "it holds for the other stations";
}

/// A plan for one error may give others up, one for the whole volume may not.
TEST(CampaignPlan, KeepsTheTextbookWhereTheSearchLosesAnError) {
  const PlanSettings settings = small_plan();
  const PlanLayout textbook = textbook_layout(settings, LineOfSight(settings));
  CampaignPlan plan = plan_beside_textbook(textbook, 0.9);
  Observability& lost = plan.plan.result.rank.errors.front();
  lost.visible = false;
  CampaignPlan of_one_error = plan;
  of_one_error.settings.target = PlanTarget::Symbol;
  of_one_error.settings.symbol = MachineError::parse("EC0Y");
  const std::string symbol = lost.symbol.name();
  keep_the_surer(textbook, plan);
  ASSERT_TRUE(plan.replaced);
  EXPECT_LT(plan.replaced->target_ratio, 1.0);
  EXPECT_THAT(replaced_words(plan), ::testing::HasSubstr("10.0 % less; " + symbol + " not determined."));
  EXPECT_THAT(plan.plan.invisible(), IsEmpty());
  keep_the_surer(textbook, of_one_error);
  EXPECT_FALSE(of_one_error.replaced);

  CampaignPlan neither = plan_beside_textbook(textbook, 0.9);
  neither.plan.result.rank.errors[0].visible = neither.plan.result.rank.errors[1].visible = false;
  neither.textbook.result.rank.errors[0].visible = false;
  keep_the_surer(textbook, neither);
  EXPECT_FALSE(neither.replaced) << "neither determines all: the surer of the target is the plan";
}

TEST(CampaignPlan, KeepsToTheTimeAndDoesNotDependOnThreads) {
  PlanSettings one = small_plan();
  one.budget.readings.reset();
  one.budget.time = 2.5 * 3600.0;
  PlanSettings three = one;
  one.threads = 1;
  three.threads = 3;
  const auto searched_layout = [](const PlanSettings& settings) {
    return search_plan(settings, PlanProblem(settings), LineOfSight(settings)).layout;
  };
  const PlanLayout a = searched_layout(one), b = searched_layout(three);
  EXPECT_LE(duration(a, one), 2.5 * 3600.0);
  EXPECT_GT(duration(a, one), 2.0 * 3600.0);
  ASSERT_EQ(a.runs.size(), b.runs.size());
  for (std::size_t i = 0; i < a.stations_w.size(); ++i) EXPECT_EQ(a.stations_w[i], b.stations_w[i]);
  for (std::size_t r = 0; r < a.runs.size(); ++r) {
    ASSERT_EQ(a.runs[r].positions.size(), b.runs[r].positions.size());
    for (std::size_t k = 0; k < a.runs[r].positions.size(); ++k)
      EXPECT_EQ(a.runs[r].positions[k].position, b.runs[r].positions[k].position);
  }
}

/// The hours carry the stations and all runs but one, and no reading then.
TEST(CampaignPlan, DropsTheRunsThatTheTimeDoesNotCarry) {
  PlanSettings settings = small_plan();
  settings.budget.readings.reset();
  const std::size_t all = 4 * settings.machine.tools.size();
  settings.budget.time = 4.0 * settings.costs.station + settings.costs.run * static_cast<double>(all) - 60.0;
  const SearchedPlan found = search_plan(settings, PlanProblem(settings), LineOfSight(settings));
  EXPECT_GE(found.layout.runs.size(), 4U);
  EXPECT_LT(found.layout.runs.size(), all);
  EXPECT_GE(found.layout.positions(), found.layout.runs.size());
  EXPECT_LE(duration(found.layout, settings), *settings.budget.time);
}

TEST(CampaignPlan, NoReadingsShowNoEffect) { EXPECT_THAT(expected_detectable({}, {}, 1), IsEmpty()); }

/// One tool on the spindle axis leaves a roll invisible, so that options are looked for.
TEST(CampaignPlan, IsKeptWhereItsOptionsAreNotWanted) {
  PlanSettings settings = small_plan();
  settings.machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0}};
  settings.progress = [](const std::string& stage, double /*done*/) {
    if (stage == kLookingForOptions) throw OptionsNotWanted();
  };
  const CampaignPlan plan = plan_campaign(settings, nullptr);
  EXPECT_GT(plan.plan.campaign.reading_count(), 0U);
  EXPECT_THAT(names_of(plan.plan.invisible()), Contains("ECZ"));
  EXPECT_THAT(plan.options, IsEmpty());
  ASSERT_EQ(plan.findings.size(), 1U);
  EXPECT_EQ(plan.findings.front().code, FindingCode::PlanOptionsLeft);
  // What is not visible has no number of parameters, of a function no more than of U.
  for (const Observability& error : plan.plan.result.rank.errors)
    EXPECT_EQ(std::isnan(error.effective_parameters), !error.visible) << error.symbol.name();
}

TEST(CampaignPlan, MinimisesTheErrorThatIsNamed) {
  PlanSettings settings = small_plan();
  settings.target = PlanTarget::Symbol;
  settings.symbol = MachineError::parse("EXX");
  const CampaignPlan named = plan_campaign(settings, nullptr);
  EXPECT_LT(named.plan.target_u, named.textbook.target_u);
  const auto u_of = [](const CampaignPlan& plan) {
    for (const Observability& error : plan.plan.result.rank.errors) {
      if (error.symbol.name() == "EXX") return error.u_rms;
    }
    return std::nan("");
  };
  EXPECT_LT(u_of(named), u_of(volumetric_plan()));
  settings.symbol = MachineError::parse("EXA");
  EXPECT_THROW(plan_campaign(settings, nullptr), InputError);
}

/// One tool on the spindle axis leaves the roll of the last axis invisible (docs/notation.md): only a
/// sideways tool shows it.
TEST(CampaignPlan, FindsTheToolThatMakesARollVisible) {
  PlanSettings settings = small_plan();
  settings.machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0}};
  const LineOfSight sight(settings);
  const Campaign measured = campaign_of(textbook_layout(settings, sight), settings);
  const ExpectedCampaign before = expected_campaign("given", measured, settings, false);
  ASSERT_THAT(names_of(before.invisible()), Contains("ECZ"));
  settings.existing = &measured;
  settings.budget.stations = 1;
  settings.budget.readings = 120;
  const CampaignPlan plan = extend_campaign(settings);
  EXPECT_THAT(names_of(plan.plan.invisible()), Not(Contains("ECZ")));
  ASSERT_FALSE(plan.options.empty());
  EXPECT_TRUE(plan.options.front().new_tool);
  EXPECT_THAT(names_of(plan.options.front().made_visible), Contains("ECZ"));
  EXPECT_EQ(plan.settings.machine.tools.size(), 2U);
  EXPECT_GT(std::abs(plan.settings.machine.tools.back().offset.x()) +
                std::abs(plan.settings.machine.tools.back().offset.y()),
            0.05);
}

/// From two stations several errors cannot be separated from where the stations stand; the plan asks for a
/// third.
TEST(CampaignPlan, FindsTheStationThatIsMissing) {
  PlanSettings settings = small_plan();
  settings.budget.stations = 2;
  const LineOfSight sight(settings);
  const Campaign measured = campaign_of(textbook_layout(settings, sight), settings);
  const std::size_t hidden = expected_campaign("given", measured, settings, false).invisible().size();
  ASSERT_GT(hidden, 0U);
  settings.existing = &measured;
  settings.budget.readings = 240;
  const CampaignPlan plan = extend_campaign(settings);
  EXPECT_LT(plan.plan.invisible().size(), hidden);
  EXPECT_TRUE(plan.options.front().new_station);
  // Best first is by what the table shows: what stays invisible, then the uncertainty in the volume.
  ASSERT_GT(plan.options.size(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(plan.options, {}, [](const PlanOption& option) {
    return std::pair(option.still_invisible.size(), option.volumetric_rms);
  }));
}

TEST(CampaignPlan, RefusesWhatMakesNoPlan) {
  PlanSettings settings = small_plan();
  settings.budget.readings.reset();
  EXPECT_THROW(plan_campaign(settings, nullptr), InputError);
  settings = small_plan();
  settings.machine.tools.clear();
  EXPECT_THROW(plan_campaign(settings, nullptr), InputError);
  settings = small_plan();
  settings.budget.tool_count = 7;
  EXPECT_THROW(plan_campaign(settings, nullptr), InputError);
  settings = small_plan();
  settings.budget.tools = {0, 0};
  EXPECT_THROW(check_plan_settings(settings), InputError);
  settings = small_plan();
  settings.noise = {0.0, 0.0, 0.0, 1e-6};
  EXPECT_THROW(check_plan_settings(settings), InputError);
  settings = small_plan();
  settings.surroundings.stations_w =
      Eigen::AlignedBox3d(Eigen::Vector3d(0.2, 0.2, 0.0), Eigen::Vector3d(0.3, 0.3, 0.1));
  EXPECT_THROW(plan_campaign(settings, nullptr), InputError);
}

}  // namespace
}  // namespace volcal
