// What every registered effect must keep.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using testing_support::machine_of;

/// Two readings with every optional column, approached from different sides.
Setup setup_with_readings() {
  Setup setup;
  setup.name = "S1";
  for (const AxisName axis : kAllAxes) {
    setup.readings.position[index_of(axis)] = {0.2, 0.6};
    setup.readings.direction[index_of(axis)] = {-1, +1};
  }
  setup.readings.value = {{0.0, 0.0}};
  setup.readings.time = {0.0, 3600.0};
  setup.readings.line = {0, 1};
  setup.readings.run = {0, 1};
  setup.readings.feed = {0.01, 0.02};
  setup.readings.temperature["X"] = {20.0, 23.0};
  setup.readings.source_line = {2, 3};
  return setup;
}

/// Smallest valid table of an effect: every required key with a value of its type.
EffectSpec smallest_spec(const EffectSchema& schema) {
  EffectSpec spec;
  spec.kind = schema.kind;
  spec.source_line = 12;
  for (const KeySchema& key : schema.keys) {
    if (!key.required) continue;
    const std::string stem(stem_of_key(key.key));
    switch (key.type) {
      case KeyType::Number:
        spec.options.set(stem, unit_of_key(key.key).si_per_unit);
        break;
      case KeyType::Text:
        spec.options.set(stem, key.choices.empty() ? std::string("EXX") : key.choices.front());
        break;
      case KeyType::Boolean:
        spec.options.set(stem, true);
        break;
      case KeyType::Vector3:
        spec.options.set(stem, Eigen::Vector3d(1.0, 0.0, 0.0));
        break;
    }
  }
  return spec;
}

TEST(EffectContract, KindsDescribeThemselves) {
  std::set<std::string> kinds;
  for (const EffectKind* effect : effect_kinds()) {
    const EffectSchema& schema = effect->schema();
    EXPECT_FALSE(schema.kind.empty());
    EXPECT_FALSE(schema.summary.empty()) << schema.kind;
    EXPECT_FALSE(schema.source.empty()) << schema.kind;
    EXPECT_TRUE(kinds.insert(schema.kind).second) << schema.kind << " is registered twice";
    EXPECT_EQ(find_effect(schema.kind), effect);
    std::set<std::string> keys;
    for (const KeySchema& key : schema.keys) {
      EXPECT_TRUE(keys.insert(key.key).second) << schema.kind << ": key " << key.key << " twice";
      EXPECT_FALSE(key.help.empty()) << schema.kind << ": " << key.key;
      EXPECT_LT(key.plausible_min, key.plausible_max) << schema.kind << ": " << key.key;
    }
  }
  EXPECT_EQ(find_effect("gremlins"), nullptr);
  EXPECT_TRUE(kinds.contains("reversal"));
}

TEST(EffectContract, AmplitudesHaveNameUnitAndTarget) {
  const Machine machine = machine_of("w X' b Y Z t");
  for (const EffectKind* effect : effect_kinds()) {
    const auto bound = effect->bind(smallest_spec(effect->schema()), "model.toml", machine);
    ASSERT_FALSE(bound->amplitudes().empty()) << effect->schema().kind;
    for (const EffectAmplitude& amplitude : bound->amplitudes()) {
      EXPECT_FALSE(amplitude.label.empty()) << effect->schema().kind;
      EXPECT_FALSE(amplitude.unit.empty()) << amplitude.label;
      EXPECT_GT(amplitude.si_per_unit, 0.0) << amplitude.label;
      EXPECT_GE(amplitude.prior_sigma, 0.0) << amplitude.label;
      EXPECT_TRUE(machine.has_axis(amplitude.target.axis)) << amplitude.label;
    }
  }
}

/// An identified amplitude can be written into the effect's table and is read from it again.
TEST(EffectContract, AnIdentifiedValueSurvivesInTheOptions) {
  const Machine machine = machine_of("w X' b Y Z t");
  for (const EffectKind* effect : effect_kinds()) {
    EffectSpec spec = smallest_spec(effect->schema());
    const auto amplitudes = effect->bind(spec, "model.toml", machine)->amplitudes();
    for (const EffectAmplitude& amplitude : amplitudes) {
      const auto holds = [&](const KeySchema& key) {
        return key.type == KeyType::Number && stem_of_key(key.key) == amplitude.option;
      };
      EXPECT_TRUE(std::ranges::any_of(effect->schema().keys, holds)) << amplitude.label;
      spec.options.set(amplitude.option, 3.0 * amplitude.si_per_unit);
    }
    const auto identified = effect->bind(spec, "model.toml", machine);
    for (const EffectAmplitude& amplitude : identified->amplitudes()) {
      EXPECT_EQ(amplitude.guess, 3.0 * amplitude.si_per_unit) << amplitude.label;
    }
  }
}

/// An effect that nobody has measured yet adds nothing: amplitudes start at zero, or at their prior.
TEST(EffectContract, StartsWithoutContribution) {
  const Machine machine = machine_of("w X' b Y Z t");
  for (const EffectKind* effect : effect_kinds()) {
    const auto bound = effect->bind(smallest_spec(effect->schema()), "model.toml", machine);
    for (const EffectAmplitude& amplitude : bound->amplitudes()) {
      EXPECT_EQ(amplitude.guess, amplitude.prior_sigma > 0.0 ? amplitude.prior_mean : 0.0) << amplitude.label;
    }
  }
}

TEST(EffectContract, DriversAreFiniteAndRepeatable) {
  const Machine machine = machine_of("w X' b Y Z t");
  const auto setup = setup_with_readings();
  for (const EffectKind* effect : effect_kinds()) {
    const auto bound = effect->bind(smallest_spec(effect->schema()), "model.toml", machine);
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      std::vector<double> once(bound->amplitudes().size(), -7.0);
      std::vector<double> again(once.size(), 7.0);
      bound->drivers(setup, row, once.data());
      bound->drivers(setup, row, again.data());
      EXPECT_EQ(once, again) << effect->schema().kind;
      for (const double driver : once) EXPECT_TRUE(std::isfinite(driver)) << effect->schema().kind;
    }
  }
}

TEST(EffectContract, ASpecWithoutItsKeysIsRefusedWithItsPlace) {
  const Machine machine = machine_of("w X' b Y Z t");
  for (const EffectKind* effect : effect_kinds()) {
    EffectSpec empty;
    empty.kind = effect->schema().kind;
    empty.source_line = 12;
    const bool asks = std::ranges::any_of(effect->schema().keys, &KeySchema::required);
    if (!asks) continue;
    try {
      effect->bind(empty, "model.toml", machine);
      ADD_FAILURE() << empty.kind << " accepts a table without its required keys";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().file, "model.toml");
      EXPECT_EQ(error.place().line, 12);
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

}  // namespace
}  // namespace volcal
