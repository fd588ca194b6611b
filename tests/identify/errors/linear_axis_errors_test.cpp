#include "volcal/identify/errors/linear_axis_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/error_oracles.h"
#include "tests/support/machines.h"
#include "tests/support/random_results.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::machine_of;
using testing_support::random_machine;
using testing_support::random_result;
using testing_support::random_vector;
using testing_support::uniform;

constexpr double kLinesAsPlain = 1e-12;  // of the largest

int random_count(std::mt19937_64& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

FunctionSpec random_spline(std::mt19937_64& random, const Axis& axis) {
  FunctionSpec spec;
  spec.basis = "bspline";
  spec.degree = random_count(random, 1, 3);
  spec.knots = KnotChoice::Explicit;
  const int pieces = random_count(random, 1, 6);
  spec.breakpoints = uniform_breakpoints(axis, pieces);
  for (int i = 1; i < pieces; ++i)
    spec.breakpoints[static_cast<std::size_t>(i)] += uniform(random, 0.45 * axis.travel() / pieces);
  return spec;
}

FunctionSpec random_legendre(std::mt19937_64& random, int highest) {
  FunctionSpec spec;
  spec.basis = "legendre";
  spec.degree = random_count(random, 1, highest);
  return spec;
}

FunctionGroup group_of(const Axis& axis, const FunctionSpec& spec, const std::vector<Component>& components) {
  FunctionGroup group;
  group.axis = axis.name;
  group.basis = find_basis(spec.basis)->make(spec, axis);
  for (const Component component : components) group.symbols.push_back({component, axis.name});
  return group;
}

ParameterBlock block_of(ParameterKind kind, const std::string& name) {
  ParameterBlock block;
  block.kind = kind;
  block.name = name;
  block.guess = Eigen::VectorXd::Zero(1);
  if (kind == ParameterKind::Location) block.location = LocationSymbol::parse(name);
  return block;
}

/// Two groups of functions per axis with knots of their own, squareness, two reversals, all at random.
FitResult random_linear_result(const Machine& machine, std::mt19937_64& random, int highest_degree = 8) {
  FitResult result;
  result.machine = machine;
  ParameterLayout& layout = result.layout;
  for (const Axis& axis : machine.axes) {
    layout.groups.push_back(group_of(axis, random_spline(random, axis), {Component::X, Component::B}));
    const bool spline = random_count(random, 0, 1) == 0 && highest_degree <= 8;
    const FunctionSpec spec = spline ? random_spline(random, axis) : random_legendre(random, highest_degree);
    layout.groups.push_back(group_of(axis, spec, {Component::C, Component::Y, Component::A, Component::Z}));
  }
  for (const LocationSymbol symbol : machine.datum.squareness()) {
    if (machine.has_axis(symbol.axis))
      layout.blocks.push_back(block_of(ParameterKind::Location, symbol.name()));
  }
  const AxisName first = machine.axes.front().name;
  for (const Component component : {Component::X, Component::C}) {
    const std::string symbol = ErrorSymbol{component, first}.name();
    layout.blocks.push_back(block_of(ParameterKind::Effect, "reversal " + symbol));
    EffectSpec reversal;
    reversal.kind = "reversal";
    reversal.options.set("symbol", symbol);
    result.identified.effects.push_back(reversal);
  }
  for (FunctionGroup& group : layout.groups) {
    group.offset = layout.size;
    layout.size += group.size();
  }
  layout.function_size = layout.size;
  for (ParameterBlock& block : layout.blocks) block.offset = layout.size++;
  result.parameters.resize(layout.size);
  for (double& parameter : result.parameters) parameter = uniform(random, 1e-5);
  return result;
}

/// Inside the travel and somewhat outside, ends and knots among them.
std::vector<AxisPosition> random_positions(const FitResult& result, std::mt19937_64& random, int count) {
  std::vector<AxisPosition> positions(static_cast<std::size_t>(count));
  for (AxisPosition& position : positions) {
    for (const Axis& axis : result.machine.axes)
      position[index_of(axis.name)] = axis.travel_min + axis.travel() * (0.5 + uniform(random, 0.52));
    const FunctionGroup& group = result.layout.groups[static_cast<std::size_t>(random_count(random, 0, 1))];
    const std::vector<double> ends = group.basis->pieces();
    if (random_count(random, 0, 3) == 0)
      position[index_of(group.axis)] =
          ends[static_cast<std::size_t>(random_count(random, 0, static_cast<int>(ends.size()) - 1))];
  }
  return positions;
}

std::vector<ApproachDirection> random_directions(std::mt19937_64& random, std::size_t count) {
  std::vector<ApproachDirection> directions(count);
  for (ApproachDirection& direction : directions) {
    for (auto& sign : direction) sign = static_cast<std::int8_t>(random_count(random, -1, 1));
  }
  return directions;
}

Tool tool_at(const Vector3d& offset) { return {"", offset, 0.0}; }

MachineEffects effects_of(const FitResult& result, const Vector3d& tool) {
  return {result, tool_at(tool), {}};
}

void expect_lines_as_plain(const Machine& machine, std::mt19937_64& random) {
  const FitResult result = random_linear_result(machine, random);
  const Vector3d tool = random_vector(random, 0.3);
  const auto errors = LinearAxisErrors::make(result, tool, effects_of(result, tool));
  ASSERT_TRUE(errors);
  EXPECT_TRUE(errors->effects_left_out().empty());
  const DisplacementField plain = testing::plain_displacement_field(result, tool_at(tool), {});
  const std::vector<AxisPosition> positions = random_positions(result, random, 100);
  const std::vector<ApproachDirection> directions = random_directions(random, positions.size());
  double largest = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vector3d wanted = plain(positions[i], directions[i]);
    largest = std::max(largest, wanted.cwiseAbs().maxCoeff());
    difference =
        std::max(difference, (errors->at(positions[i], directions[i]) - wanted).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(largest, 1e-7);
  EXPECT_LT(difference, kLinesAsPlain * largest) << machine.structure.code;
}

TEST(LinearAxisErrors, AreThePlainFieldOfAnyMachine) {
  std::mt19937_64 random(71);
  for (int i = 0; i < 50; ++i) expect_lines_as_plain(random_machine(random), random);
}

TEST(LinearAxisErrors, AreThePlainFieldWhereAxesAreLacking) {
  std::mt19937_64 random(72);
  for (const char* code : {"wX'bZt", "wC'X'bYt", "wbAYt", "wZ'bt"})
    expect_lines_as_plain(machine_of(code), random);
}

TEST(LinearAxisErrors, AtManyPositionsAreThoseAtEachToTheBit) {
  std::mt19937_64 random(73);
  const FitResult result = random_linear_result(random_machine(random), random);
  const Vector3d tool = random_vector(random, 0.3), none = Vector3d::Zero();
  const auto errors = LinearAxisErrors::make(result, tool, effects_of(result, tool));
  const DisplacementField field = displacement_field(result, tool_at(none), {});
  const auto of_field = LinearAxisErrors::make(result, none, effects_of(result, none));
  const std::vector<AxisPosition> positions = random_positions(result, random, 37);
  const std::vector<ApproachDirection> directions = random_directions(random, positions.size());
  std::vector<Vector3d> many(positions.size()), towards_plus(positions.size());
  errors->at(positions, directions, many);
  errors->at(positions, {&kTowardsPlus, 1}, towards_plus);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_EQ(many[i], errors->at(positions[i], directions[i]));
    EXPECT_EQ(towards_plus[i], errors->at(positions[i], kTowardsPlus));
    EXPECT_EQ(field(positions[i], directions[i]), of_field->at(positions[i], directions[i]));
  }
}

/// Positions up to a travel beyond either end, and the ends themselves.
std::vector<AxisPosition> positions_beyond(const Machine& machine, std::mt19937_64& random, int count) {
  std::vector<AxisPosition> positions(static_cast<std::size_t>(count));
  for (AxisPosition& position : positions) {
    for (const Axis& axis : machine.axes) {
      const int where = random_count(random, 0, 3);
      position[index_of(axis.name)] = where == 0 ? axis.travel_min
                                      : where == 1
                                          ? axis.travel_max
                                          : axis.travel_min + axis.travel() * (0.5 + uniform(random, 1.5));
    }
  }
  return positions;
}

// Beyond the readings the last measured value is held, whether they end within the travel or with it.
TEST(LinearAxisErrors, BeyondTheReadingsErrorsAreHeldAsInThePlainField) {
  std::mt19937_64 random(76);
  for (const double share : {0.0, 0.15}) {
    for (int i = 0; i < 20; ++i) {
      const Machine machine = random_machine(random);
      FitResult result = random_result(machine, random);
      for (const Axis& axis : machine.axes) {
        FunctionSummary& summary = result.functions.emplace_back();
        summary.symbol = {Component::X, axis.name};
        summary.measured_min = axis.travel_min + share * axis.travel();
        summary.measured_max = axis.travel_max - 2.0 * share * axis.travel();
      }
      const Vector3d tool = random_vector(random, 0.3);
      const auto errors = LinearAxisErrors::make(result, tool, effects_of(result, tool));
      ASSERT_TRUE(errors);
      const DisplacementField plain = testing::plain_displacement_field(result, tool_at(tool), {});
      double largest = 0.0, difference = 0.0;
      for (const AxisPosition& position : positions_beyond(machine, random, 60)) {
        const Vector3d wanted = plain(position, kTowardsPlus);
        largest = std::max(largest, wanted.cwiseAbs().maxCoeff());
        difference =
            std::max(difference, (errors->at(position, kTowardsPlus) - wanted).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(difference, kLinesAsPlain * largest) << machine.structure.code << ", " << share;
    }
  }
}

TEST(LinearAxisErrors, CountsThatDifferAreRefused) {
  std::mt19937_64 random(74);
  const FitResult result = random_linear_result(machine_of("wX'bYZt"), random);
  const auto errors = LinearAxisErrors::make(result, Vector3d::Zero(), effects_of(result, Vector3d::Zero()));
  const std::vector<AxisPosition> positions(3);
  const std::vector<ApproachDirection> directions(2);
  std::vector<Vector3d> two(2), three(3);
  EXPECT_THROW(errors->at(positions, {&kTowardsPlus, 1}, two), std::invalid_argument);
  EXPECT_THROW(errors->at(positions, directions, three), std::invalid_argument);
}

TEST(LinearAxisErrors, FunctionsOfHighDegreeKeepThePlainField) {
  std::mt19937_64 random(75);
  FitResult result = random_linear_result(machine_of("wX'bYZt"), random, 30);
  const auto is_high = [](const FunctionGroup& group) { return group.basis->degree() > 8; };
  ASSERT_TRUE(std::ranges::any_of(result.layout.groups, is_high));
  const Vector3d tool = Vector3d::Zero();
  EXPECT_FALSE(LinearAxisErrors::make(result, tool, effects_of(result, tool)));
  const DisplacementField field = displacement_field(result, tool_at(tool), {});
  const DisplacementField plain = testing::plain_displacement_field(result, tool_at(tool), {});
  for (const AxisPosition& position : random_positions(result, random, 20)) {
    const Vector3d wanted = plain(position, kTowardsPlus);
    EXPECT_LT((field(position, kTowardsPlus) - wanted).norm(), kLinesAsPlain * wanted.norm());
  }
}

}  // namespace
}  // namespace volcal
