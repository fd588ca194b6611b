// What hidden effects of rotary axes do, by hand, and that they show in the readings of an R-test with the
// size that is asked for.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/five_axis.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/hidden/hidden_effects.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

Study cradle_study(const HiddenEffect& hidden) {
  Study study;
  study.machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
  study.truth.perfect = true;
  RTest r_test;
  r_test.poses.spheres = {{"S1", {0.1, 0.02, 0.05}}};
  r_test.poses.grid.points = {{AxisName::A, 5}, {AxisName::C, 8}};
  r_test.offset_spread = 0.0;
  r_test.noise = {0.0, 0.0, 0.0, 0.0};
  study.measurements.emplace_back().settings = r_test;
  study.hidden = {hidden};
  return study;
}

HiddenEffect effect_of(const std::string& kind, const std::string& symbol, double phase) {
  HiddenEffect effect;
  effect.kind = kind;
  effect.options.set("symbol", symbol);
  effect.options.set("phase", phase);
  return effect;
}

/// EZC = 10 um sin A cos(C - 30 degrees) lifts the tool against the table by that, along z of the workpiece.
TEST(HiddenRotary, CradleLiftsTheTable) {
  HiddenEffect effect = effect_of("cradle-table", "EZC", std::numbers::pi / 6.0);
  effect.options.set("by", std::string("A"));
  effect.amplitude = 10e-6;
  const SimulatedCampaign simulated = simulate(cradle_study(effect));
  const Readings& readings = simulated.campaign.setups[0].readings;
  for (std::size_t row = 0; row < readings.size(); ++row) {
    const double a = readings.position[index_of(AxisName::A)][row],
                 c = readings.position[index_of(AxisName::C)][row];
    EXPECT_NEAR(readings.value[0][row], 0.0, 1e-12);
    EXPECT_NEAR(readings.value[1][row], 0.0, 1e-12);
    EXPECT_NEAR(readings.value[2][row], 10e-6 * std::sin(a) * std::cos(c - std::numbers::pi / 6.0), 1e-12);
  }
}

/// ECC = 20 urad sin(72 C): the sphere at (100, 20) mm is passed by at right angles to its arm, 102 mm long.
TEST(HiddenRotary, WormTurnsTheTable) {
  HiddenEffect effect = effect_of("worm", "ECC", 0.0);
  effect.options.set("period", std::numbers::pi / 36.0);
  effect.amplitude = 20e-6;
  Study study = cradle_study(effect);
  std::get<RTest>(study.measurements[0].settings).poses.grid.jitter = 0.3;
  const SimulatedCampaign simulated = simulate(study);
  const Readings& readings = simulated.campaign.setups[0].readings;
  double largest = 0.0;
  for (std::size_t row = 0; row < readings.size(); ++row) {
    const double turned = 20e-6 * std::sin(72.0 * readings.position[index_of(AxisName::C)][row]);
    largest = std::max(largest, std::abs(turned));
    EXPECT_NEAR(readings.value[0][row], -0.02 * turned, 1e-10);
    EXPECT_NEAR(readings.value[1][row], 0.1 * turned, 1e-10);
  }
  EXPECT_GT(largest, 15e-6);
}

TEST(HiddenRotary, ShowsWithTheWantedSize) {
  for (const char* kind : {"worm", "cradle-table"}) {
    HiddenEffect effect = effect_of(kind, "ECC", 0.2);
    if (std::string(kind) == "worm") {
      effect.options.set("period", 0.11);
    } else {
      effect.options.set("by", std::string("A"));
    }
    effect.rms = 0.7e-6;
    const SimulatedCampaign simulated = simulate(cradle_study(effect));
    EXPECT_NEAR(simulated.hidden[0].rms, 0.7e-6, 1e-12) << kind;
    EXPECT_GT(simulated.hidden[0].amplitude, 0.0) << kind;
  }
}

TEST(HiddenRotary, RefusesLinearAxes) {
  HiddenEffect effect = effect_of("worm", "EXX", 0.0);
  effect.options.set("period", 0.1);
  effect.amplitude = 1e-6;
  EXPECT_THROW(simulate(cradle_study(effect)), InputError);
  effect = effect_of("cradle-table", "EZC", 0.0);
  effect.options.set("by", std::string("X"));
  effect.amplitude = 1e-6;
  EXPECT_THROW(simulate(cradle_study(effect)), InputError);
}

}  // namespace
}  // namespace volcal::sim
