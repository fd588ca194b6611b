// Results in other machine coordinate systems: by hand, and on random machines against the functional points.

#include "volcal/identify/errors/alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <string>

#include "tests/support/effect_campaign.h"
#include "tests/support/effect_results.h"
#include "tests/support/five_axis.h"
#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/straight_surface.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/kinematics/rotary_datum.h"
#include "volcal/model/observation/campaign_binding.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::result_with;
using testing_support::machine_of;

double location_of(const FitResult& result, const char* symbol) {
  const ParameterBlock* block = result.layout.find_location(*LocationSymbol::parse(symbol));
  return block == nullptr ? std::nan("") : result.parameters[block->offset];
}

double value_of_function(const FitResult& result, const char* symbol, double q) {
  const ErrorSymbol wanted = *ErrorSymbol::parse(symbol);
  const auto place = result.layout.find(wanted);
  return result.layout.groups[static_cast<std::size_t>(place->group)].basis->value(
      q, result.layout.coefficients(wanted, result.parameters));
}

Alignment to_datum(AxisName primary, AxisName secondary) {
  Alignment alignment;
  alignment.datum = {primary, secondary};
  return alignment;
}

// Y leans by 30 urad towards -x (u_Y = e_Y - EC0Y e_X). With Y as the primary axis the frame turns by 30 urad
// about z, and X then leans by 30 urad towards -y: u_X = e_X + EC0X e_Y.
TEST(Alignment, SquarenessOfXToYIsMinusThatOfYToX) {
  const FitResult result = result_with(machine_of("w X' b Y Z t"), {.locations = {{"EC0Y", 30e-6}}}, 4);
  const AlignedResult aligned = align_result(result, to_datum(AxisName::Y, AxisName::X));
  EXPECT_NEAR(location_of(aligned.result, "EC0X"), -30e-6, 1e-18);
  EXPECT_NEAR(location_of(aligned.result, "EB0Z"), 0.0, 1e-18);
  EXPECT_NEAR(aligned.frame_rotation.z(), 30e-6, 1e-18);
  EXPECT_EQ(aligned.result.machine.datum.primary, AxisName::Y);
}

// EBY = 12 urad/m y. Zero at y = 0.5 m it was 6 urad there, which Z, carried by Y, took part in: 6 urad
// towards +x, EB0Z.
TEST(Alignment, AnglesAtTheNewOriginBecomeSquarenessOfTheAxesCarried) {
  const FitResult result = result_with(
      machine_of("w X' b Y Z t"),
      {.functions = {{"EBY", [](double q) { return 12e-6 * q; }}}, .locations = {{"EB0Z", 0.0}}}, 4);
  Alignment alignment = to_datum(AxisName::X, AxisName::Y);
  alignment.origin = AxisPosition{0.0, 0.5, 0.0};
  const FitResult aligned = align_result(result, alignment).result;
  EXPECT_NEAR(value_of_function(aligned, "EBY", 0.5), 0.0, 1e-18);
  EXPECT_NEAR(value_of_function(aligned, "EBY", 1.0), 6e-6, 1e-17);
  EXPECT_NEAR(location_of(aligned, "EB0Z"), 6e-6, 1e-17);
  EXPECT_EQ(aligned.machine.axis(AxisName::Y).home, 0.5);
}

// Z leans by 20 urad towards +x and the spindle by 5 urad more: along the spindle Z moves by 5 urad towards
// -x, which EXZ keeps; X, which was along x, is turned by 25 urad about y against the frame.
TEST(Alignment, AlongTheSpindleTheSlopeOfZStaysInItsStraightness) {
  FitResult result =
      result_with(machine_of("w X' b Y Z t"),
                  {.functions = {{"EXZ", [](double) { return 0.0; }}, {"EYZ", [](double) { return 0.0; }}},
                   .locations = {{"EB0Z", 20e-6}}},
                  4);
  Alignment alignment = to_datum(AxisName::Z, AxisName::X);
  alignment.spindle_tilt = Eigen::Vector2d(0.0, 5e-6);
  const AlignedResult aligned = align_result(result, alignment);
  EXPECT_NEAR(value_of_function(aligned.result, "EXZ", 1.0), -5e-6, 1e-17);
  EXPECT_NEAR(value_of_function(aligned.result, "EYZ", 1.0), 0.0, 1e-18);
  EXPECT_NEAR(aligned.frame_rotation.y(), 25e-6, 1e-17);
  // u_X = e_X - phi x e_X = e_X + 25 urad e_Z; u_s = e_s + EB0X e_Y x e_X = e_X - EB0X e_Z
  EXPECT_NEAR(location_of(aligned.result, "EB0X"), -25e-6, 1e-17);
  EXPECT_THAT(aligned.result.alignment, HasSubstr("along the spindle"));
}

FitResult result_with_tools(std::mt19937_64& random, const std::string& code) {
  Machine machine = machine_of(code);
  for (Axis& axis : machine.axes) axis.reference_point = testing_support::random_vector(random, 0.5);
  machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0}, {"side", {0.11, 0.05, -0.24}, 0.0}};
  testing::GivenErrors given;
  for (const AxisName axis : kLinearAxes) {
    for (const Component component : kAllComponents)
      given.functions[ErrorSymbol{component, axis}.name()] = [&random](double) {
        return testing_support::uniform(random, 20e-6);
      };
  }
  for (const LocationSymbol symbol : machine.datum.squareness())
    given.locations[symbol.name()] = testing_support::uniform(random, 50e-6);
  given.reversals["EXX"] = 3e-6;
  FitResult result = result_with(machine, given, 3);
  Eigen::MatrixXd factor(result.layout.size, result.layout.size);
  for (double& element : factor.reshaped()) element = testing_support::uniform(random, 1e-6);
  result.covariance = factor * factor.transpose();
  return result;
}

/// Points of one tool, what takes a rigid motion off their errors, and the errors with their derivatives.
struct PointSet {
  std::vector<AxisPosition> positions;
  Eigen::MatrixXd rest;
};

PointSet random_points(std::mt19937_64& random, Eigen::Index count) {
  PointSet set;
  Eigen::MatrixXd motions(3 * count, 6);
  for (Eigen::Index i = 0; i < count; ++i) {
    AxisPosition position{};
    Eigen::Vector3d p;
    for (std::size_t k = 0; k < 3; ++k)
      p[static_cast<Eigen::Index>(k)] = position[k] = 0.5 + testing_support::uniform(random, 0.5);
    set.positions.push_back(position);
    for (int k = 0; k < 3; ++k) {
      motions.block<3, 1>(3 * i, k) = Eigen::Vector3d::Unit(k);
      motions.block<3, 1>(3 * i, 3 + k) = Eigen::Vector3d::Unit(k).cross(p);
    }
  }
  const Eigen::MatrixXd q = motions.householderQr().householderQ() * Eigen::MatrixXd::Identity(3 * count, 6);
  set.rest = Eigen::MatrixXd::Identity(3 * count, 3 * count) - q * q.transpose();
  return set;
}

Eigen::MatrixXd error_rows(const FitResult& result, const PointSet& set, const Tool& tool) {
  Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(set.positions.size()), result.layout.size);
  for (std::size_t i = 0; i < set.positions.size(); ++i)
    rows.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        ErrorField(result, tool).rows(set.positions[i]).topRows<3>();
  return rows;
}

/// EXX += amplitude * expression, its amplitude uncertain.
void add_expression(FitResult& result, const std::string& target, const std::string& expression,
                    double amplitude) {
  const EffectSpec spec =
      effect_spec("custom", {{"target", target}, {"expression", expression}, {"amplitude", amplitude}});
  ParameterBlock block;
  block.kind = ParameterKind::Effect;
  block.name = find_effect("custom")->make(spec, "model.toml")->amplitudes().front().label;
  block.offset = result.layout.size++;
  block.labels = {""};
  block.units = {"um"};
  block.si_per_unit = {1e-6};
  block.guess = Eigen::VectorXd::Zero(1);
  result.layout.blocks.push_back(block);
  result.identified.effects.push_back(spec);
  result.parameters.conservativeResize(result.layout.size);
  result.parameters[block.offset] = amplitude;
  result.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(result.layout.size, result.layout.size));
  result.covariance(block.offset, block.offset) = 1e-26;
}

TEST(Alignment, ErrorsAndTheirCovarianceAreTheSameUpToARigidMotion) {
  std::mt19937_64 random(17);
  for (const char* code : {"w X b Y Z t", "w X' Y' b Z t", "w b X Y Z t", "w Y' b Z X t"}) {
    const FitResult result = result_with_tools(random, code);
    for (const AxisName primary : kLinearAxes) {
      for (const AxisName secondary : kLinearAxes) {
        if (primary == secondary) continue;
        Alignment alignment = to_datum(primary, secondary);
        alignment.origin = AxisPosition{0.3, 0.8, 0.6};
        if (primary == AxisName::Z) alignment.spindle_tilt = Eigen::Vector2d(40e-6, -25e-6);
        const FitResult aligned = align_result(result, alignment).result;
        const PointSet set = random_points(random, 12);
        for (const Tool& tool : result.machine.tools) {
          const Eigen::MatrixXd before = set.rest * error_rows(result, set, tool);
          const Eigen::MatrixXd after = set.rest * error_rows(aligned, set, tool);
          EXPECT_LT((before * result.parameters - after * aligned.parameters).norm(), 1e-17) << code;
          const Eigen::MatrixXd u2 = before * result.covariance * before.transpose();
          const Eigen::MatrixXd u2_after = after * aligned.covariance * after.transpose();
          EXPECT_LT((u2 - u2_after).norm(), 1e-12 * u2.norm()) << code;
        }
      }
    }
  }
}

/// What a surface adds is a function of the commanded positions, which an origin does not move: with a
/// surface and an expression errors and their covariance are the same up to a rigid motion, too.
TEST(Alignment, CarriesSurfacesAndExpressions) {
  std::mt19937_64 random(18);
  for (const char* code : {"w X' Y' b Z t", "w Y' b Z X t"}) {
    FitResult result = result_with_tools(random, code);
    testing_support::add_straight_surface(
        result, testing_support::stated_surface("EAY", "y z", {0.0, 0.0}, {1000.0, 1000.0}, {3, 2}), 1);
    add_expression(result, "EXX", "z * z", 4e-12);
    Alignment alignment = to_datum(AxisName::Y, AxisName::Z);
    alignment.origin = AxisPosition{0.3, 0.8, 0.6};
    const FitResult aligned = align_result(result, alignment).result;
    const PointSet set = random_points(random, 12);
    for (const Tool& tool : result.machine.tools) {
      const auto errors = [&](const FitResult& of, const Tool& with) {
        const ErrorField field(of, with);
        Eigen::VectorXd all(3 * static_cast<Eigen::Index>(set.positions.size()));
        for (std::size_t i = 0; i < set.positions.size(); ++i)
          all.segment<3>(3 * static_cast<Eigen::Index>(i)) = field.at(set.positions[i]).head<3>();
        return all;
      };
      const Eigen::VectorXd before = set.rest * errors(result, tool);
      EXPECT_LT((before - set.rest * errors(aligned, tool)).norm(), 1e-15) << code;
      EXPECT_GT(before.norm(), 10e-6);
      const Eigen::MatrixXd rows = set.rest * error_rows(result, set, tool);
      const Eigen::MatrixXd rows_after = set.rest * error_rows(aligned, set, tool);
      const Eigen::MatrixXd u2 = rows * result.covariance * rows.transpose();
      EXPECT_LT((u2 - rows_after * aligned.covariance * rows_after.transpose()).norm(), 1e-12 * u2.norm())
          << code;
    }
  }
}

Eigen::VectorXd errors_at(const FitResult& result, const PointSet& set, const Tool& tool) {
  const ErrorField field(result, tool);
  Eigen::VectorXd all(3 * static_cast<Eigen::Index>(set.positions.size()));
  for (std::size_t i = 0; i < set.positions.size(); ++i) {
    const auto sign = [i](std::size_t axis) -> std::int8_t { return ((i >> axis) & 1U) != 0 ? 1 : -1; };
    all.segment<3>(3 * static_cast<Eigen::Index>(i)) =
        field.at(set.positions[i], {sign(0), sign(1), sign(2)}).head<3>();
  }
  return all;
}

/// Every effect that an origin does not refuse: what it adds is then the same wherever the origin is.
TEST(Alignment, CarriesEffectsThatAreTheSameAtEveryPosition) {
  const Campaign campaign = testing_support::effect_campaign("w X' b Y Z t");
  std::set<std::string> carried, refused;
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& spec : kind->examples(campaign)) {
      std::mt19937_64 random(19);  // the same errors whatever other kinds there are
      const MeasurementModel model(campaign, testing_support::model_with(spec));
      const FitResult result = testing_support::result_of_model(model, random);
      if (ErrorField(result, result.machine.tools[0]).effects().empty()) continue;
      const Alignment alignment{
          .datum = result.machine.datum, .origin = AxisPosition{0.1, 0.15, 0.12}, .spindle_tilt = {}};
      try {
        const FitResult aligned = align_result(result, alignment).result;
        const PointSet set = random_points(random, 16);
        const Eigen::VectorXd change = errors_at(aligned, set, aligned.machine.tools[0]) -
                                       errors_at(result, set, result.machine.tools[0]);
        EXPECT_LT((set.rest * change).norm(), 2e-9) << spec.kind;  // products of errors of 20 urad
        EXPECT_GT(change.norm(), 1e-6);
        carried.insert(spec.kind);
      } catch (const InputError&) {
        refused.insert(spec.kind);
      }
    }
  }
  for (const char* kind : {"reversal", "common-reversal", "custom"})
    EXPECT_TRUE(carried.contains(kind)) << kind;
  EXPECT_TRUE(refused.contains("scale-stretch") || refused.contains("position-reversal"));
}

/// Where the frame has gone and came back, nothing has changed but by rounding.
TEST(Alignment, ThereAndBackIsTheSameResult) {
  std::mt19937_64 random(5);
  const FitResult raw = result_with_tools(random, "w X' b Y Z t");
  const FitResult first = align_result(raw, to_datum(AxisName::X, AxisName::Y)).result;
  Alignment alignment = to_datum(AxisName::Z, AxisName::Y);
  alignment.origin = AxisPosition{0.5, 0.25, 1.0};
  Alignment back = to_datum(AxisName::X, AxisName::Y);
  back.origin = AxisPosition{0.0, 0.0, 0.0};
  const FitResult again = align_result(align_result(first, alignment).result, back).result;
  EXPECT_LT((again.parameters - first.parameters).norm(), 1e-17);
  EXPECT_LT((again.covariance - first.covariance).norm(), 1e-12 * first.covariance.norm());
  for (std::size_t i = 0; i < first.machine.tools.size(); ++i)
    EXPECT_LT((again.machine.tools[i].offset - first.machine.tools[i].offset).norm(), 1e-8);
}

/// Points of two tools keep their distances: what the frame turns, it turns for all tools.
TEST(Alignment, ToolsTurnWithTheFrame) {
  std::mt19937_64 random(23);
  const FitResult result = result_with_tools(random, "w X' b Y Z t");
  Alignment alignment = to_datum(AxisName::Z, AxisName::Y);
  alignment.origin = AxisPosition{0.4, 0.7, 0.2};
  const FitResult aligned = align_result(result, alignment).result;
  std::vector<Eigen::Vector3d> points, changes;
  for (std::size_t tool = 0; tool < 2; ++tool) {
    for (const AxisPosition& position : random_points(random, 8).positions) {
      const Tool& before = result.machine.tools[tool];
      const Tool& after = aligned.machine.tools[tool];
      points.emplace_back(Eigen::Vector3d(position[0], position[1], position[2]) + before.offset);
      changes.emplace_back(after.offset + volumetric_error(aligned, position, before).value.head<3>() -
                           before.offset - volumetric_error(result, position, before).value.head<3>());
    }
  }
  EXPECT_GT(changes.front().norm(), 1e-6);
  EXPECT_LT(sim::rms_after_alignment(points, changes), 1e-15);
}

/// Linear and rotary axes with errors of all of them, the location errors that the machine's datum leaves.
FitResult result_with_rotary_axes(std::mt19937_64& random, const std::string& code) {
  Machine machine = testing_support::five_axis_machine(code);
  testing::GivenErrors given;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents)
      given.functions[ErrorSymbol{component, axis.name}.name()] = [&random](double) {
        return testing_support::uniform(random, 20e-6);
      };
  }
  for (const LocationSymbol symbol : independent_locations(machine))
    given.locations[symbol.name()] = testing_support::uniform(random, 50e-6);
  FitResult result = result_with(machine, given, 3);
  Eigen::MatrixXd factor(result.layout.size, result.layout.size);
  for (double& element : factor.reshaped()) element = testing_support::uniform(random, 1e-6);
  result.covariance = factor * factor.transpose();
  return result;
}

/// Errors of all tools at poses of all axes, tools as the result has them less their former offsets, less
/// what a rigid motion of the workpiece explains.
struct PosedErrors {
  Eigen::MatrixXd rows;
  Eigen::VectorXd value;
};

PosedErrors posed_errors(const FitResult& result, const Machine& former, std::uint64_t seed) {
  constexpr Eigen::Index kPoses = 40;
  std::mt19937_64 random(seed);
  const KinematicChain chain(former);
  const auto tools = static_cast<Eigen::Index>(former.tools.size());
  PosedErrors errors{Eigen::MatrixXd(3 * kPoses, result.layout.size), Eigen::VectorXd(3 * kPoses)};
  Eigen::MatrixXd motions(3 * kPoses, 6);
  for (Eigen::Index pose = 0; pose < kPoses; ++pose) {
    AxisPosition position{};
    for (const Axis& axis : former.axes)
      position[index_of(axis.name)] =
          std::uniform_real_distribution<double>(axis.travel_min, axis.travel_max)(random);
    const auto tool = static_cast<std::size_t>(pose % tools);
    const Tool& before = former.tools[tool];
    const Eigen::Vector3d at_w = chain.nominal_point_w(position, before.offset);
    errors.rows.middleRows<3>(3 * pose) = ErrorField(result, before).rows(position).topRows<3>();
    errors.value.segment<3>(3 * pose) =
        errors.rows.middleRows<3>(3 * pose) * result.parameters +
        chain.nominal_rotation_wt(position) * (result.machine.tools[tool].offset - before.offset);
    for (int k = 0; k < 3; ++k) {
      motions.block<3, 1>(3 * pose, k) = Eigen::Vector3d::Unit(k);
      motions.block<3, 1>(3 * pose, 3 + k) = Eigen::Vector3d::Unit(k).cross(at_w);
    }
  }
  const Eigen::MatrixXd q = motions.householderQr().householderQ() * Eigen::MatrixXd::Identity(3 * kPoses, 6);
  errors.rows -= q * (q.transpose() * errors.rows).eval();
  errors.value -= q * (q.transpose() * errors.value).eval();
  return errors;
}

/// Lines of rotary axes stand where they stood, whichever axes and origin the frame follows.
TEST(Alignment, CarriesTheLinesOfRotaryAxes) {
  std::mt19937_64 random(29);
  for (const char* code : {"w C' A' b X Y Z t", "w C' A' Y' b X Z t", "w X' b Y Z C B t", "w C' X' b Y Z B t",
                           "w C' B' b X Y Z t", "w A' b X Y Z t"}) {
    const FitResult result = result_with_rotary_axes(random, code);
    for (const auto& [primary, secondary] :
         {std::pair(AxisName::Y, AxisName::X), std::pair(AxisName::Z, AxisName::Y)}) {
      Alignment alignment = to_datum(primary, secondary);
      alignment.origin = AxisPosition{0.3, -0.2, 0.25};
      if (primary == AxisName::Z) alignment.spindle_tilt = Eigen::Vector2d(40e-6, -25e-6);
      const FitResult aligned = align_result(result, alignment).result;
      const PosedErrors before = posed_errors(result, result.machine, 3);
      const PosedErrors after = posed_errors(aligned, result.machine, 3);
      EXPECT_GT(before.value.norm(), 1e-4) << code;
      EXPECT_LT((before.value - after.value).norm(), 1e-7 * before.value.norm()) << code;
      const Eigen::MatrixXd u2_before = before.rows * result.covariance * before.rows.transpose();
      const Eigen::MatrixXd u2_after = after.rows * aligned.covariance * after.rows.transpose();
      EXPECT_LT((u2_before - u2_after).norm(), 1e-6 * u2_before.norm()) << code;
      for (std::size_t tool = 0; tool < result.machine.tools.size(); ++tool)
        EXPECT_EQ(aligned.machine.tools[tool].offset, result.machine.tools[tool].offset) << code;
      for (const LocationSymbol symbol : independent_locations(result.machine)) {
        if (is_rotary(symbol.axis)) {
          EXPECT_NE(aligned.layout.find_location(symbol), nullptr) << code << " " << symbol.name();
        }
      }
    }
  }
}

/// X turned by 20 urad about z against the frame of Y: with Y as primary axis the frame turns, and the line
/// of A, which was along the nominal x, is turned back: EC0A = -phi_z. Zero where it was.
TEST(Alignment, TiltsTheLineOfARotaryAxisByHand) {
  const Machine machine = testing_support::five_axis_machine("w A' b X Y Z t");
  testing::GivenErrors given;
  for (const LocationSymbol symbol : independent_locations(machine)) given.locations[symbol.name()] = 0.0;
  given.locations["EC0Y"] = 20e-6;
  const FitResult result = result_with(machine, given, 4);
  const AlignedResult aligned = align_result(result, to_datum(AxisName::Y, AxisName::X));
  EXPECT_NEAR(aligned.frame_rotation.z(), 20e-6, 1e-12);
  EXPECT_NEAR(location_of(aligned.result, "EC0A"), -20e-6, 1e-12);
  EXPECT_NEAR(location_of(aligned.result, "EB0A"), 0.0, 1e-12);
  // The line passes (0, 20, 50) mm of the old frame: 20 urad about z move it by phi x p = (-0.4, 0, 0) um,
  // along itself.
  EXPECT_NEAR(location_of(aligned.result, "EZ0A"), 0.0, 1e-12);
}

std::string refused_alignment(const FitResult& result, const Alignment& alignment) {
  try {
    align_result(result, alignment);
  } catch (const InputError& error) {
    EXPECT_FALSE(error.remedy().empty());
    return error.what();
  }
  return "";
}

TEST(Alignment, SaysWhatCannotBeDone) {
  const FitResult result = result_with(machine_of("w X' b Y Z t"), {.locations = {{"EC0Y", 30e-6}}}, 4);
  EXPECT_THAT(refused_alignment(result, to_datum(AxisName::X, AxisName::X)), HasSubstr("the same"));
  Alignment alignment = to_datum(AxisName::X, AxisName::Y);
  alignment.origin = AxisPosition{2.0, 0.0, 0.0};
  EXPECT_THAT(refused_alignment(result, alignment), HasSubstr("outside the travel of X"));
  alignment = to_datum(AxisName::X, AxisName::Y);
  alignment.spindle_tilt = Eigen::Vector2d(0.0, 0.0);
  EXPECT_THAT(refused_alignment(result, alignment), HasSubstr("parallel to Z"));
  alignment.datum = {AxisName::Z, AxisName::X};
  EXPECT_EQ(refused_alignment(result, alignment), "");
  alignment.spindle_tilt = Eigen::Vector2d(1e-6, 0.0);
  EXPECT_THAT(refused_alignment(result, alignment), HasSubstr("EXZ is switched off"));
  alignment.spindle_tilt = Eigen::Vector2d(0.5, 0.0);
  EXPECT_THAT(refused_alignment(result, alignment), HasSubstr("10 mrad"));
  EXPECT_THAT(
      refused_alignment(result_with(machine_of("w X' b Y t"), {}, 4), to_datum(AxisName::X, AxisName::Z)),
      HasSubstr("no axis Z"));
  FitResult thermal = result;
  thermal.layout.blocks[0].kind = ParameterKind::Effect;
  thermal.layout.blocks[0].name = "thermal EXX";
  thermal.layout.blocks[0].location.reset();
  alignment = to_datum(AxisName::X, AxisName::Y);
  alignment.origin = AxisPosition{0.5, 0.0, 0.0};
  EXPECT_THAT(refused_alignment(thermal, alignment), HasSubstr("thermal EXX refers to the origin"));
}

}  // namespace
}  // namespace volcal
