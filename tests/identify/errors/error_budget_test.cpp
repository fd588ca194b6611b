#include "volcal/identify/errors/volume/error_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using testing_support::machine_of;

const BudgetLine& line_named(const std::vector<BudgetLine>& lines, const std::string& name) {
  const auto found = std::ranges::find(lines, name, &BudgetLine::name);
  EXPECT_NE(found, lines.end()) << name;
  return found == lines.end() ? lines.front() : *found;
}

Machine machine_with_a_tool() {
  Machine machine = machine_of("wX'bYZt");
  machine.tools = {{"short", {0.0, 0.0, -0.1}, 0.0}};
  return machine;
}

constexpr int kCells = 9;

// EXX = a (q - 1/2)^2 over 1 m, which no rigid motion takes up but its mean a/12: the mean square of the rest
// is a^2 (1/80 - 1/144), and at the ends it is a/4 - a/12. EYY jumps by b between the directions: +-b/2,
// whatever the position.
TEST(ErrorBudget, IsTheHandCalculation) {
  const double a = 40e-6, b = 6e-6;
  FitResult result =
      testing::result_with(machine_with_a_tool(),
                           {.functions = {{"EXX", [a](double q) { return a * (q - 0.5) * (q - 0.5); }}},
                            .reversals = {{"EYY", b}}},
                           20);
  const ErrorBudget budget = error_budget(result, result.machine.tools[0], {}, kCells);
  const BudgetLine& positioning = line_named(budget.contributions, "EXX");
  const double exx = positioning.rms;
  EXPECT_NEAR(exx, a / std::sqrt(180.0), 0.01 * exx);
  EXPECT_NEAR(positioning.max, a / 6.0, 0.01 * a / 6.0);
  EXPECT_EQ(positioning.depends_on_text(), "x");
  const BudgetLine& reversal = line_named(budget.contributions, "reversal EYY");
  EXPECT_NEAR(reversal.rms, 0.5 * b, 1e-12);
  EXPECT_EQ(reversal.depends_on_text(), "dir_y");
  EXPECT_NEAR(budget.total.rms, std::hypot(exx, 0.5 * b), 1e-12);
  EXPECT_NEAR(positioning.share, exx * exx / (exx * exx + 0.25 * b * b), 1e-9);
  EXPECT_NEAR(line_named(budget.causes, "positioning").share +
                  line_named(budget.causes, "effects beyond the rigid body").share,
              1.0, 1e-9);
  EXPECT_GE(budget.contributions[0].rms, budget.contributions[1].rms);
}

/// No table holds what a temperature moves: the line says that it depends on one, by its channel.
TEST(ErrorBudget, SaysThatTheExpansionOfAScaleDependsOnItsTemperature) {
  Machine machine = machine_with_a_tool();
  machine.axes[0].expansion = ScaleExpansion{10e-6, 0.0, "front scale"};
  const FitResult result = testing::result_with(machine, {}, 20);
  Conditions conditions;
  conditions.temperature_degC["front scale"] = 22.0;
  const ErrorBudget budget = error_budget(result, machine.tools[0], conditions, kCells);
  const BudgetLine& line = line_named(budget.contributions, "expansion X");
  const std::vector<Variable> wanted = {position_of(AxisName::X), temperature_of("front scale")};
  EXPECT_EQ(line.depends_on, wanted);
  EXPECT_EQ(line.depends_on_text(), "x T_front scale");
  EXPECT_TRUE(std::ranges::any_of(line.depends_on, &Variable::changes_at_rest));
  // 20e-6 over 1 m, a straight line: its root mean square is the length over sqrt(12).
  EXPECT_NEAR(line.rms, 20e-6 / std::sqrt(12.0), 0.01 * 20e-6);
}

/// Eight waves over the travel are zero at nine positions with equal distances; a bump of 20 mm lies between
/// them. Their mean squares are a^2 / 2, and of the bump a^2 (sqrt(pi) s - 2 pi s^2) about its mean.
TEST(ErrorBudget, SeesWavesAndWhatIsNarrow) {
  constexpr double kSize = 10e-6, kWidth = 0.02;
  const auto rms_of = [](const std::function<double(double)>& exx) {
    const FitResult result = testing::result_with(machine_with_a_tool(), {.functions = {{"EXX", exx}}}, 400);
    return error_budget(result, result.machine.tools[0], {}, kCells).total.rms;
  };
  const double of_waves = kSize / std::sqrt(2.0);
  EXPECT_NEAR(rms_of([](double q) { return kSize * std::sin(16.0 * std::numbers::pi * q); }), of_waves,
              0.03 * of_waves);
  const double of_bump =
      kSize * std::sqrt(std::sqrt(std::numbers::pi) * kWidth - 2.0 * std::numbers::pi * kWidth * kWidth);
  EXPECT_NEAR(rms_of([](double q) { return kSize * std::exp(-0.5 * std::pow((q - 0.437) / kWidth, 2)); }),
              of_bump, 0.03 * of_bump);
}

TEST(ErrorBudget, SharesAddUpToTheWholeWhateverCancels) {
  FitResult result =
      testing::result_with(machine_with_a_tool(),
                           {.functions = {{"EXX", [](double q) { return 2e-5 * std::sin(5.0 * q); }},
                                          {"EYX", [](double q) { return 1e-5 * std::cos(7.0 * q); }},
                                          {"EAY", [](double q) { return -3e-5 * std::sin(3.0 * q); }},
                                          {"ECZ", [](double q) { return 1e-5 * q * q; }}},
                            .locations = {{"EC0Y", 2e-5}}},
                           12);
  const ErrorBudget budget = error_budget(result, result.machine.tools[0], {}, kCells);
  const auto total = [](const std::vector<BudgetLine>& lines) {
    return std::accumulate(lines.begin(), lines.end(), 0.0,
                           [](double sum, const BudgetLine& line) { return sum + line.share; });
  };
  EXPECT_NEAR(total(budget.contributions), 1.0, 1e-9);
  EXPECT_NEAR(total(budget.causes), 1.0, 1e-9);
}

/// X, Y and Z to either side of 0, and a table that turns once.
Machine machine_with_table(double half_travel) {
  Machine machine = machine_of("w C' b X Y Z t");
  machine.tools = {{"short", {0.0, 0.0, -0.1}, 0.0}};
  for (Axis& axis : machine.axes) {
    axis.travel_max = is_rotary(axis.name) ? std::numbers::pi : half_travel;
    axis.travel_min = -axis.travel_max;
  }
  return machine;
}

/// A table whose angle is wrong by a sin q moves a point at the distance r of its axis by r a sin q: the mean
/// square is a^2 / 2 times that of r, which is 2 L^2 / 3 over X and Y from -L to L. Nothing of it is left
/// with the table at 0, and no rigid motion takes any of it.
TEST(ErrorBudget, IsOverTheTravelOfRotaryAxesWithErrors) {
  constexpr double kHalfTravel = 0.3, kAngle = 20e-6;
  const FitResult result =
      testing::result_with(machine_with_table(kHalfTravel),
                           {.functions = {{"ECC", [](double q) { return kAngle * std::sin(q); }}}}, 72);
  const ErrorBudget budget = error_budget(result, result.machine.tools[0], {}, kCells);
  EXPECT_EQ(budget.turned, std::vector{AxisName::C});
  EXPECT_TRUE(budget.at_rest.empty());
  const double expected = kAngle * kHalfTravel / std::sqrt(3.0);
  EXPECT_NEAR(line_named(budget.causes, "rotary axes").rms, expected, 0.02 * expected);
  EXPECT_NEAR(line_named(budget.causes, "rotary axes").share, 1.0, 1e-9);
  const ErrorBudget at_rest = error_budget(result, result.machine.tools[0], {}, kCells, RotaryPoses::AtRest);
  EXPECT_EQ(at_rest.at_rest, std::vector{AxisName::C});
  EXPECT_LT(at_rest.total.rms, 1e-12);
}

/// The same by an effect alone, a worm of three teeth.
TEST(ErrorBudget, IsOverTheTravelOfRotaryAxesWithEffects) {
  constexpr double kHalfTravel = 0.3, kAngle = 20e-6;
  ModelSpec model;
  model.default_function.basis = "zero";
  model.effects = {effect_spec("worm-error", {{"symbol", std::string("ECC")},
                                              {"period", 2.0 * std::numbers::pi / 3.0},
                                              {"cos", 0.0},
                                              {"sin", kAngle}})};
  const FitResult result = stated_result(machine_with_table(kHalfTravel), model);
  const ErrorBudget budget = error_budget(result, result.machine.tools[0], {}, kCells);
  EXPECT_EQ(budget.turned, std::vector{AxisName::C});
  EXPECT_TRUE(budget.at_rest.empty());
  const double expected = kAngle * kHalfTravel / std::sqrt(3.0);
  EXPECT_NEAR(budget.total.rms, expected, 0.03 * expected);
}

/// A reversal of the table's angle is +-b/2, as often either way.
TEST(ErrorBudget, ApproachesRotaryAxesFromBothSides) {
  constexpr double kHalfTravel = 0.3, kJump = 10e-6;
  const FitResult result = testing::result_with(
      machine_with_table(kHalfTravel),
      {.functions = {{"ECC", [](double) { return 0.0; }}}, .reversals = {{"ECC", kJump}}}, 72);
  const ErrorBudget budget = error_budget(result, result.machine.tools[0], {}, kCells);
  const double expected = 0.5 * kJump * kHalfTravel * std::sqrt(2.0 / 3.0);
  EXPECT_NEAR(budget.total.rms, expected, 0.02 * expected);
}

// A model with values is a machine whose errors are known: EXX of 10 um/m and an expansion of 11 um/m/K.
TEST(StatedErrors, AreThoseOfTheModelFile) {
  ModelSpec model;
  FunctionSpec exx;
  exx.degree = 1;
  exx.knots = KnotChoice::Explicit;
  exx.breakpoints = {0.0, 1.0};
  exx.coefficients = {0.0, 10e-6};
  model.functions[{Component::X, AxisName::X}] = exx;
  model.locations[*LocationSymbol::parse("EC0Y")] = 20e-6;
  model.effects = {
      effect_spec("scale-expansion",
                  {{"axis", std::string("X")}, {"temperature", std::string("bed")}, {"amplitude", 11e-6}})};
  const FitResult result = stated_result(machine_with_a_tool(), model);
  AxisPosition position{};
  position[0] = 0.5;
  position[1] = 0.25;
  const auto ex = [&](const std::map<std::string, std::string>& conditions) {
    return ErrorField(result, result.machine.tools[0], stated_conditions(result, conditions)).at(position)[0];
  };
  EXPECT_NEAR(ex({}), 5e-6 - 20e-6 * 0.25, 1e-12);
  EXPECT_NEAR(ex({{"T_bed", "24"}}), 5e-6 - 5e-6 + 4.0 * 11e-6 * 0.5, 1e-12);
}

/// 1 um a piece: cubic B-splines reproduce a straight line by its values at means of three knots.
TEST(StatedErrors, HoldEveryCoefficientOfACurve) {
  constexpr int kPieces = 12;
  std::vector<double> coefficients;
  const auto knot = [kPieces](int k) { return std::clamp(k, 0, kPieces); };
  for (int k = -2; k <= kPieces; ++k)
    coefficients.push_back(1e-6 * (knot(k) + knot(k + 1) + knot(k + 2)) / 3.0);
  ModelSpec model;
  model.effects = {effect_spec("empirical", {{"target", std::string("EYX")},
                                             {"drivers", std::string("x")},
                                             {"from", std::vector<double>{0.0}},
                                             {"to", std::vector<double>{1000.0}},
                                             {"pieces", std::vector<double>{kPieces}},
                                             {"coefficients", coefficients}})};
  const FitResult result = stated_result(machine_with_a_tool(), model);
  const ErrorField field(result, result.machine.tools[0]);
  for (const double x : {0.0, 0.5, 0.75, 1.0}) {
    AxisPosition position{};
    position[0] = x;
    EXPECT_NEAR(field.at(position)[1], 1e-6 * kPieces * x, 1e-12) << x;
  }
}

TEST(StatedErrors, KnowChannelsWithBlanksInTheirNames) {
  ModelSpec model;
  model.effects = {effect_spec(
      "thermal-drift",
      {{"symbol", std::string("EAY")}, {"temperature", std::string("front bearing")}, {"amplitude", 1e-6}})};
  const auto& channels = stated_result(machine_with_a_tool(), model).conditions.temperature_degC;
  ASSERT_EQ(channels.size(), 1U);
  EXPECT_EQ(channels.begin()->first, "front bearing");
}

TEST(StatedErrors, KnowTheTemperaturesOfLaws) {
  ModelSpec model;
  model.effects = {effect_spec("custom", {{"target", std::string("EYY")},
                                          {"expression", std::string("(T_bed - 20) * T_air")},
                                          {"amplitude", 1e-6}})};
  const FitResult result = stated_result(machine_with_a_tool(), model);
  const Conditions warm = stated_conditions(result, {{"T_bed", "23"}, {"T_air", "2"}});
  EXPECT_NEAR(ErrorField(result, result.machine.tools[0], warm).at(AxisPosition{})[1], 6e-6, 1e-12);
}

}  // namespace
}  // namespace volcal
