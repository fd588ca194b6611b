#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/paths.h"

namespace volcal::sim {
namespace {

constexpr double kMicroUnit = 1e-6;
constexpr double kHalfTurn = std::numbers::pi;

ErrorSymbol motion(const char* name) { return *ErrorSymbol::parse(name); }
LocationSymbol place(const char* name) { return *LocationSymbol::parse(name); }

Machine rotary_machine(const std::string& code) {
  return machine_from_code(code, {{{-0.3, 0.5}, {-0.2, 0.4}, {-0.4, 0.1}}});
}

TEST(RotaryDatum, AConstantIsALocationErrorOfTheSideItStandsOn) {
  for (const bool workpiece_side : {true, false}) {
    TruthMachine truth(rotary_machine(workpiece_side ? "w C' b X Y Z t" : "w b X Y Z C t"));
    int size = 0;
    for (const char* name : {"EXC", "EYC", "EZC", "EAC", "EBC", "ECC"})
      truth.set_error(motion(name), [c = ++size * kMicroUnit](double) { return c; });
    truth.set_location(place("EX0C"), 10.0 * kMicroUnit);
    const TruthInDatum tables(truth);
    const double s = workpiece_side ? -1.0 : 1.0;
    EXPECT_NEAR(tables.location(place("EX0C")), (10.0 + s * 1.0) * kMicroUnit, 1e-18);
    EXPECT_NEAR(tables.location(place("EY0C")), s * 2.0 * kMicroUnit, 1e-18);
    EXPECT_NEAR(tables.location(place("EZ0C")), s * 3.0 * kMicroUnit, 1e-18);
    EXPECT_NEAR(tables.location(place("EA0C")), s * 4.0 * kMicroUnit, 1e-18);
    EXPECT_NEAR(tables.location(place("EB0C")), s * 5.0 * kMicroUnit, 1e-18);
    EXPECT_NEAR(tables.location(place("EC0C")), 6.0 * kMicroUnit, 1e-18) << "no side: in the command's sense";
    for (const char* name : {"EXC", "EYC", "EZC", "EAC", "EBC", "ECC"})
      EXPECT_NEAR(tables.value(motion(name), 1.0), 0.0, 1e-18) << name;
  }
}

TEST(RotaryDatum, TransverseMotionsHaveNoMeanAndTheOthersAreZeroAtHome) {
  Machine machine = rotary_machine("w b X Y Z A t");
  Axis& axis = machine.axes.back();
  axis.travel_min = -1.0;
  axis.travel_max = 2.0;
  axis.home = 0.5;
  TruthMachine truth(machine);
  const auto square = [](double q) { return kMicroUnit * q * q; };
  for (const char* name : {"EXA", "EYA", "EZA", "EAA", "EBA", "ECA"}) truth.set_error(motion(name), square);
  const TruthInDatum tables(truth);
  // Mean of q^2 over [-1, 2]: (8 + 1) / 3 / 3 = 1; at home 0.25.
  for (const char* name : {"EYA", "EZA", "EBA", "ECA"})
    EXPECT_NEAR(tables.value(motion(name), 2.0), 3.0 * kMicroUnit, 1e-18) << name;
  for (const char* name : {"EXA", "EAA"})
    EXPECT_NEAR(tables.value(motion(name), 2.0), 3.75 * kMicroUnit, 1e-18) << name;
  EXPECT_NEAR(tables.location(place("EB0A")), 1.0 * kMicroUnit, 1e-18);
  EXPECT_NEAR(tables.location(place("EX0A")), 0.25 * kMicroUnit, 1e-18);
  EXPECT_NEAR(tables.location(place("EA0A")), 0.25 * kMicroUnit, 1e-18);
  EXPECT_NEAR(uniform_mean([](double q) { return std::sin(3.0 * q); }, 0.0, 1.0), (1.0 - std::cos(3.0)) / 3.0,
              1e-15);
  EXPECT_THROW(tables.location(place("EC0Y")), std::invalid_argument);
}

/// Middle of the circle that a point of the workpiece goes round in machine coordinates.
Eigen::Vector3d circle_centre(const TruthMachine& truth, const Eigen::Vector3d& point_w) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  constexpr int kPositions = 8;
  for (int i = 0; i < kPositions; ++i) {
    MachineState state;
    state.position[index_of(AxisName::C)] = 2.0 * kHalfTurn * i / kPositions;
    sum += (inverse(truth.pose(state, Eigen::Vector3d::Zero())) * point_w.homogeneous()).head<3>();
  }
  return sum / kPositions;
}

TEST(RotaryDatum, LocationErrorsAreThoseOfThePhysicalAxisOfATable) {
  Machine machine = rotary_machine("w C' b X Y Z t");
  machine.axes.front().centre = {0.01, 0.02, 0.0};
  TruthMachine truth(machine);
  truth.set_location(place("EX0C"), 10.0 * kMicroUnit);
  truth.set_location(place("EY0C"), 20.0 * kMicroUnit);
  truth.set_location(place("EA0C"), 30.0 * kMicroUnit);
  truth.set_location(place("EB0C"), 50.0 * kMicroUnit);
  const Eigen::Vector3d low = circle_centre(truth, {0.1, 0.0, 0.0}) - Eigen::Vector3d(0.01, 0.02, 0.0);
  EXPECT_LT((low.head<2>() - kMicroUnit * Eigen::Vector2d(10.0, 20.0)).norm(), 1e-9);
  const Eigen::Vector3d high = circle_centre(truth, {0.1, 0.0, 0.3}) - Eigen::Vector3d(0.01, 0.02, 0.3);
  EXPECT_LT((high.head<2>() - kMicroUnit * Eigen::Vector2d(25.0, 11.0)).norm(), 1e-9);
  MachineState state;
  state.position[index_of(AxisName::C)] = kHalfTurn / 4.0;
  const Eigen::Vector3d turned =
      inverse(TruthMachine(machine).pose(state, {0.0, 0.0, 0.0})).topLeftCorner<3, 3>() *
      Eigen::Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(turned.y(), turned.x()), -kHalfTurn / 4.0, 1e-15) << "the table turns the other way";
}

TEST(RotaryDatum, LocationErrorsOfACarriedAxisAddToThoseOfItsCarrier) {
  Machine machine = rotary_machine("w C' A' b X Y Z t");
  machine.axes[1].centre = {0.0, 0.0, 0.05};
  TruthMachine truth(machine);
  truth.set_location(place("EY0A"), 10.0 * kMicroUnit);
  truth.set_location(place("EZ0A"), -20.0 * kMicroUnit);
  truth.set_location(place("EB0A"), 60.0 * kMicroUnit);
  truth.set_location(place("EC0A"), -40.0 * kMicroUnit);
  truth.set_location(place("EX0C"), 5.0 * kMicroUnit);
  truth.set_location(place("EY0C"), 7.0 * kMicroUnit);
  truth.set_location(place("EA0C"), 30.0 * kMicroUnit);
  truth.set_location(place("EB0C"), -20.0 * kMicroUnit);
  // At machine zero X0C = 2, Y0C = 17 um, A0C = 30, B0C = 40 urad.
  const Eigen::Vector3d low = circle_centre(truth, {0.1, 0.0, 0.0});
  EXPECT_LT((low.head<2>() - kMicroUnit * Eigen::Vector2d(2.0, 17.0)).norm(), 2e-8);
  const Eigen::Vector3d high = circle_centre(truth, {0.1, 0.0, 0.3});
  EXPECT_LT((high.head<2>() - kMicroUnit * Eigen::Vector2d(2.0 + 12.0, 17.0 - 9.0)).norm(), 2e-8);
}

/// Nothing in datum form: slopes, home values and means everywhere.
TruthMachine crooked_rotary_machine(const std::string& code) {
  Machine machine = rotary_machine(code);
  for (Axis& axis : machine.axes) {
    axis.reference_point = {0.1, -0.2, 0.05};
    axis.centre = {0.03, -0.02, 0.04};
    axis.home = is_rotary(axis.name) ? 0.4 : 0.05;
  }
  TruthMachine truth(machine);
  double phase = 0.0;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      phase += 1.0;
      truth.set_error({component, axis.name}, [phase](double q) {
        return kMicroUnit *
               (3.0 * std::sin(3.0 * q + phase) + 4.0 * q * std::cos(phase) + std::cos(2 * phase));
      });
      if (is_rotary(axis.name))
        truth.set_location({component, axis.name}, kMicroUnit * std::sin(3.0 * phase));
    }
  }
  double value = 10.0 * kMicroUnit;
  for (const LocationSymbol& symbol : machine.datum.squareness())
    truth.set_location(symbol, value += 7.0 * kMicroUnit);
  return truth;
}

TruthMachine rotary_machine_of_tables(const TruthMachine& truth) {
  const TruthInDatum tables(truth);
  TruthMachine described(truth.machine());
  for (const Axis& axis : truth.machine().axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      described.set_error(symbol, [tables, symbol](double q) { return tables.value(symbol, q); });
      const LocationSymbol where{component, axis.name};
      if (is_rotary(axis.name)) described.set_location(where, tables.location(where));
    }
  }
  const auto symbols = tables.datum().squareness();
  for (std::size_t i = 0; i < 3; ++i) described.set_location(symbols[i], tables.squareness()[i]);
  return described;
}

/// Of the whole tool side against the datum's, where no rotary axis of a head takes it up.
Eigen::Vector3d rotation_of_tools(const TruthMachine& truth) {
  Eigen::Vector3d angles = -TruthInDatum(truth).frame_rotation();
  for (const Joint& joint : truth.machine().structure.joints) {
    if (is_rotary(joint.axis) && !joint.workpiece_side) return Eigen::Vector3d::Zero();
    if (is_rotary(joint.axis)) continue;
    const double home = truth.machine().axis(joint.axis).home;
    for (int k = 0; k < 3; ++k) {
      angles[k] += truth.function_value({kAllComponents[static_cast<std::size_t>(k) + 3], joint.axis}, home);
    }
  }
  return angles;
}

TEST(RotaryDatum, DescribesTheSameMachineAtRandomPoses) {
  for (const char* code : {"w C' A' Y' b X Z t", "w X' b Y Z C B t", "w C' X' b Y Z B t", "w C' B' b X Y Z t",
                           "w C' b X Y Z t", "w b X Y Z B t"}) {
    const TruthMachine truth = crooked_rotary_machine(code);
    const TruthMachine described = rotary_machine_of_tables(truth);
    const Eigen::Vector3d turn = rotation_of_tools(truth);
    RandomStream random(5, "poses");
    std::vector<Eigen::Vector3d> point, difference;
    double largest = 0.0;
    for (const CommandedPoint& commanded :
         random_points(truth.machine(), 300, random, RotaryMotion::Random)) {
      MachineState state;
      state.position = commanded.position;
      for (const Tool& tool : truth.machine().tools) {
        const Eigen::Vector3d turned = tool.offset + turn.cross(tool.offset);
        point.push_back(truth.nominal_point(state, tool.offset));
        difference.emplace_back(truth.point(state, tool.offset) - described.point(state, turned));
        largest = std::max(largest, truth.point_error(state, tool.offset).norm());
      }
    }
    EXPECT_LT(rms_after_alignment(point, difference), 3e-9) << code;
    EXPECT_GT(largest, 5.0 * kMicroUnit) << code;
  }
}

TEST(RandomTruth, ErrorsOfAnAxisThatTurnsRightRoundComeBack) {
  Machine machine = rotary_machine("w C' A' b X Y Z t");
  machine.axes[1].travel_min = -0.5 * kHalfTurn;
  machine.axes[1].travel_max = 0.5 * kHalfTurn;
  const TruthMachine truth = random_truth(machine, 4);
  const TruthInDatum tables(truth);
  for (const Component component : kAllComponents) {
    const ErrorSymbol symbol{component, AxisName::C};
    EXPECT_NEAR(truth.function_value(symbol, -kHalfTurn), truth.function_value(symbol, kHalfTurn), 1e-18);
    EXPECT_NE(tables.value(symbol, 1.0), 0.0);
  }
  EXPECT_EQ(truth.function_value(motion("EXA"), 0.0), 0.0);
  EXPECT_NE(truth.function_value(motion("EXA"), 1.0), 0.0);
  const auto of_tables = [&](double q) { return tables.value(motion("EYA"), q); };
  EXPECT_LT(std::abs(uniform_mean(of_tables, -0.5 * kHalfTurn, 0.5 * kHalfTurn)), 1e-18);
}

}  // namespace
}  // namespace volcal::sim
