/// A registry that programs add to.

#include "volcal/model/description/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

struct Named {
  std::string name;
};

std::unique_ptr<const Named> named(const std::string& name) {
  return std::make_unique<const Named>(Named{name});
}

std::string_view name_of(const Named& plugin) { return plugin.name; }

TEST(Registration, KeepsTheOrderAndTheOwner) {
  const Named built_in{"own"};
  Registration<Named> registration({&built_in}, name_of);
  const Named& added = registration.add(named("added"));
  ASSERT_EQ(registration.all().size(), 2U);
  EXPECT_EQ(registration.all()[0], &built_in);
  EXPECT_EQ(registration.all()[1], &added);
  EXPECT_EQ(registration.find("added"), &added);
  EXPECT_EQ(registration.find("other"), nullptr);
}

TEST(Registration, RefusesNothingNoNameAndATakenName) {
  const Named built_in{"own"};
  Registration<Named> registration({&built_in}, name_of);
  EXPECT_THROW(registration.add(nullptr), std::invalid_argument);
  EXPECT_THROW(registration.add(named("")), std::invalid_argument);
  EXPECT_THROW(registration.add(named("own")), std::invalid_argument);
  registration.add(named("added"));
  EXPECT_THROW(registration.add(named("added")), std::invalid_argument);
  EXPECT_EQ(registration.all().size(), 2U);
}

TEST(Registration, WhatWasReadStaysValid) {
  const Named built_in{"own"};
  Registration<Named> registration({&built_in}, name_of);
  const auto before = registration.all();
  for (int i = 0; i < 100; ++i) registration.add(named("plugin " + std::to_string(i)));
  ASSERT_EQ(before.size(), 1U);
  EXPECT_EQ(before[0]->name, "own");
}

TEST(Registration, ThreadsMayAddAndRead) {
  const Named built_in{"own"};
  Registration<Named> registration({&built_in}, name_of);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&registration, t] {
      for (int i = 0; i < 50; ++i) {
        registration.add(named(std::to_string(t) + "." + std::to_string(i)));
        for (const Named* plugin : registration.all()) EXPECT_FALSE(plugin->name.empty());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(registration.all().size(), 201U);
}

TEST(Registries, RefuseNamesOfTheLibrary) {
  const auto maker = [](const EffectTable&) -> std::unique_ptr<FormulaEffect> { return nullptr; };
  const auto none = [](const Campaign&) -> std::vector<EffectSpec> { return {}; };
  auto reversal = std::make_unique<FormulaKind>(
      EffectSchema{.kind = "reversal", .summary = "a second one", .source = "none", .keys = {}}, maker, none);
  EXPECT_THROW(register_effect(std::move(reversal)), std::invalid_argument);
  EXPECT_THROW(register_effect(nullptr), std::invalid_argument);
  EXPECT_THROW(register_instrument(nullptr), std::invalid_argument);
  EXPECT_NE(find_effect("reversal")->schema().summary, "a second one");
  EXPECT_NE(find_instrument("laser-tracer"), nullptr);
}

}  // namespace
}  // namespace volcal
