// A machine with known errors, measured without noise by the simulator, which evaluates functions and effects
// by code of its own: the model that states the errors explains every reading.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "tests/support/five_axis.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/sim/known/known_errors.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

constexpr double kFirstOrder = 10e-9;  // m: errors of 20 um and 50 urad, squared, over a metre
constexpr const char* kChannel = "column";
constexpr double kPreTravel = 0.3;  // m
/// At least: of the library's own none may be lost.
constexpr std::size_t kSimulatedKinds = 46, kSimulatedInstruments = 9;
constexpr const char* kOfRotaryAxes[] = {"cradle-coupling", "ring-eccentricity", "tilt-load", "worm-error"};
/// Of instruments and motions that usual_measurements() do not have; each is measured on its own.
constexpr const char* kOfFurtherMeasurements[] = {
    "beam-misalignment", "dead-path",    "encoder-eccentricity", "following-error",
    "foundation-tilt",   "probe-lobing", "run-offset",           "servo-mismatch"};

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

/// Errors of points all over the volume from both directions, lengths from stations, lines, circles.
std::vector<sim::Measurement> usual_measurements() {
  std::vector<sim::Measurement> measurements;
  sim::PointGrid grid;
  grid.rigid_alignment = false;
  grid.alignment_shift = grid.alignment_rotation = 0.0;
  measurements.push_back({"grid", grid});
  sim::Tracking tracking;
  tracking.grid = {4, 4, 3};
  tracking.station_guess_error = 0.0;  // a length that is too long by a share counts from the guess
  measurements.push_back({"", tracking});
  sim::BallBarCircles circles;
  circles.length_sigma = 0.0;
  measurements.push_back({"", circles});
  measurements.push_back({"", sim::AxisLines()});
  return measurements;
}

/// A tracker, levels, and circles at two feeds about centres that are known.
std::vector<sim::Measurement> further_measurements() {
  std::vector<sim::Measurement> measurements;
  sim::Tracking tracker;
  tracker.instrument = sim::kLaserTracker;
  tracker.grid = {4, 4, 3};
  tracker.station_guess_error = 0.0;
  measurements.push_back({"", tracker});
  sim::AngleLines level;
  level.body = "tool";
  measurements.push_back({"level", level});
  measurements.push_back({"", sim::AxisLines()});
  for (const double feed : {0.02, 0.06}) {
    sim::BallBarCircles circles;
    circles.length_sigma = 0.0;
    circles.centre_error = 0.0;
    circles.feed = feed;
    circles.records_feed = true;
    measurements.push_back({feed > 0.05 ? "fast" : "slow", circles});
  }
  return measurements;
}

/// Temperatures drift.
Campaign measured_without_noise(const Machine& machine, const ModelSpec& errors,
                                const std::vector<sim::Measurement>& measurements = usual_measurements()) {
  sim::Study study;
  study.machine = machine;
  study.truth.errors = errors;
  study.environment.channels = {{.name = kChannel, .start = 21.0, .drift = 1.5 / 3600.0}};
  study.measurements = measurements;
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
    if (setup.instrument == sim::kLaserTracker) setup.noise.set("angle", 0.1e-6);
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
  for (const char* stem : {"amplitude", "cos", "sin", "x", "y", "z", "a", "b", "c"}) {
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
    if (std::ranges::count(kOfRotaryAxes, kind) + std::ranges::count(kOfFurtherMeasurements, kind) > 0)
      continue;
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

void expect_explained(const Machine& machine, const EffectSpec& effect,
                      const std::vector<sim::Measurement>& measurements) {
  const ModelSpec without = known_functions(machine, 9);
  ModelSpec with = without;
  with.effects = {effect};
  const Campaign campaign = measured_without_noise(machine, with, measurements);
  const std::string label = effect_label(*find_effect(effect.kind)->make(effect, ""));
  EXPECT_LT(largest_residual(campaign, with), kFirstOrder) << label;
  EXPECT_GT(largest_residual(campaign, without), 5.0 * kFirstOrder) << label << " does nothing";
}

/// What its schema leaves out of the simulator is counted and named; what is simulated stays so.
TEST(KnownTruth, TheSimulatorKnowsEveryEffectOfTheModel) {
  const std::vector<std::string> known = sim::known_effect_kinds();
  std::vector<std::string> left_out;
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSchema& schema = kind->schema();
    EXPECT_EQ(std::ranges::count(known, schema.kind), schema.simulated ? 1 : 0) << schema.kind;
    if (!schema.simulated) left_out.push_back(schema.kind);
  }
  EXPECT_GE(known.size(), kSimulatedKinds);
  EXPECT_EQ(known.size() + left_out.size(), effect_kinds().size());
  for (const std::string& kind : left_out) std::cout << "effect that is not simulated: " << kind << "\n";
}

/// What an effect of a column acts on.
TEST(KnownTruth, ColumnsOfTheSimulatorAreThoseOfTheInstruments) {
  std::size_t simulated = 0;
  for (const Instrument* instrument : instruments()) {
    const InstrumentSchema& schema = instrument->schema();
    sim::SetupPlan plan;
    plan.instrument = schema.name;
    EXPECT_EQ(sim::column_read(plan, 0) != "", schema.simulated) << schema.name;
    if (!schema.simulated) {
      std::cout << "instrument that is not simulated: " << schema.name << "\n";
      continue;
    }
    ++simulated;
    for (std::size_t set = 0; set < schema.column_sets.size(); ++set) {
      plan.column_set = set;
      for (std::size_t channel = 0; channel < schema.column_sets[set].size(); ++channel) {
        const std::string column = sim::column_read(plan, channel);
        if (column.empty()) continue;
        EXPECT_EQ(column, schema.column_sets[set][channel].column) << schema.name;
      }
    }
  }
  EXPECT_GE(simulated, kSimulatedInstruments);
}

TEST(KnownTruth, EffectsOfLasersLevelsAndRunsAreThoseOfTheModel) {
  const Machine machine = machine_with_homes();
  const std::vector<sim::Measurement> measurements = further_measurements();
  const Campaign campaign = measured_without_noise(machine, known_functions(machine, 9), measurements);
  const auto line = std::ranges::find(campaign.setups, "displacement", &Setup::instrument);
  const auto tracker = std::ranges::find(campaign.setups, "laser-tracker", &Setup::instrument);
  const std::string station = *tracker->options.text("station");
  for (const EffectSpec& effect : {
           effect_spec("beam-misalignment", {{"setup", line->name}, {"amplitude", 40e-6}}),
           effect_spec("run-offset", {{"setup", line->name}, {"run", 2.0}, {"amplitude", 8e-6}}),
           effect_spec("dead-path", {{"amplitude", 40e-6 / 3600.0}}),
           effect_spec("dead-path",
                       {{"station", station}, {"temperature", std::string(kChannel)}, {"amplitude", 5e-6}}),
           effect_spec("dead-path", {{"setup", line->name}, {"amplitude", 40e-6 / 3600.0}}),
           effect_spec("encoder-eccentricity",
                       {{"encoder", std::string("azimuth")}, {"cos", 4e-6}, {"sin", -7e-6}}),
           effect_spec(
               "encoder-eccentricity",
               {{"station", station}, {"encoder", std::string("elevation")}, {"cos", 4e-6}, {"sin", -7e-6}}),
           effect_spec("foundation-tilt",
                       {{"axis", std::string("Y")}, {"about", std::string("x")}, {"amplitude", 20e-6}}),
           effect_spec("foundation-tilt", {{"axis", std::string("Z")},
                                           {"about", std::string("y")},
                                           {"shape", std::string("quadratic")},
                                           {"amplitude", 30e-6}}),
       })
    expect_explained(machine, effect, measurements);
}

TEST(KnownTruth, AxesThatAreLateAreThoseOfTheModel) {
  const Machine machine = machine_with_homes();
  for (const char* kind : {"following-error", "servo-mismatch"}) {
    for (const bool timed : {false, true}) {
      EffectSpec effect = effect_spec(kind, {{"axis", std::string("Y")}, {"amplitude", timed ? 2e-4 : 6e-6}});
      if (std::string(kind) == "servo-mismatch") effect.options.set("second_axis", std::string("X"));
      if (timed) effect.options.set("by", std::string("feed"));
      expect_explained(machine, effect, further_measurements());
    }
  }
}

/// What acts on a column, on a part of the campaign, or with what a beam and a path have. A step of the
/// travel since turning does not mind the millimetre by which an axis overruns, which readings do not tell.
TEST(KnownTruth, ExpressionsAndSurfacesAreThoseOfTheModelWhereverTheyAct) {
  const Machine machine = machine_with_homes();
  const std::vector<sim::Measurement> measurements = further_measurements();
  const Campaign campaign = measured_without_noise(machine, known_functions(machine, 9), measurements);
  const auto tracker = std::ranges::find(campaign.setups, "laser-tracker", &Setup::instrument);
  const auto custom = [](const std::string& target, const std::string& expression, double amplitude) {
    return effect_spec("custom", {{"target", target}, {"expression", expression}, {"amplitude", amplitude}});
  };
  std::vector<EffectSpec> effects = {custom("length_mm", "(length / 1000)^2", 3e-6),
                                     custom("azimuth_deg of " + tracker->name, "sin(x / 100)", 8e-6),
                                     custom("EYY", "dir_y * feed / 1000", 2e-6),
                                     custom("EXX", "dir_x * (since_x > 20)", 6e-6)};
  for (const std::string& only : {"station " + *tracker->options.text("station"), "setup " + tracker->name,
                                  "tool " + machine.tools[tracker->tool].name}) {
    EffectSpec& surface =
        effects.emplace_back(effect_spec("empirical", {{"target", std::string("EBX")}, {"only", only}}));
    add_surface(machine, surface);
  }
  for (const EffectSpec& effect : effects) expect_explained(machine, effect, measurements);
}

/// Keys that are given, and words among their values, without names of places and axes.
std::string variant_of(const EffectSpec& spec) {
  std::string variant = spec.kind;
  for (const KeySchema& key : find_effect(spec.kind)->schema().keys) {
    const std::string stem(stem_of_key(key.key));
    if (spec.options.has(stem)) variant += " " + stem + (key.choices.empty() ? "" : *spec.options.text(stem));
  }
  return variant;
}

/// With amplitudes that change a reading by 12 um or urad at most; none where readings hardly see it.
std::optional<EffectSpec> with_amplitudes(const Campaign& campaign, const ModelSpec& without,
                                          EffectSpec spec) {
  constexpr double kWanted = 12e-6, kSeen = 1e-3;
  const auto effect = find_effect(spec.kind)->make(spec, "");
  double amplitude = 1e-6;
  const auto set = [&] {
    double sign = 1.0;
    for (const EffectAmplitude& each : effect->amplitudes()) {
      spec.options.set(std::string(stem_of_key(each.key)), sign * amplitude);
      sign *= -0.6;
    }
  };
  set();
  ModelSpec with = without;
  with.effects = {spec};
  const double change = largest_residual(campaign, with);
  if (change < kSeen * amplitude) return std::nullopt;
  amplitude *= kWanted / change;
  set();
  return spec;
}

TEST(KnownTruth, EveryVariantOfAnEffectIsThatOfTheModel) {
  const Machine machine = machine_with_homes();
  ModelSpec without;
  without.default_function.basis = "zero";
  std::vector<sim::Measurement> measurements = further_measurements();
  measurements.push_back(usual_measurements()[1]);
  measurements.back().name = "tracer";
  for (sim::Measurement& each : measurements) {
    if (auto* tracking = std::get_if<sim::Tracking>(&each.settings)) tracking->grid = {3, 3, 2};
  }
  const Campaign campaign = measured_without_noise(machine, without, measurements);
  std::set<std::string> seen;
  int held = 0;
  for (const EffectKind* kind : effect_kinds()) {
    if (!kind->schema().simulated) continue;
    for (const EffectSpec& example : kind->examples(campaign)) {
      if (!seen.insert(variant_of(example)).second) continue;
      const auto effect = with_amplitudes(campaign, without, example);
      if (!effect) continue;
      ModelSpec with = without;
      with.effects = {*effect};
      const Campaign measured = measured_without_noise(machine, with, measurements);
      ++held;
      const double overrun = kind->schema().kind == "pre-travel" ? 0.1 * 12e-6 : 0.0;
      EXPECT_LT(largest_residual(measured, with), kFirstOrder + overrun) << variant_of(*effect);
    }
  }
  EXPECT_GE(held, 90) << "of " << seen.size() << " variants; readings hardly see the others";
}

/// Single contacts on a sphere of a trunnion.
TEST(KnownTruth, LobesOfAProbeAreThoseOfTheModel) {
  const Machine machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
  sim::ProbedSphere probed;
  probed.contacts = true;
  probed.poses.spheres = {{"S1", {0.1, 0.02, 0.05}}};
  probed.poses.grid.points = {{AxisName::A, 4}, {AxisName::C, 6}};
  probed.place_error = probed.radius_error = 0.0;
  ModelSpec without;
  without.default_function.basis = "zero";
  ModelSpec with = without;
  with.effects = {effect_spec("probe-lobing", {{"lobes", 3.0}, {"cos", 4e-6}, {"sin", -7e-6}})};
  const Campaign campaign = measured_without_noise(machine, with, {{"", probed}});
  EXPECT_LT(largest_residual(campaign, with), kFirstOrder);
  EXPECT_GT(largest_residual(campaign, without), 5.0 * kFirstOrder);
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
  model.effects = {effect_spec("dead-path", {{"setup", std::string("P9_short")}})};
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
