// The error at a pose, whoever asks for it: the measurement model on probed points, the field, its
// derivatives, its contributions, grids, tables and compensations, with every registered effect.

#include "volcal/identify/errors/error_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/effect_results.h"
#include "tests/support/error_oracles.h"
#include "tests/support/random_matrix.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/error_grid.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/identify/montecarlo/quantities.h"
#include "volcal/identify/program/program_errors.h"
#include "volcal/identify/report/values/volume_error.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::effect_campaign;
using testing_support::model_with;
using testing_support::Poses;
using testing_support::random_poses;
using testing_support::result_of_model;
using testing_support::uniform;

constexpr double kSame = 1e-12;  // m or rad

Conditions conditions_somewhere() {
  Conditions conditions;
  conditions.temperature_degC = {{"air", 21.3}, {"spindle", 23.9}};
  conditions.time = 4321.0;
  conditions.feed = 0.012;
  return conditions;
}

/// Points probed under constant conditions, behind the readings that the result was identified from.
Setup probed_points(const Machine& machine, std::size_t tool, const std::vector<AxisPosition>& positions,
                    const std::vector<ApproachDirection>& directions, const Conditions& conditions) {
  Setup setup;
  setup.name = "probed";
  setup.instrument = "volumetric-points";
  setup.tool = tool;
  setup.options.set("alignment", std::string("none"));
  setup.noise.set("constant", 1e-6);
  setup.has_noise = true;
  Readings& readings = setup.readings;
  for (const Axis& axis : machine.axes) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      readings.position[index_of(axis.name)].push_back(positions[i][index_of(axis.name)]);
      readings.direction[index_of(axis.name)].push_back(directions[i][index_of(axis.name)]);
    }
  }
  readings.time.assign(positions.size(), *conditions.time);
  readings.feed.assign(positions.size(), *conditions.feed);
  for (const auto& [channel, value] : conditions.temperature_degC)
    readings.temperature[channel].assign(positions.size(), value);
  readings.value.assign(3, std::vector<double>(positions.size(), 0.0));
  for (std::size_t i = 0; i < positions.size(); ++i)
    readings.source_line.push_back(static_cast<std::int64_t>(i) + 2);
  return setup;
}

/// A pose has no history: a lag has ended in the stated temperature, which no longer changes, and an axis has
/// travelled far since it turned, where readings in time have it still underway.
bool is_late(const EffectSpec& spec) {
  return spec.kind.starts_with("lagged") || spec.kind.ends_with("temperature-rate") ||
         spec.kind == "pre-travel";
}

bool acts_on_machine(const Effect& effect) {
  return std::ranges::any_of(effect.amplitudes(), [](const EffectAmplitude& amplitude) {
    return amplitude.target.kind == TargetKind::Motion || amplitude.target.kind == TargetKind::ToolOffset;
  });
}

/// Every effect of the catalogue that acts on the machine, one result each.
template <class Use>
void for_each_effect(const std::string& structure, const Use& use) {
  std::mt19937_64 random(20);
  const Campaign campaign = effect_campaign(structure);
  std::set<std::string> kinds;
  int done = 0;
  for (const EffectKind* kind : effect_kinds()) {
    int of_kind = 0;
    for (const EffectSpec& spec : kind->examples(campaign)) {
      if (!acts_on_machine(*kind->make(spec, "")) || ++of_kind > 3) continue;
      const MeasurementModel model(campaign, model_with(spec));
      use(campaign, spec, result_of_model(model, random), random);
      kinds.insert(spec.kind);
      ++done;
    }
  }
  EXPECT_GE(kinds.size(), 14U);
  EXPECT_GE(done, 30);
}

TEST(ErrorField, IsWhatProbedPointsOfTheMeasurementModelRead) {
  const Conditions conditions = conditions_somewhere();
  for (const char* structure : {"w X' b Y Z t", "w Y' X' b Z t", "w C' A' X' b Y Z t"}) {
    for_each_effect(structure, [&](const Campaign& campaign, const EffectSpec& spec, const FitResult& result,
                                   std::mt19937_64& random) {
      if (is_late(spec)) return;
      const Poses poses = random_poses(result.machine, random, 20);
      for (std::size_t tool = 0; tool < 2; ++tool) {
        Campaign probed = campaign;
        probed.setups.push_back(
            probed_points(result.machine, tool, poses.positions, poses.directions, conditions));
        const MeasurementModel model(probed, result.identified);
        const ErrorField field(result, result.machine.tools[tool], conditions);
        const KinematicChain chain(result.machine);
        Eigen::VectorXd parameters = model.initial_parameters();
        parameters.head(result.parameters.size()) = result.parameters;
        for (std::size_t i = 0; i < poses.positions.size(); ++i) {
          double read[kMaxChannels];
          model.predict(probed.setups.size() - 1, i, parameters, read);
          const PoseErrorVector error = field.at(poses.positions[i], poses.directions[i]);
          for (int k = 0; k < 3; ++k)
            ASSERT_NEAR(error[k], read[k], kSame) << spec.kind << " " << structure << " tool " << tool;
        }
      }
    });
  }
}

TEST(ErrorField, EveryWayToAskGivesTheSameError) {
  const Conditions conditions = conditions_somewhere();
  for_each_effect("w X' b Y Z t", [&](const Campaign&, const EffectSpec& spec, const FitResult& result,
                                      std::mt19937_64& random) {
    const Poses poses = random_poses(result.machine, random, 10);
    for (const Tool& tool : result.machine.tools) {
      const ErrorField field(result, tool, conditions);
      const DisplacementField fast = displacement_field(result, tool, conditions);
      const DisplacementField plain = testing::plain_displacement_field(result, tool, conditions);
      const ProgramErrors program = program_errors(result, tool.name, conditions);
      const DisplacementField of_program = program.field(tool.offset);
      const std::vector<Contribution> parts = field.contributions();
      for (std::size_t i = 0; i < poses.positions.size(); ++i) {
        const AxisPosition& position = poses.positions[i];
        const ApproachDirection& direction = poses.directions[i];
        const PoseErrorVector error = field.at(position, direction);
        const Vector3d displacement = error.head<3>();
        EXPECT_LT((fast(position, direction) - displacement).norm(), kSame) << spec.kind;
        EXPECT_LT((plain(position, direction) - displacement).norm(), kSame) << spec.kind;
        EXPECT_LT((of_program(position, direction) - displacement).norm(), kSame) << spec.kind;
        PoseErrorVector sum = PoseErrorVector::Zero();
        for (const Contribution& part : parts) sum += field.contribution(part, position, direction);
        EXPECT_LT((sum - error).norm(), kSame) << spec.kind;
        const VolumetricError stated = volumetric_error(result, field, position, tool, direction);
        EXPECT_LT((stated.value - error).norm(), kSame) << spec.kind;
      }
    }
  });
}

TEST(ErrorField, GridsAreTheFieldAtTheirNodesWithItsUncertainty) {
  const Conditions conditions = conditions_somewhere();
  for_each_effect("w X' b Y Z t", [&](const Campaign&, const EffectSpec& spec, const FitResult& result,
                                      std::mt19937_64&) {
    const std::vector<VolumetricError> grid = testing::volumetric_grid(result, 3, conditions);
    std::size_t i = 0;
    for (const Tool& tool : result.machine.tools) {
      const ErrorField field(result, tool, conditions);
      std::vector<Covariance3> covariances =
          ErrorGrid(result, tool, axis_grid(result.machine, 3), conditions).displacement_covariances();
      for (std::size_t node = 0; node < 27; ++node, ++i) {
        const VolumetricError plain = volumetric_error(result, field, grid[i].position, tool);
        ASSERT_LT((grid[i].value - plain.value).norm(), kSame) << spec.kind;
        ASSERT_LT((grid[i].u - plain.u).norm(), 1e-9 * plain.u.norm()) << spec.kind;
        const Eigen::Vector3d u = covariances[node].variances().cwiseSqrt();
        ASSERT_LT((u - plain.u.head<3>()).norm(), 1e-9 * u.norm()) << spec.kind;
      }
    }
  });
}

/// What a Monte Carlo study draws about and what the report shows stand on the same field, at the conditions
/// that a result has by default.
TEST(ErrorField, MonteCarloAndReportsStandOnIt) {
  for_each_effect("w X' b Y Z t", [&](const Campaign&, const EffectSpec& spec, const FitResult& result,
                                      std::mt19937_64&) {
    constexpr int kNodes = 3;
    const std::vector<AxisPosition> positions = grid_positions(result.machine, kNodes);
    const QuantitySet quantities = quantities_of(result, kNodes);
    const std::vector<report::ToolVolume> shown = report::tool_volumes(result, kNodes);
    ASSERT_EQ(quantities.volumes.size(), result.machine.tools.size());
    ASSERT_EQ(shown.size(), result.machine.tools.size());
    int varying = 0;
    for (std::size_t t = 0; t < shown.size(); ++t) {
      const ErrorField field(result, result.machine.tools[t]);
      std::vector<Vector3d> errors;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        errors.emplace_back(field.at(positions[i]).head<3>());
        const auto rows = field.unheld_rows(positions[i]);
        for (Eigen::Index k = 0; k < 3; ++k)
          varying += rows.row(k).dot(result.covariance * rows.row(k).transpose()) > 1e-24 ? 1 : 0;
      }
      const std::vector<Vector3d> aligned = without_rigid_motion(shown[t].point_w, errors);
      for (std::size_t i = 0; i < positions.size(); ++i)
        ASSERT_LT((shown[t].error_w[i] - aligned[i]).norm(), kSame) << spec.kind;
    }
    for (std::size_t i = 0; i < quantities.items.size(); ++i) {
      const Quantity& quantity = quantities.items[i];
      if (quantity.kind != QuantityKind::VolumetricError) continue;
      --varying;
      const ErrorField field(result, result.machine.tools[*result.machine.tool_index(quantity.tool)]);
      const int component = quantity.name == "ex" ? 0 : quantity.name == "ey" ? 1 : 2;
      ASSERT_NEAR(quantity.estimate, field.at(*quantity.at)[component], kSame)
          << spec.kind << " " << quantity.words();
      ASSERT_EQ(quantities.rows.row(static_cast<Eigen::Index>(i)),
                field.unheld_rows(*quantity.at).row(component))
          << spec.kind << " " << quantity.words();
    }
    ASSERT_EQ(varying, 0) << spec.kind;
  });
}

/// By differences of the model's prediction at its own parameters.
TEST(ErrorField, RowsAreTheDerivativesOfTheError) {
  const Conditions conditions = conditions_somewhere();
  for_each_effect("w X' b Y Z t", [&](const Campaign&, const EffectSpec& spec, const FitResult& result,
                                      std::mt19937_64& random) {
    const Poses poses = random_poses(result.machine, random, 2);
    const Tool& tool = result.machine.tools[1];
    const ErrorField field(result, tool, conditions);
    for (std::size_t i = 0; i < poses.positions.size(); ++i) {
      const PoseErrorRows rows = field.rows(poses.positions[i], poses.directions[i]);
      for (const int parameter : field.condition_parameters()) {
        const double size = std::max(1e-6, std::abs(result.parameters[parameter]));
        FitResult above = result, below = result;
        above.parameters[parameter] += 1e-3 * size;
        below.parameters[parameter] -= 1e-3 * size;
        const PoseErrorVector slope =
            (ErrorField(above, tool, conditions).at(poses.positions[i], poses.directions[i]) -
             ErrorField(below, tool, conditions).at(poses.positions[i], poses.directions[i])) /
            (2e-3 * size);
        EXPECT_LT((rows.col(parameter) - slope).norm(), 1e-4 * slope.norm() + 1e-9)
            << spec.kind << " " << parameter;
      }
    }
  });
}

// --- conditions, measured positions, rotary axes ---------------------------------------------------------

TEST(Conditions, AreTheReferenceTemperatureWhereTheModelKnowsTheExpansionAndTheMeanOtherwise) {
  FitResult result;
  result.conditions.temperature_degC = {{"scale", {21.0, 22.5, 24.0}}, {"air", {19.0, 20.5, 22.0}}};
  result.conditions.time = RecordedRange{100.0, 200.0, 300.0};
  EffectSpec expansion;
  expansion.kind = "scale-expansion";
  expansion.options.set("axis", std::string("X"));
  expansion.options.set("temperature", std::string("scale"));
  result.identified.effects = {expansion};
  const Conditions conditions = default_conditions(result);
  EXPECT_EQ(conditions.temperature_degC.at("scale"), 20.0);
  EXPECT_EQ(conditions.temperature_degC.at("air"), 20.5);
  EXPECT_EQ(conditions.time, 200.0);
  EXPECT_FALSE(conditions.feed);
  const Conditions stated = stated_conditions(result, {{"T_scale", "23.3"}, {"time_s", "250"}});
  EXPECT_EQ(stated.temperature_degC.at("scale"), 23.3);
  EXPECT_EQ(stated.time, 250.0);
  EXPECT_EQ(stated_reference_temperature(result, stated), 23.3);
  for (const StatedCondition& condition :
       list_conditions(result, stated_conditions(result, {{"T_scale", "20"}, {"time_s", "200"}})))
    EXPECT_EQ(condition.origin == kAsStated, condition.name() != "T_air_degC") << condition.name();
  for (const auto& [name, value] : std::map<std::string, std::string>{
           {"T_column", "20"}, {"feed_mm_min", "100"}, {"T_scale", "warm"}, {"T_air", "1e9"}, {"x", "1"}})
    EXPECT_THROW(stated_conditions(result, {{name, value}}), InputError) << name;
}

TEST(ErrorField, HoldsTheLastMeasuredErrorBeyondTheReadings) {
  std::mt19937_64 random(9);
  const Campaign campaign = effect_campaign();
  EffectSpec effect;
  effect.kind = "position-reversal";
  effect.options.set("symbol", std::string("EXX"));
  const MeasurementModel model(campaign, model_with(effect));
  FitResult result = result_of_model(model, random);
  const Axis& x = result.machine.axis(AxisName::X);
  const double first = x.travel_min + 0.2 * x.travel(), last = x.travel_min + 0.7 * x.travel();
  for (const Component component : kAllComponents)
    result.functions.push_back(
        {.symbol = {component, AxisName::X}, .prior = {}, .measured_min = first, .measured_max = last});
  const Tool& tool = result.machine.tools[0];
  const ErrorField field(result, tool, {});
  const DisplacementField fast = displacement_field(result, tool, {});
  AxisPosition at_edge{}, beyond{};
  at_edge[0] = last;
  beyond[0] = x.travel_max;
  EXPECT_FALSE(field.measured().is_beyond(at_edge));
  EXPECT_TRUE(field.measured().is_beyond(beyond));
  FitResult without = result;
  without.functions.clear();
  const PoseErrors<double> held = pose_errors(result.layout, at_edge, result.parameters);
  // Displacements of X do not depend on its own arm: EXX is held, EYX by what X carries.
  PoseErrors<double> of_x = held;
  const KinematicChain chain(result.machine);
  of_x.motion[0][0] += 0.5 *
                       result.parameters[result.layout.find_block("reversal EXX along the travel")->offset] *
                       (last - x.home);
  const Vector3d wanted = chain.first_order(beyond, tool.offset, of_x).displacement_w;
  EXPECT_LT((field.at(beyond, kTowardsPlus).head<3>() - wanted).norm(), kSame);
  for (int i = 0; i <= 20; ++i) {
    AxisPosition q{};
    q[0] = x.travel_min + x.travel() * i / 20.0;
    for (const ApproachDirection& direction : {ApproachDirection{}, kTowardsPlus})
      EXPECT_LT((field.at(q, direction).head<3>() - fast(q, direction)).norm(), kSame) << q[0];
  }
  // u is that of the function there, not that of the value that is held.
  const VolumetricError stated = volumetric_error(result, field, beyond, tool);
  const VolumetricError free = volumetric_error(without, ErrorField(without, tool, {}), beyond, tool);
  EXPECT_TRUE(stated.extrapolated);
  for (int k = 0; k < 6; ++k) EXPECT_GE(stated.u[k], 0.999 * free.u[k]);
}

/// A campaign with C at 90 deg knows what C does there alone, whatever its home; 450 deg is the same place.
TEST(ErrorField, TakesAnUnidentifiedRotaryAxisWhereItStood) {
  FitResult result;
  result.machine = testing_support::machine_of("wC'X'bYZt");
  AxisPosition position{};
  const auto c_at = [&position](double deg) {
    position[index_of(AxisName::C)] = deg * kRadianPerDegree;
    return position;
  };
  std::ranges::find(result.machine.axes, AxisName::C, &Axis::name)->home = 30.0 * kRadianPerDegree;
  EXPECT_NO_THROW(require_identified_rotary_axes(result, c_at(30.0))) << "home, where nothing else is known";
  result.standing[AxisName::C] = 90.0 * kRadianPerDegree;
  EXPECT_NO_THROW(require_identified_rotary_axes(result, c_at(90.0)));
  EXPECT_NO_THROW(require_identified_rotary_axes(result, c_at(450.0)));
  EXPECT_EQ(reference_text(result, AxisName::C), "C at 90 deg");
  for (const double elsewhere : {0.0, 30.0, 90.1})
    EXPECT_THROW(require_identified_rotary_axes(result, c_at(elsewhere)), InputError) << elsewhere;
}

TEST(ErrorField, RefusesARotaryPoseWithoutRotaryErrors) {
  FitResult result;
  result.machine = testing_support::machine_of("wC'X'bYZt");
  AxisPosition position{};
  EXPECT_NO_THROW(require_identified_rotary_axes(result, position));
  position[index_of(AxisName::C)] = 0.5;
  EXPECT_THROW(require_identified_rotary_axes(result, position), InputError);
  ParameterBlock location;
  location.name = "EC0C";
  location.location = LocationSymbol::parse("EC0C");
  result.layout.blocks.push_back(location);
  EXPECT_NO_THROW(require_identified_rotary_axes(result, position));
}

}  // namespace
}  // namespace volcal
