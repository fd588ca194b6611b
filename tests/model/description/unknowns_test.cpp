/// Which errors of a machine are unknown, by hand.

#include "volcal/model/description/unknowns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/machines.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;

template <class Symbols>
std::vector<std::string> names_of(const Symbols& symbols) {
  std::vector<std::string> names;
  for (const auto& symbol : symbols) names.push_back(symbol.name());
  return names;
}

TEST(Unknowns, ThreeLinearAxesHaveTwentyOne) {
  const Machine machine = testing_support::machine_of("w Y' b Z X t");
  EXPECT_THAT(machine.linear_axes(), ElementsAre(AxisName::X, AxisName::Y, AxisName::Z));
  const auto motions = names_of(linear_axis_motions(machine));
  ASSERT_EQ(motions.size(), 18U);
  EXPECT_EQ(motions.front(), "EXX");
  EXPECT_EQ(motions.back(), "ECZ");
  EXPECT_EQ(names_of(modelled_motions(machine, {})).size(), 18U);
  EXPECT_EQ(names_of(modelled_motions(machine, {})).front(), "EXY") << "in the order of the structure";
  EXPECT_THAT(names_of(modelled_locations(machine, {})), ElementsAre("EC0Y", "EA0Z", "EB0Z"));
  EXPECT_EQ(possible_locations(machine), squareness_errors(machine));
}

TEST(Unknowns, TwoAxesHaveOneSquareness) {
  const Machine machine = testing_support::machine_of("w X' b Y t");
  EXPECT_EQ(modelled_motions(machine, {}).size(), 12U);
  EXPECT_THAT(names_of(modelled_locations(machine, {})), ElementsAre("EC0Y"));
  EXPECT_TRUE(squareness_errors(testing_support::machine_of("w b X t")).empty());
}

/// Errors of a rotary axis are unknown where the model names them; C has no location along z.
TEST(Unknowns, OfARotaryAxisWhatTheModelNames) {
  const Machine machine = testing_support::machine_of("w C' X' b Y Z t");
  EXPECT_EQ(linear_axis_motions(machine).size(), 18U);
  EXPECT_EQ(possible_locations(machine).size(), 8U);
  EXPECT_THAT(names_of(possible_locations(machine)),
              ElementsAre("EC0Y", "EA0Z", "EB0Z", "EX0C", "EY0C", "EA0C", "EB0C", "EC0C"));
  ModelSpec model;
  EXPECT_EQ(modelled_motions(machine, model).size(), 18U);
  EXPECT_EQ(modelled_locations(machine, model).size(), 3U);
  model.functions[*ErrorSymbol::parse("ECC")].basis = "fourier";
  model.locations[*LocationSymbol::parse("EX0C")] = 0.0;
  model.locations_off = {*LocationSymbol::parse("EA0Z")};
  const auto motions = names_of(modelled_motions(machine, model));
  EXPECT_EQ(motions.size(), 19U);
  EXPECT_EQ(motions.front(), "ECC");
  EXPECT_THAT(names_of(modelled_locations(machine, model)), ElementsAre("EC0Y", "EB0Z", "EX0C"));
}

/// A function with the basis "zero" is one without parameters.
TEST(Unknowns, AFunctionOfBasisZeroIsListed) {
  ModelSpec model;
  model.default_function.basis = "zero";
  EXPECT_EQ(modelled_motions(testing_support::machine_of("w X' b Y Z t"), model).size(), 18U);
}

TEST(Unknowns, StraightnessHasNoSlope) {
  const auto free = [](const char* symbol) { return has_free_slope(*ErrorSymbol::parse(symbol)); };
  EXPECT_FALSE(free("EYX"));
  EXPECT_FALSE(free("EXZ"));
  EXPECT_TRUE(free("EXX"));
  EXPECT_TRUE(free("EAX"));
  EXPECT_TRUE(free("EXC")) << "a rotary axis is not straight";
}

}  // namespace
}  // namespace volcal
