#include "volcal/identify/errors/design_stage.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr int kPerAxis = 7;  // positions of machines that are drawn, and cells of budgets
constexpr int kMachines = 1000;

Machine designed_machine() {
  Machine machine = testing_support::machine_of("wX'bYZt");
  const double travel[3][2] = {{-0.4, 0.4}, {0.0, 0.5}, {-0.3, 0.0}};
  for (Axis& axis : machine.axes) {
    const auto k = static_cast<std::size_t>(direction_of(axis.name));
    axis.travel_min = axis.home = travel[k][0];
    axis.travel_max = travel[k][1];
  }
  machine.axes[0].reference_point = {0.0, -0.2, -0.3};
  machine.axes[1].reference_point = {0.3, 0.0, -0.1};
  machine.axes[2].reference_point = {0.0, 0.15, 0.2};
  machine.tools = {{"long", {0.0, 0.05, -0.25}, 0.0}};
  return machine;
}

Tolerances tolerances_of(const Machine& machine) {
  Tolerances tolerances;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      tolerances.functions[symbol] = is_rotation(component) ? 15e-6 : symbol.is_positioning() ? 10e-6 : 8e-6;
    }
  }
  for (const LocationSymbol symbol : machine.datum.squareness()) tolerances.squareness[symbol] = 20e-6;
  return tolerances;
}

/// A random function of a band of width 1, as the header says, by sums in place of integrals.
std::function<double(double)> random_function(const Axis& axis, bool is_straightness,
                                              std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double u = 1.0 / (2.0 * std::sqrt(3.0));
  constexpr int kStepsOfSum = 2000;
  std::vector<std::function<double(double)>> parts;
  std::vector<double> shares;
  if (!is_straightness) {
    parts.emplace_back([](double t) { return t; });
    shares.push_back(0.5);
  }
  const double of_waves = is_straightness ? 1.0 : 0.5;
  for (int k = 1; k <= 2; ++k) {
    for (const bool sine : {true, false}) {
      parts.emplace_back([=](double t) {
        const double angle = 2.0 * std::numbers::pi * k * t;
        return sine ? std::sin(angle) : std::cos(angle);
      });
      shares.push_back(of_waves * (k == 1 ? 2.0 / 3.0 : 1.0 / 3.0) / 2.0);
    }
  }
  std::vector<std::array<double, 2>> terms;  // factor, slope that is taken out
  for (std::size_t p = 0; p < parts.size(); ++p) {
    double slope = 0.0, square = 0.0;
    for (const int pass : {0, 1}) {
      for (int i = 0; i < kStepsOfSum; ++i) {
        const double t = (i + 0.5) / kStepsOfSum - 0.5;
        if (pass == 0 && is_straightness) slope += 12.0 * t * parts[p](t) / kStepsOfSum;
        if (pass == 1) square += std::pow(parts[p](t) - slope * t, 2) / kStepsOfSum;
      }
    }
    terms.push_back({u * normal(random) * std::sqrt(shares[p] / square), slope});
  }
  const auto raw = [=](double q) {
    const double t = (q - axis.travel_min) / axis.travel() - 0.5;
    double sum = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p) sum += terms[p][0] * (parts[p](t) - terms[p][1] * t);
    return sum;
  };
  return [=, at_home = raw(axis.home)](double q) { return raw(q) - at_home; };
}

/// Displacement of the tool by one error of a machine w X' b Y Z t, by the arms of DESIGN's first-order
/// formula: arm = point - reference point - what the axes nearer the workpiece moved, and the axis itself on
/// the tool side.
Vector3d displacement(const Machine& machine, const std::string& name, const Vector3d& q, double value) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  if (name == "EC0Y") return -value * q.y() * x;
  if (name == "EB0Z") return value * q.z() * x;
  if (name == "EA0Z") return -value * q.z() * y;
  const ErrorSymbol symbol = *ErrorSymbol::parse(name);
  const Vector3d unit = Vector3d::Unit(direction_of(symbol.component));
  if (!is_rotation(symbol.component)) return value * unit;
  Vector3d origin = machine.axis(symbol.axis).reference_point;
  if (symbol.axis != AxisName::X) origin += q.x() * x + q.y() * y;
  if (symbol.axis == AxisName::Z) origin += q.z() * z;
  return value * unit.cross(q + machine.tools[0].offset - origin);
}

std::vector<Vector3d> volume(const Machine& machine) {
  std::vector<Vector3d> points;
  const auto at = [&](AxisName name, int i) {
    const Axis& axis = machine.axis(name);
    return axis.travel_min + axis.travel() * (i + 0.5) / kPerAxis;
  };
  for (int i = 0; i < kPerAxis; ++i) {
    for (int j = 0; j < kPerAxis; ++j) {
      for (int k = 0; k < kPerAxis; ++k)
        points.emplace_back(at(AxisName::X, i), at(AxisName::Y, j), at(AxisName::Z, k));
    }
  }
  return points;
}

struct MachineMoments {
  double sum = 0.0;
  double squares = 0.0;

  void add(double value) {
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / kMachines; }
  double error() const { return std::sqrt((squares / kMachines - mean() * mean()) / kMachines); }
};

// Machines are drawn, every one aligned by its best rigid motion: the mean squares are those of the budget.
TEST(DesignStage, BudgetIsTheMeanOfMachinesThatAreDrawn) {
  const Machine machine = designed_machine();
  const Tolerances tolerances = tolerances_of(machine);
  const ErrorBudget budget =
      error_budget(result_of_tolerances(machine, tolerances), machine.tools[0], {}, kPerAxis);
  const std::vector<Vector3d> points = volume(machine);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> band(-0.5, 0.5);
  std::map<std::string, MachineMoments> squares;
  int above = 0;
  for (int drawn = 0; drawn < kMachines; ++drawn) {
    std::vector<Vector3d> whole(points.size(), Vector3d::Zero());
    const auto add = [&](const std::string& name, const std::function<double(const Vector3d&)>& value) {
      std::vector<Vector3d> field;
      for (std::size_t i = 0; i < points.size(); ++i) {
        field.push_back(displacement(machine, name, points[i], value(points[i])));
        whole[i] += field.back();
      }
      if (name == "EBY" || name == "EXX" || name == "EZX" || name == "EC0Y")
        squares[name].add(std::pow(sim::rms_after_alignment(points, field), 2));
    };
    for (const auto& [symbol, width] : tolerances.functions) {
      const auto function = random_function(machine.axis(symbol.axis), symbol.is_straightness(), random);
      add(symbol.name(),
          [&, k = direction_of(symbol.axis), w = width](const Vector3d& q) { return w * function(q[k]); });
    }
    for (const auto& [symbol, width] : tolerances.squareness)
      add(symbol.name(), [value = width * band(random)](const Vector3d&) { return value; });
    const double rms = sim::rms_after_alignment(points, whole);
    squares["all"].add(rms * rms);
    above += rms > budget.rms_95 ? 1 : 0;
  }
  for (const auto& [name, drawn] : squares) {
    const auto line = std::ranges::find(budget.contributions, name, &BudgetLine::name);
    const double expected = name == "all" ? budget.total.u_rms : line->u_rms;
    EXPECT_NEAR(expected * expected, drawn.mean(), 4.0 * drawn.error()) << name;
    EXPECT_LT(drawn.error(), 0.05 * drawn.mean()) << name;
  }
  const double share = static_cast<double>(above) / kMachines;
  EXPECT_NEAR(share, 0.05, 4.0 * std::sqrt(0.05 * 0.95 / kMachines) + 0.005);
  double sum = 0.0;
  for (const BudgetLine& line : budget.contributions) sum += line.expected_share;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

// A slope that fills its band T over the travel has the mean square T^2 / 12 about its middle.
TEST(DesignStage, StandardUncertaintyOfABand) { EXPECT_NEAR(band_uncertainty(12.0), std::sqrt(12.0), 1e-12); }

// One axis of 1 m: the mean square of a positioning error about its mean is T^2 / 12, whatever its home.
TEST(DesignStage, MeanSquareIsThatOfTheBandWhateverTheHome) {
  for (const double home : {0.0, 0.3, 1.0}) {
    Machine machine = testing_support::machine_of("wbXt");
    machine.axes[0].home = home;
    machine.tools = {{"t", Vector3d::Zero(), 0.0}};
    for (const char* name : {"EXX", "EYX"}) {
      Tolerances tolerances;
      tolerances.functions[*ErrorSymbol::parse(name)] = 12e-6;
      constexpr int kMany = 300;
      const ErrorBudget budget =
          error_budget(result_of_tolerances(machine, tolerances), machine.tools[0], {}, kMany);
      EXPECT_NEAR(budget.total.u_rms, std::sqrt(12.0) * 1e-6, 0.1e-6) << name << " home " << home;
      EXPECT_EQ(budget.total.rms, 0.0);
    }
  }
}

TEST(DesignStage, ExpansionIsAsUncertainAsItsCoefficient) {
  Machine machine = designed_machine();
  machine.axes[0].expansion = ScaleExpansion{11e-6, 1e-6, "bed"};
  Tolerances tolerances;
  tolerances.functions[*ErrorSymbol::parse("EYY")] = 1e-6;
  const FitResult result = result_of_tolerances(machine, tolerances);
  const auto share = [&](const char* degC) {
    const ErrorBudget budget =
        error_budget(result, machine.tools[0], stated_conditions(result, {{"T_bed", degC}}), kPerAxis);
    return *std::ranges::find(budget.contributions, "expansion X", &BudgetLine::name);
  };
  EXPECT_EQ(share("20").u_rms, 0.0);
  const BudgetLine warm = share("25");
  EXPECT_GT(warm.rms, 0.0);
  EXPECT_NEAR(warm.u_rms / warm.rms, 1.0 / 11.0, 1e-9);
}

}  // namespace
}  // namespace volcal
