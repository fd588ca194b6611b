/// Hidden effects that act on the machine's error motions, by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "volcal/sim/hidden/hidden_effects.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal::sim {
namespace {

Options options(const std::vector<std::pair<std::string, OptionValue>>& entries) {
  Options made;
  for (const auto& [stem, value] : entries) made.set(stem, value);
  return made;
}

std::string text(const char* value) { return value; }

/// Travels of 1 m from -0.2 m (home there), 0.5 m and 0.4 m from 0; channels that stand still, and "ramp".
class HiddenMachine : public ::testing::Test {
 protected:
  HiddenMachine() {
    environment_.channels = {{.name = "air", .start = 22.0},
                             {.name = "column", .start = 25.0},
                             {.name = "ramp", .start = 20.0, .drift = 1e-3}};
    state_.position = {0.3, 0.1, 0.3, 0, 0, 0};
    state_.direction = {1, -1, 1, 0, 0, 0};
    state_.time = 1800.0;
    state_.temperature = environment_.temperatures(state_.time);
  }

  TruthMachine with(const HiddenEffect& effect, double amplitude) const {
    TruthMachine machine(machine_);
    Interference interference;
    HiddenScene scene{machine, interference};
    add_hidden(effect, amplitude, {machine_, environment_, plans_}, scene);
    return machine;
  }

  /// Value of an error motion that a hidden effect of amplitude 1 gives at the state.
  double error(const char* symbol, const HiddenEffect& effect) const {
    return with(effect, 1.0).error(*ErrorSymbol::parse(symbol), state_);
  }

  Machine machine_ = machine_from_code("w b X Y Z t", {{{-0.2, 0.8}, {0.0, 0.5}, {0.0, 0.4}}});
  Environment environment_;
  std::vector<SetupPlan> plans_;
  MachineState state_;
};

constexpr double kTiny = 1e-14;

TEST_F(HiddenMachine, ReversalByDirectionOfItsOwnAxis) {
  EXPECT_EQ(error("EXX", {"reversal", options({{"symbol", text("EXX")}})}), 0.5);
  EXPECT_EQ(error("EAY", {"reversal", options({{"symbol", text("EAY")}})}), -0.5);
  EXPECT_EQ(error("EXX", {"reversal", options({{"symbol", text("EAY")}})}), 0.0);
  state_.direction[0] = 0;
  EXPECT_EQ(error("EXX", {"reversal", options({{"symbol", text("EXX")}})}), 0.0);
}

TEST_F(HiddenMachine, OneCauseMovesEveryAxisByItsOwnState) {
  const HiddenEffect backlash{"common-reversal", options({{"axes", text("X Y")}})};
  EXPECT_EQ(error("EXX", backlash), 0.5);
  EXPECT_EQ(error("EYY", backlash), -0.5);
  EXPECT_EQ(error("EZZ", backlash), 0.0);
  // 5 K of the column; home of X at -0.2 m, of Y at 0
  const HiddenEffect scales{"common-expansion",
                            options({{"axes", text("X Y")}, {"channel", text("column")}})};
  EXPECT_NEAR(error("EXX", scales), 5.0 * 0.5, kTiny);
  EXPECT_NEAR(error("EYY", scales), 5.0 * 0.1, kTiny);
  // half an hour with a time constant of as much
  const HiddenEffect warming{"common-growth", options({{"axes", text("Y X")}, {"time_constant", 1800.0}})};
  EXPECT_NEAR(error("EXX", warming), 0.5 * (1.0 - std::exp(-1.0)), kTiny);
  EXPECT_NEAR(error("EYY", warming), 0.1 * (1.0 - std::exp(-1.0)), kTiny);
  for (const char* wrong : {"X", "X X", "X C", "X Q"})
    EXPECT_THROW(with({"common-reversal", options({{"axes", text(wrong)}})}, 1.0), InputError) << wrong;
}

TEST_F(HiddenMachine, ReversalGrowsAlongTheTravel) {
  // u = (0.3 + 0.2) / 1
  EXPECT_NEAR(error("EXX", {"reversal-position", options({{"symbol", text("EXX")}})}), 0.25, kTiny);
  // beyond the kink at 0.1: (0.3 - 0.1) / 1, halved
  EXPECT_NEAR(error("EXX", {"backlash-kink", options({{"symbol", text("EXX")}, {"position", 0.1}})}), 0.1,
              kTiny);
  EXPECT_EQ(error("EXX", {"backlash-kink", options({{"symbol", text("EXX")}, {"position", 0.4}})}), 0.0);
}

TEST_F(HiddenMachine, WavesOfAScrew) {
  // 0.3 m is 30.25 periods and 30 deg more: 120 deg
  const double period = 0.3 / 30.25;
  Options wave = options({{"symbol", text("EXX")}, {"period", period}, {"phase", std::numbers::pi / 6}});
  EXPECT_NEAR(error("EXX", {"screw-lead", wave}), std::sqrt(0.75), 1e-12);
  wave.set("second_harmonic", 0.5);
  wave.set("third_harmonic", 0.25);
  EXPECT_NEAR(error("EXX", {"screw-lead", wave}), std::sqrt(0.75) * (1.0 - 0.5), 1e-12);
  EXPECT_NEAR(error("EXX", {"encoder-subdivision", wave}), std::sqrt(0.75) * (1.0 - 0.5), 1e-12);
  EXPECT_NEAR(error("EXX", {"triangle-wave", options({{"symbol", text("EXX")}, {"period", period}})}), 0.0,
              1e-11);
  EXPECT_NEAR(error("EXX", {"triangle-wave", options({{"symbol", text("EXX")}, {"period", 0.6}})}), 1.0,
              1e-12);
  EXPECT_NEAR(error("EXX", {"triangle-wave", options({{"symbol", text("EXX")}, {"period", 0.3}})}), -1.0,
              1e-12);
  EXPECT_NEAR(
      error("EXX", {"cross-wave", options({{"symbol", text("EXX")}, {"by", text("Z")}, {"period", 0.4}})}),
      -1.0, 1e-12);  // z = 0.3 is three quarters
}

TEST_F(HiddenMachine, HeatingGrowsInTime) {
  const double grown = 1.0 - std::exp(-2.0);  // 1800 s of 900 s
  EXPECT_NEAR(error("EXX", {"screw-heating", options({{"axis", text("X")}, {"time_constant", 900.0}})}),
              0.5 * grown, kTiny);
  const Options zone =
      options({{"axis", text("X")}, {"centre", 0.3}, {"width", 0.25}, {"time_constant", 900.0}});
  // From home, two widths below the centre, to the centre: erf(2 / sqrt 2) / 2
  EXPECT_NEAR(error("EXX", {"heated-zone", zone}), 0.5 * std::erf(std::numbers::sqrt2) * grown, kTiny);
  EXPECT_NEAR(error("EAX", {"root-time", options({{"symbol", text("EAX")}})}), std::sqrt(0.5), kTiny);
  EXPECT_NEAR(error("EAX", {"root-time", options({{"symbol", text("EAX")}, {"by", text("Y")}})}),
              0.2 * std::sqrt(0.5), kTiny);
}

TEST_F(HiddenMachine, Temperatures) {
  // air + 2 K, column + 5 K, ramp + 1.8 K
  EXPECT_NEAR(error("EXX", {"scale-expansion", options({{"axis", text("X")}, {"channel", text("air")}})}),
              2.0 * 0.5, kTiny);
  EXPECT_NEAR(error("EAZ", {"thermal-tilt", options({{"symbol", text("EAZ")}, {"channel", text("column")}})}),
              5.0, kTiny);
  EXPECT_NEAR(
      error("EAZ", {"thermal-tilt",
                    options({{"symbol", text("EAZ")}, {"channel", text("column")}, {"by", text("Z")}})}),
      5.0 * 0.75, kTiny);
  EXPECT_NEAR(
      error("EXX", {"direction-temperature", options({{"symbol", text("EXX")}, {"channel", text("ramp")}})}),
      0.9, 1e-12);
  EXPECT_NEAR(
      error("EXX", {"temperature-squared", options({{"symbol", text("EXX")}, {"channel", text("air")}})}),
      4.0, kTiny);
  EXPECT_NEAR(error("EBZ", {"gradient-bending", options({{"symbol", text("EBZ")},
                                                         {"channel", text("column")},
                                                         {"minus", text("air")},
                                                         {"by", text("Z")}})}),
              3.0 * 0.75, kTiny);
  const double lagging = 1e-3 * (1800.0 - 600.0 * (1.0 - std::exp(-3.0)));
  const HiddenEffect lagged{
      "lagged-temperature",
      options({{"symbol", text("EAZ")}, {"channel", text("ramp")}, {"time_constant", 600.0}})};
  EXPECT_NEAR(error("EAZ", lagged), lagging, 1e-12);
  state_.settled = true;
  EXPECT_EQ(error("EAZ", lagged), 0.0);
}

TEST_F(HiddenMachine, OtherAxes) {
  const auto cross = [&](double power) {
    return error("EAY",
                 {"cross-axis", options({{"symbol", text("EAY")}, {"by", text("Z")}, {"power", power}})});
  };
  EXPECT_NEAR(cross(1.0), 0.75, kTiny);
  EXPECT_NEAR(cross(2.0), 0.5625, kTiny);
  EXPECT_NEAR(cross(3.0), 0.421875, kTiny);
  EXPECT_NEAR(error("EBX", {"cross-product",
                            options({{"symbol", text("EBX")}, {"by", text("Y")}, {"and", text("Z")}})}),
              0.2 * 0.75, kTiny);
  EXPECT_NEAR(
      error("EZY", {"cross-kink", options({{"symbol", text("EZY")}, {"by", text("X")}, {"position", 0.1}})}),
      0.2, kTiny);
  EXPECT_NEAR(error("EZY", {"position-step",
                            options({{"symbol", text("EZY")}, {"by", text("X")}, {"position", 0.29}})}),
              1.0, kTiny);
  EXPECT_EQ(error("EZY", {"position-step", options({{"symbol", text("EZY")}, {"position", 0.11}})}), 0.0);
  const Options bump = options({{"symbol", text("EZY")},
                                {"centre", 0.15},
                                {"width", 0.05},
                                {"by", text("X")},
                                {"by_centre", 0.5},
                                {"by_width", 0.1}});
  EXPECT_NEAR(error("EZY", {"local-bump", bump}), std::exp(-0.5 - 2.0), kTiny);
}

TEST_F(HiddenMachine, Loads) {
  const HiddenEffect heavy{"tool-load",
                           options({{"symbol", text("EAZ")}, {"tool", text("side_x")}, {"by", text("Z")}})};
  EXPECT_EQ(error("EAZ", heavy), 0.0);
  state_.tool = 1;
  EXPECT_NEAR(error("EAZ", heavy), 0.75, kTiny);
}

TEST_F(HiddenMachine, VelocityAndTheWaySinceTheAxisTurned) {
  state_.velocity = {0.05, 0, 0, 0, 0, 0};
  state_.since_reversal = {0.02, 0, 0, 0, 0, 0};
  // 1 m of lag at 1 m/min = 1/60 m/s
  EXPECT_NEAR(error("EXX", {"servo-mismatch", options({{"axis", text("X")}})}), -3.0, kTiny);
  EXPECT_NEAR(error("EXX", {"reversal-spike", options({{"symbol", text("EXX")}, {"length", 0.01}})}),
              0.5 * std::exp(-2.0), kTiny);
  EXPECT_NEAR(error("EXX", {"direction-memory",
                            options({{"symbol", text("EXX")}, {"length", 0.01}, {"time_constant", 0.2}})}),
              0.5 * (1.0 - 2.0 * std::exp(-1.0)), kTiny);
}

TEST_F(HiddenMachine, SquarenessDriftTurnsTheAxis) {
  // EC0Y = 0.5 h x 20 urad/h turns Y towards -x: at y = 0.1 m by 1 um.
  const TruthMachine drifting = with({"squareness-drift", options({{"symbol", text("EC0Y")}})}, 20e-6);
  Eigen::Vector3d moved = drifting.point_error(state_, Eigen::Vector3d::Zero());
  EXPECT_LT((moved - Eigen::Vector3d(-1e-6, 0, 0)).norm(), 1e-11);
  EXPECT_EQ(drifting.location(*LocationSymbol::parse("EC0Y")), 0.0);
  EXPECT_NEAR(drifting.location(*LocationSymbol::parse("EC0Y"), state_), 10e-6, 1e-18);
  // EA0Z = 5 K x 2 urad/K turns Z towards -y: at z = 0.3 m by 3 um.
  moved = with({"squareness-channel", options({{"symbol", text("EA0Z")}, {"channel", text("column")}})}, 2e-6)
              .point_error(state_, Eigen::Vector3d::Zero());
  EXPECT_LT((moved - Eigen::Vector3d(0, -3e-6, 0)).norm(), 1e-10);
}

TEST_F(HiddenMachine, RamDroopGoesThroughTheExactTransforms) {
  // EAY = 40 urad x 0.75 about the point (0, y, 0): the tool point 0.15 m above it (z = 0.3 - 0.15) moves
  // by -30 urad x 0.15 m in y.
  const HiddenEffect droop{"cross-axis", options({{"symbol", text("EAY")}, {"by", text("Z")}})};
  const Eigen::Vector3d moved = with(droop, 40e-6).point_error(state_, {0.0, 0.0, -0.15});
  EXPECT_LT((moved - Eigen::Vector3d(0.0, -4.5e-6, 0.0)).norm(), 2e-10);
}

TEST_F(HiddenMachine, NamesWhatDoesNotExist) {
  const auto rejects = [&](const HiddenEffect& effect, const std::string& expected) {
    try {
      with(effect, 1e-6);
      ADD_FAILURE() << effect.kind << " accepted, expected: " << expected;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
      EXPECT_FALSE(error.remedy().empty());
    }
  };
  rejects({"reversl", {}}, "reversl");
  rejects({"reversal", {}}, "symbol");
  rejects({"reversal", options({{"symbol", text("EXC")}})}, "EXC");
  rejects({"thermal-tilt", options({{"symbol", text("EAZ")}, {"channel", text("oil")}})}, "oil");
  rejects({"tool-load", options({{"symbol", text("EAZ")}, {"tool", text("long")}})}, "long");
  rejects({"squareness-drift", options({{"symbol", text("EA0Y")}})}, "EC0Y, EA0Z, EB0Z");
  rejects({"cross-axis", options({{"symbol", text("EXX")}, {"by", text("X")}})}, "depends on X");
  rejects({"cross-axis", options({{"symbol", text("EXX")}, {"by", text("Y")}, {"power", 4.0}})}, "power");
  rejects({"cross-product", options({{"symbol", text("EXX")}, {"by", text("Y")}, {"and", text("Y")}})},
          "one axis");
  rejects({"screw-lead", options({{"symbol", text("EXX")}, {"period", 0.0}})}, "period");
  rejects({"screw-heating", options({{"axis", text("C")}, {"time_constant", 1.0}})}, "\"C\"");
}

TEST(LaggedTemperature, FollowsTheDifferentialEquation) {
  const TemperatureChannel channel{"air", 21.0, 2e-4, 0.8, 5000.0, 0.7, 1.5, 4000.0};
  constexpr double kTimeConstant = 900.0;
  constexpr double kStep = 0.5;
  double followed = channel.at(0.0);
  EXPECT_NEAR(channel.lagged(0.0, kTimeConstant), followed, 1e-12);
  for (int i = 0; i < 24000; ++i) {
    const double middle = (i + 0.5) * kStep;
    const double kept = std::exp(-kStep / kTimeConstant);
    followed = channel.at(middle) + (followed - channel.at(middle)) * kept;
    if (i % 4000 != 3999) continue;
    EXPECT_NEAR(channel.lagged((i + 1) * kStep, kTimeConstant), followed, 2e-6) << i;
  }
}

}  // namespace
}  // namespace volcal::sim
