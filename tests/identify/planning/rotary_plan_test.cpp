/// Plans for machines with rotary axes: what a plan can see by ranks of exact transforms, which know nothing
/// of the model, and what a plan states against what a fit of its simulated readings states.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "tests/support/five_axis.h"
#include "tests/support/refusal.h"
#include "tests/support/singular_values.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/planning/plan_options.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_support::five_axis_machine;
using testing_support::five_axis_truth;
using testing_support::state_of;

const char* const kStructures[] = {"w C' A' b X Y Z t", "w X' b Y Z C B t", "w C' X' b Y Z B t",
                                   "w C' B' b X Y Z t"};

PlanSettings sphere_plan(const std::string& structure) {
  PlanSettings settings;
  settings.machine = five_axis_machine(structure);
  settings.instrument = "r-test";
  settings.linear_axes_known = true;
  settings.model = with_known_linear_axes({}, settings.machine);
  settings.surroundings.stations_w =
      Eigen::AlignedBox3d(Eigen::Vector3d(-0.12, -0.12, 0.0), Eigen::Vector3d(0.12, 0.12, 0.1));
  settings.budget.stations = 3;
  settings.budget.readings = 720;
  settings.threads = 2;
  return settings;
}

/// Sets one of fifteen constants: six of every rotary axis and three of squareness.
using SetConstant = std::function<void(sim::TruthMachine&, double)>;

std::vector<SetConstant> constants_of(const Machine& machine) {
  std::vector<SetConstant> all;
  for (const LocationSymbol symbol : squareness_errors(machine))
    all.emplace_back([=](sim::TruthMachine& truth, double value) { truth.set_location(symbol, value); });
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      all.emplace_back([=](sim::TruthMachine& truth, double value) {
        truth.set_error(symbol, [=](double) { return value; });
      });
    }
  }
  return all;
}

/// Rank of what the columns add to those of the nuisance.
int rank_beyond(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& nuisance) {
  const auto rank = [](Eigen::MatrixXd matrix) {
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      const double norm = matrix.col(k).norm();
      if (norm > 1e-9) matrix.col(k) /= norm;
    }
    const Eigen::VectorXd values = testing::singular_values(matrix);
    return static_cast<int>((values.array() > 1e-4 * values[0]).count());
  };
  Eigen::MatrixXd both(columns.rows(), columns.cols() + nuisance.cols());
  both << columns, nuisance;
  return rank(both) - rank(nuisance);
}

/// A column per error by central differences of exact transforms: three rows a reading of an R-test.
Eigen::MatrixXd exact_columns(const Campaign& campaign, const std::vector<SetConstant>& errors) {
  constexpr double kErrorStep = 1e-4;
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(campaign.reading_count()),  // three values a pose
                          static_cast<Eigen::Index>(errors.size()));
  for (std::size_t e = 0; e < errors.size(); ++e) {
    sim::TruthMachine plus(campaign.machine), minus(campaign.machine);
    errors[e](plus, kErrorStep);
    errors[e](minus, -kErrorStep);
    Eigen::Index row = 0;
    for (const Setup& setup : campaign.setups) {
      const Eigen::Vector3d offset = campaign.machine.tools[setup.tool].offset;
      for (std::size_t i = 0; i < setup.readings.size(); ++i, row += 3) {
        AxisPosition position{};
        for (const Axis& axis : campaign.machine.axes)
          position[index_of(axis.name)] = setup.readings.position[index_of(axis.name)][i];
        const sim::MachineState state = state_of(position, setup.tool);
        columns.block<3, 1>(row, static_cast<Eigen::Index>(e)) =
            (plus.point_error(state, offset) - minus.point_error(state, offset)) / (2.0 * kErrorStep);
      }
    }
  }
  return columns;
}

/// Offsets of the spheres, and of the tools where they are unknown.
Eigen::MatrixXd nuisance_columns(const Campaign& campaign, bool tools_known) {
  std::map<std::string, Eigen::Index> spheres;
  for (const Setup& setup : campaign.setups)
    spheres.try_emplace(*setup.options.text("sphere"), 3 * static_cast<Eigen::Index>(spheres.size()));
  const auto of_spheres = 3 * static_cast<Eigen::Index>(spheres.size());
  const auto of_tools = tools_known ? 0 : 3 * static_cast<Eigen::Index>(campaign.machine.tools.size());
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(campaign.reading_count()), of_spheres + of_tools);
  const KinematicChain chain(campaign.machine);
  Eigen::Index row = 0;
  for (const Setup& setup : campaign.setups) {
    const Eigen::Vector3d offset = campaign.machine.tools[setup.tool].offset;
    for (std::size_t i = 0; i < setup.readings.size(); ++i, row += 3) {
      columns.block<3, 3>(row, spheres.at(*setup.options.text("sphere"))).setIdentity();
      if (tools_known) continue;
      AxisPosition position{};
      for (const Axis& axis : campaign.machine.axes)
        position[index_of(axis.name)] = setup.readings.position[index_of(axis.name)][i];
      const Eigen::Vector3d at_w = chain.nominal_point_w(position, offset);
      for (int k = 0; k < 3; ++k) {
        columns.block<3, 1>(row, of_spheres + 3 * static_cast<Eigen::Index>(setup.tool) + k) =
            chain.nominal_point_w(position, offset + Eigen::Vector3d::Unit(k)) - at_w;
      }
    }
  }
  return columns;
}

int constants_seen(const Campaign& campaign, bool tools_known) {
  return rank_beyond(exact_columns(campaign, constants_of(campaign.machine)),
                     nuisance_columns(campaign, tools_known));
}

/// One sphere and one tool, one axis after another.
Campaign one_sphere_singly(const PlanSettings& settings) {
  PlanLayout layout;
  layout.stations_w = {{0.1, 0.02, 0.05}};
  layout.station_names = {"P1"};
  const SweptVolume swept(settings);
  PlanRun run{0, 0, {}};
  for (const RotaryStretch& stretch : rotary_stretches(settings.machine)) {
    for (int i = 0; i < 8; ++i) {
      AxisPosition rotary = home_position(settings.machine);
      rotary[index_of(stretch.axis)] = stretch.node(i, 8);
      run.positions.push_back({swept.position_at(layout.stations_w[0], 0, rotary).value(), {i, 0, 0}});
    }
  }
  layout.runs = {run};
  return campaign_of(layout, settings, false);
}

/// Of 15 constants, with unknown places of the spheres: 10 or 11 with known tools, 8 with unknown ones, which
/// is all that a machine has beside the frames of workpiece and tool; 4 to 7 with
/// what a probing cycle does.
TEST(RotaryPlan, SeesWhatCanBeSeenWithThreeSpheresThreeToolsAndAllCombinations) {
  const int of_known_tools[] = {11, 10, 10, 11};
  for (std::size_t i = 0; i < std::size(kStructures); ++i) {
    PlanSettings settings = sphere_plan(kStructures[i]);
    settings.budget.readings = 360;
    const LineOfSight sight(settings);
    PlanLayout layout = textbook_layout(settings, sight);
    double height = 0.02;
    for (Eigen::Vector3d& sphere_w : layout.stations_w) sphere_w.z() = height += 0.03;
    for (PlanRun& run : layout.runs) run = sight.moved(layout.stations_w[run.station], run);
    const Campaign campaign = campaign_of(layout, settings, false);
    EXPECT_EQ(constants_seen(campaign, true), of_known_tools[i]) << kStructures[i];
    EXPECT_EQ(constants_seen(campaign, false), 8) << kStructures[i];
    const int singly = constants_seen(one_sphere_singly(settings), false);
    EXPECT_GE(singly, 4) << kStructures[i];
    EXPECT_LE(singly, 7) << kStructures[i];
  }
}

/// A head with tools on the spindle's axis alone sees less of it than with one beside it, and with one length
/// less still.
TEST(RotaryPlan, HeadsNeedTwoLengthsAndALateralOffset) {
  PlanSettings settings = sphere_plan("w X' b Y Z C B t");
  settings.budget.readings = 360;
  const auto seen_with = [&](std::vector<std::size_t> tools) {
    settings.budget.tools = std::move(tools);
    // Every error motion by itself: constants, and three harmonics of the rolls of both axes.
    std::vector<SetConstant> errors = constants_of(settings.machine);
    for (const AxisName axis : {AxisName::C, AxisName::B}) {
      for (const Component component : kAllComponents) {
        for (int wave = 1; wave <= 3; ++wave) {
          for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
            errors.emplace_back([=](sim::TruthMachine& truth, double value) {
              truth.set_error({component, axis},
                              [=](double q) { return value * std::sin(wave * q + phase); });
            });
          }
        }
      }
    }
    const Campaign campaign = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings, false);
    return rank_beyond(exact_columns(campaign, errors), nuisance_columns(campaign, true));
  };
  const int one_length = seen_with({0}), two_lengths = seen_with({0, 1}), lateral = seen_with({0, 1, 2});
  EXPECT_LT(one_length, two_lengths);
  EXPECT_LT(two_lengths, lateral);
}

/// The tool stays on the sphere, by transforms of the simulator, and within the travel; every combination of
/// both axes is met.
TEST(RotaryPlan, StaysOnTheSphere) {
  for (const char* structure : kStructures) {
    const PlanSettings settings = sphere_plan(structure);
    const sim::TruthMachine nominal(settings.machine);
    const Eigen::Vector3d sphere_w(0.08, -0.05, 0.06);
    const LineOfSight sight(settings);
    for (std::size_t tool = 0; tool < settings.machine.tools.size(); ++tool) {
      const PlanRun run = sight.candidate_runs(sphere_w, 0, tool, {96, 0.0, 1}).front();
      ASSERT_GT(run.positions.size(), 80U) << structure;
      for (const PlanPosition& each : run.positions) {
        const Eigen::Vector3d point_w =
            nominal.nominal_point(state_of(each.position, tool), settings.machine.tools[tool].offset);
        EXPECT_LT((point_w - sphere_w).norm(), 2e-6) << structure;
        for (const Axis& axis : settings.machine.axes) {
          EXPECT_GE(each.position[index_of(axis.name)], axis.travel_min);
          EXPECT_LE(each.position[index_of(axis.name)], axis.travel_max);
        }
      }
    }
  }
}

/// C turns 360 degrees, A 240: of 96 positions 12 and 8.
TEST(RotaryGrid, HasCountsInProportionToTheTravel) {
  const Machine machine = five_axis_machine("w C' A' b X Y Z t");
  const std::vector<PlanPosition> grid = rotary_grid(machine, 96, 0.0, 1, 1);
  ASSERT_EQ(grid.size(), 96U);
  std::set<double> turns, tilts;
  for (const PlanPosition& each : grid) {
    turns.insert(each.position[index_of(AxisName::C)]);
    tilts.insert(each.position[index_of(AxisName::A)]);
  }
  EXPECT_EQ(turns.size(), 12U);
  EXPECT_EQ(tilts.size(), 8U);
  EXPECT_NEAR(*turns.begin(), -std::numbers::pi, 1e-12) << "a whole turn: its end is its start";
  EXPECT_NEAR(*turns.rbegin(), std::numbers::pi * 5.0 / 6.0, 1e-12);
  EXPECT_NEAR(*tilts.rbegin(), std::numbers::pi * 2.0 / 3.0, 1e-3);
}

TEST(RotaryPlan, PredictsTheUncertaintyThatTheFitStates) {
  PlanSettings settings = sphere_plan("w C' A' b X Y Z t");
  settings.noise = {1.5e-6, 0.0, 0.0, 1e-6};
  // Functions without a smoothing prior, whose strength readings would tell.
  for (const Axis& axis : settings.machine.axes) {
    if (!is_rotary(axis.name)) continue;
    FunctionSpec function;
    function.basis = axis.name == AxisName::C ? "fourier" : "legendre";
    function.degree = 3;
    for (const Component component : kAllComponents)
      settings.model.functions[{component, axis.name}] = function;
  }
  Campaign campaign = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
  const FitResult expected = expected_result(campaign, settings.model, {}, 1);
  std::mt19937_64 random(3);
  for (volcal::Setup& setup : campaign.setups) {
    for (auto& channel : setup.readings.value) {
      for (double& value : channel) value = testing_support::normal(random, 1.5e-6);
    }
  }
  FitOptions white;
  white.variance_components = false;
  white.noise = NoisePolicy::White;
  const FitResult fitted = fit(campaign, settings.model, white);
  ASSERT_EQ(expected.rank.errors.size(), fitted.rank.errors.size());
  for (std::size_t i = 0; i < fitted.rank.errors.size(); ++i) {
    const Observability &ours = expected.rank.errors[i], &theirs = fitted.rank.errors[i];
    EXPECT_EQ(ours.symbol, theirs.symbol);
    EXPECT_EQ(ours.visible, theirs.visible) << ours.symbol.name();
    EXPECT_NEAR(ours.u_rms / theirs.u_rms, 1.0, 0.02) << ours.symbol.name();
  }
}

TEST(RotaryPlan, BeatsTheTextbookAndSeesEveryError) {
  const PlanSettings settings = sphere_plan("w C' A' b X Y Z t");
  const CampaignPlan plan = plan_campaign(settings, nullptr);
  EXPECT_THAT(plan.plan.invisible(), IsEmpty());
  EXPECT_LT(plan.plan.volumetric.rms, plan.textbook.volumetric.rms);
  EXPECT_LE(plan.searched.layout.readings(), 720U);
  EXPECT_EQ(plan.searched.layout.stations_w.size(), 3U);
  const LineOfSight sight(settings);
  for (const PlanRun& run : plan.searched.layout.runs) {
    const Eigen::Vector3d& sphere_w = plan.searched.layout.stations_w[run.station];
    EXPECT_TRUE(sight.can_stand(sphere_w));
    for (const PlanPosition& each : run.positions) EXPECT_TRUE(sight.sees(sphere_w, each.position, run.tool));
  }
}

/// One sphere and one tool, and what one setup more would bring.
struct SmallCampaign {
  PlanSettings settings;
  Campaign campaign;
  ExpectedCampaign now;
};

SmallCampaign one_small_setup(const std::string& structure) {
  PlanSettings settings = sphere_plan(structure);
  settings.budget.stations = 1;
  settings.budget.readings = 60;
  settings.budget.tools = {0};
  const Campaign campaign = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
  return {settings, campaign, expected_campaign("now", campaign, settings, false)};
}

std::vector<PlanOption> options_of(SmallCampaign& small) {
  small.settings.existing = &small.campaign;
  return setup_options(small.settings, small.now).options;
}

TEST(RotaryPlan, NewSpheresStandApartFromTheOneThatThereIs) {
  SmallCampaign small = one_small_setup("w C' A' b X Y Z t");
  const LineOfSight sight(small.settings);
  const Eigen::Vector3d there_w = sight.textbook_stations_w(1).front();
  std::size_t spheres = 0;
  for (const PlanOption& option : options_of(small)) {
    if (!option.new_station) continue;
    ++spheres;
    const auto place = option.what.data.at("new_place");
    const auto& at = std::get<std::vector<FindingNumber>>(place);
    EXPECT_GE((Eigen::Vector3d(at[0].si, at[1].si, at[2].si) - there_w).norm(), 0.03);
  }
  EXPECT_GT(spheres, 0U);
}

/// More readings take nothing away, where the rank analysis of all of them says otherwise, too: here of
/// errors that one sphere and one tool do not tell, and that are said to be visible.
TEST(RotaryPlan, WhatIsVisibleStaysSo) {
  SmallCampaign small = one_small_setup("w C' A' b X Y Z t");
  ASSERT_GT(small.now.invisible().size(), 5U);
  for (Observability& error : small.now.result.rank.errors) error.visible = true;
  for (const PlanOption& option : options_of(small)) EXPECT_THAT(option.still_invisible, IsEmpty());
}

/// A cube of 20 mm holds no two places 30 mm apart.
TEST(RotaryPlan, RefusesSpheresThatWouldBeOne) {
  PlanSettings settings = sphere_plan("w C' A' b X Y Z t");
  settings.budget.readings = 120;
  settings.surroundings.stations_w =
      Eigen::AlignedBox3d(Eigen::Vector3d(0.08, 0.0, 0.05), Eigen::Vector3d(0.1, 0.02, 0.07));
  EXPECT_THAT(testing::refusal([&] { plan_campaign(settings, nullptr); }),
              HasSubstr("3 spheres have no room 30 mm apart where spheres may stand"));
  settings.budget.stations = 1;
  EXPECT_EQ(plan_campaign(settings, nullptr).searched.layout.stations_w.size(), 1U);
}

TEST(RotaryPlan, RefusesMachinesWithoutRotaryAxes) {
  PlanSettings settings = sphere_plan("w b X Y Z t");
  EXPECT_THROW(check_plan_settings(settings), InputError);
}

}  // namespace
}  // namespace volcal
