// A machine with known errors, measured without noise by the simulator, which evaluates functions and effects
// by code of its own: the model that states the errors explains every reading.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/support/five_axis.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/sim/known/known_errors.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

constexpr double kFirstOrder = 10e-9;  // m: errors of 20 um and 50 urad, squared, over a metre
constexpr const char* kChannel = "column";
constexpr double kPreTravel = 0.3;  // m
constexpr const char* kOfRotaryAxes[] = {"cradle-coupling", "ring-eccentricity", "tilt-load", "worm-error"};

Machine machine_with_homes() {
  Machine machine = sim::reference_machines()[0];
  for (Axis& axis : machine.axes) axis.home = axis.travel_min + 0.3 * axis.travel();
  return machine;
}

/// Splines of every degree, Legendre series, squareness: displacements of some 10 um, rotations of 20 urad.
ModelSpec known_functions(const Machine& machine, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  ModelSpec model;
  model.default_function.basis = "zero";
  int turn = 0;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      FunctionSpec spec;
      switch (turn++ % 5) {
        case 0:
        case 1:
        case 2:
          spec.degree = turn % 5;
          if (spec.degree == 0) spec.degree = 3;
          spec.knots = KnotChoice::IntervalCount;
          spec.intervals = 4;
          break;
        case 3:
          spec.degree = 3;
          spec.knots = KnotChoice::Explicit;
          spec.breakpoints = {axis.travel_min, axis.travel_min + 0.2 * axis.travel(),
                              axis.travel_min + 0.7 * axis.travel(), axis.travel_max};
          break;
        default:
          spec.basis = "legendre";
          spec.degree = 6;
      }
      if (spec.knots == KnotChoice::IntervalCount)
        spec.breakpoints = uniform_breakpoints(axis, spec.intervals);
      const int size = find_basis(spec.basis)->make(spec, axis)->size();
      for (int i = 0; i < size; ++i)
        spec.coefficients.push_back((is_rotation(component) ? 20e-6 : 10e-6) * normal(random));
      model.functions[{component, axis.name}] = spec;
    }
  }
  for (const LocationSymbol symbol : machine.datum.squareness())
    model.locations[symbol] = 30e-6 * normal(random);
  return model;
}

/// Errors of points all over the volume from both directions, lengths from stations, temperatures that drift.
Campaign measured_without_noise(const Machine& machine, const ModelSpec& errors) {
  sim::Study study;
  study.machine = machine;
  study.truth.errors = errors;
  study.environment.channels = {{.name = kChannel, .start = 21.0, .drift = 1.5 / 3600.0}};
  sim::PointGrid grid;
  grid.rigid_alignment = false;
  grid.alignment_shift = grid.alignment_rotation = 0.0;
  study.measurements.push_back({"grid", grid});
  sim::Tracking tracking;
  tracking.grid = {4, 4, 3};
  tracking.station_guess_error = 0.0;  // a length that is too long by a share counts from the guess
  study.measurements.push_back({"", tracking});
  sim::BallBarCircles circles;
  circles.length_sigma = 0.0;
  study.measurements.push_back({"", circles});
  sim::AxisLines lines;
  study.measurements.push_back({"", lines});
  for (sim::Measurement& measurement : study.measurements) {
    std::visit(
        [](auto& settings) {
          if constexpr (requires { settings.noise; }) settings.noise = {};
        },
        measurement.settings);
  }
  Campaign campaign = sim::simulate(study).campaign;
  for (Setup& setup : campaign.setups) {
    setup.noise.set("constant", 0.1e-6);
    setup.repeatability = 0.0;
  }
  return campaign;
}

double largest_residual(const Campaign& campaign, const ModelSpec& model) {
  double largest = 0.0;
  for (const ResidualRecord& record : evaluate_model(campaign, model, nullptr, 1).residuals)
    largest = std::max(largest, std::abs(record.residual()));
  return largest;
}

TEST(KnownTruth, FunctionsAndSquarenessAreThoseOfTheModel) {
  const Machine machine = machine_with_homes();
  const ModelSpec model = known_functions(machine, 3);
  const Campaign campaign = measured_without_noise(machine, model);
  EXPECT_GT(largest_residual(campaign, nominal_model()), 20e-6);
  EXPECT_LT(largest_residual(campaign, model), kFirstOrder);
}

/// y from 10 % of its travel to its end and the temperature, 3 and 2 pieces, for approaches of Z.
void add_surface(const Machine& machine, EffectSpec& spec) {
  const Axis& y = machine.axis(AxisName::Y);
  spec.options.set("drivers", std::string("y T_column"));
  spec.options.set("factor", std::string("dir_z"));
  spec.options.set("from", std::vector<double>{1e3 * (y.travel_min + 0.1 * y.travel()), 20.5});
  spec.options.set("to", std::vector<double>{1e3 * y.travel_max, 24.0});
  spec.options.set("pieces", std::vector<double>{3.0, 2.0});
  std::vector<double> coefficients;
  for (int i = 0; i < 6 * 5; ++i) coefficients.push_back(12e-6 * std::sin(i));
  spec.options.set("coefficients", coefficients);
}

/// One of every kind that the simulator knows, with its amplitudes: a few micrometres over the travel.
EffectSpec example_of(const std::string& kind, const Machine& machine) {
  EffectSpec spec;
  spec.kind = kind;
  const auto has = [&](const std::string& stem) {
    return std::ranges::any_of(find_effect(kind)->schema().keys, [&](const KeySchema& key) {
      return key.key == stem || key.key.starts_with(stem + "_");
    });
  };
  if (has("symbol")) spec.options.set("symbol", std::string(kind == "squareness-drift" ? "EC0Y" : "EBX"));
  if (kind == "triple-coupling") {
    spec.options.set("axes", std::string("Y Z Z"));
  } else if (has("axes")) {
    spec.options.set("axes", std::string("X Y Z"));
  }
  if (has("target")) spec.options.set("target", std::string("EBX"));
  if (kind == "custom") {
    spec.options.set("expression", std::string("z / 1000 * (T_column - 20) + p * dir_x * exp(-t / 900)"));
    spec.options.set("p", 0.3);
  }
  if (kind == "empirical") add_surface(machine, spec);
  if (kind == "product-coupling") spec.options.set("second_axis", std::string("Z"));
  if (has("symbols")) spec.options.set("symbols", std::string("EXX EYY EZZ"));
  if (has("axis")) spec.options.set("axis", std::string("Y"));
  if (has("temperature")) spec.options.set("temperature", std::string(kChannel));
  if (has("tool")) spec.options.set("tool", machine.tools[1].name);
  if (kind == "axis-coupling") spec.options.set("shape", std::string("quadratic"));
  if (kind == "pre-travel") spec.options.set("length", kPreTravel);
  if (has("period")) spec.options.set("period", 0.137);
  if (has("time_constant")) spec.options.set("time_constant", 900.0);
  if (kind.starts_with("station-")) spec.options.set("station", std::string("P2"));
  if (kind == "tool-clamping") spec.options.set("setup", std::string("P1_short"));
  const double amplitude = kind == "station-drift" ? 4e-9 : kind == "squareness-drift" ? 4e-6 : 12e-6;
  for (const char* stem : {"amplitude", "cos", "sin", "x", "y", "z"}) {
    if (has(stem)) spec.options.set(stem, std::string(stem) == "sin" ? -0.5 * amplitude : amplitude);
  }
  return spec;
}

/// Middle of the readings of a tracer's setup.
double middle_of_setup(const Campaign& campaign, const std::string& name) {
  const auto setup = std::ranges::find(campaign.setups, name, &Setup::name);
  return 0.5 * (setup->readings.time.front() + setup->readings.time.back());
}

TEST(KnownTruth, EveryEffectIsThatOfTheModel) {
  const Machine machine = machine_with_homes();
  const ModelSpec without = known_functions(machine, 4);
  const double pushed = middle_of_setup(measured_without_noise(machine, without), "P2_short");
  for (const std::string& kind : sim::known_effect_kinds()) {
    if (std::ranges::count(kOfRotaryAxes, kind) > 0) continue;
    ASSERT_NE(find_effect(kind), nullptr) << kind;
    ModelSpec with = without;
    with.effects = {example_of(kind, machine)};
    if (kind == "station-event") with.effects[0].options.set("time", pushed);
    const Campaign campaign = measured_without_noise(machine, with);
    // An axis that turns overruns the point by 1 mm, which readings do not tell.
    const double overrun = kind == "pre-travel" ? 12e-6 * 1e-3 / kPreTravel : 0.0;
    EXPECT_LT(largest_residual(campaign, with), kFirstOrder + overrun) << kind;
    EXPECT_GT(largest_residual(campaign, without), 5.0 * kFirstOrder) << kind << " does nothing";
  }
}

/// An R-test of a trunnion whose home is not at zero.
Campaign r_test_without_noise(const Machine& machine, const ModelSpec& errors) {
  sim::Study study;
  study.machine = machine;
  study.truth.errors = errors;
  sim::RTest r_test;
  r_test.poses.spheres = {{"S1", {0.1, 0.02, 0.05}}};
  r_test.poses.grid.points = {{AxisName::A, 5}, {AxisName::C, 9}};
  r_test.poses.grid.jitter = 0.3;
  r_test.offset_spread = 0.0;
  r_test.noise = {};
  study.measurements.emplace_back().settings = r_test;
  Campaign campaign = sim::simulate(study).campaign;
  for (Setup& setup : campaign.setups) {
    setup.noise.set("constant", 0.1e-6);
    setup.repeatability = 0.0;
  }
  return campaign;
}

TEST(KnownTruth, EveryEffectOfRotaryAxesIsThatOfTheModel) {
  Machine machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
  for (Axis& axis : machine.axes) {
    if (axis.name == AxisName::A) axis.home = 0.2;
  }
  ModelSpec without;
  without.default_function.basis = "zero";
  for (const std::string kind : kOfRotaryAxes) {
    EffectSpec spec = effect_spec(kind, {{"symbol", std::string("ECC")}, {"amplitude", 20e-6}});
    spec.options.set("cos", 20e-6);
    spec.options.set("sin", -10e-6);
    if (kind == "worm-error") spec.options.set("period", 2.0 * std::numbers::pi / 36.0);
    if (kind == "tilt-load" || kind == "cradle-coupling") {
      spec.options.set("axis", std::string("A"));
      spec.options.set("shape", std::string("one-minus-cosine"));
    }
    ModelSpec with = without;
    with.effects = {spec};
    const Campaign campaign = r_test_without_noise(machine, with);
    EXPECT_LT(largest_residual(campaign, with), kFirstOrder) << kind;
    EXPECT_GT(largest_residual(campaign, without), 5.0 * kFirstOrder) << kind << " does nothing";
  }
}

/// What acts on a tool or a station as a user writes it.
TEST(KnownTruth, ToolsAndStationsMoveByExpressions) {
  const Machine machine = machine_with_homes();
  const ModelSpec without = known_functions(machine, 8);
  for (const std::string& target :
       std::vector<std::string>{"tool z", "tool " + machine.tools[1].name + " x", "station P2 y"}) {
    ModelSpec with = without;
    with.effects = {effect_spec(
        "custom", {{"target", target}, {"expression", std::string("t / 1000")}, {"amplitude", 4e-6}})};
    const Campaign campaign = measured_without_noise(machine, with);
    EXPECT_LT(largest_residual(campaign, with), kFirstOrder) << target;
    EXPECT_GT(largest_residual(campaign, without), 5.0 * kFirstOrder) << target << " does nothing";
  }
}

TEST(KnownTruth, SquarenessDriftsWithTime) {
  const Machine machine = machine_with_homes();
  ModelSpec model = known_functions(machine, 6);
  const ModelSpec without = model;
  model.effects = {
      effect_spec("squareness-drift", {{"symbol", std::string("EA0Z")}, {"amplitude", 10e-6 / 3600.0}})};
  const Campaign campaign = measured_without_noise(machine, model);
  EXPECT_LT(largest_residual(campaign, model), kFirstOrder);
  EXPECT_GT(largest_residual(campaign, without), 20.0 * kFirstOrder);
}

TEST(KnownTruth, ScalesExpandFromHome) {
  Machine machine = machine_with_homes();
  for (Axis& axis : machine.axes) axis.expansion = ScaleExpansion{11e-6, 0.0, kChannel};
  const ModelSpec model = known_functions(machine, 5);
  const Campaign campaign = measured_without_noise(machine, model);
  EXPECT_LT(largest_residual(campaign, model), kFirstOrder);
}

TEST(KnownTruth, WhatIsNotSimulatedIsNamed) {
  const Machine machine = machine_with_homes();
  ModelSpec model;
  model.file = "known.toml";
  model.effects = {effect_spec("dead-path", {{"setup", std::string("P1_short")}})};
  model.effects[0].source_line = 7;
  try {
    measured_without_noise(machine, model);
    FAIL() << "an effect was dropped";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("dead-path"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("known.toml:7"), std::string::npos) << error.what();
  }
  model.effects = {effect_spec(
      "thermal-drift",
      {{"symbol", std::string("EAX")}, {"temperature", std::string("oil")}, {"amplitude", 1e-6}})};
  EXPECT_THROW(measured_without_noise(machine, model), InputError);
}

}  // namespace
}  // namespace volcal
