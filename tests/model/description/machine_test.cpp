/// What a machine's description tells of its axes, by hand.

#include "volcal/model/description/machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "volcal/model/description/campaign.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;

TEST(AxesOfAMachine, LinearOnesInOrderAndRotaryOnesAsInTheStructure) {
  const Machine machine = testing_support::machine_of("w C' B' X' b Z Y W t");
  EXPECT_THAT(machine.main_linear_axes(), ElementsAre(AxisName::X, AxisName::Y, AxisName::Z));
  EXPECT_THAT(machine.linear_axes(), ElementsAre(AxisName::X, AxisName::Y, AxisName::Z, AxisName::W));
  EXPECT_THAT(machine.rotary_axes(), ElementsAre(AxisName::C, AxisName::B));
}

TEST(AxesOfAMachine, AnAxisThatIsNotThereIsOnNoSide) {
  const Structure structure = Structure::parse("w C' b X Z t");
  EXPECT_TRUE(structure.is_on_workpiece_side(AxisName::C));
  EXPECT_FALSE(structure.is_on_workpiece_side(AxisName::X));
  EXPECT_FALSE(structure.is_on_workpiece_side(AxisName::Y));
  EXPECT_FALSE(structure.has_axis(AxisName::Y));
}

TEST(AxesOfAMachine, ReadingsStandAtZeroWithoutAColumn) {
  Readings readings;
  readings.position[index_of(AxisName::X)] = {0.1, 0.2};
  const auto position = readings.commanded_position(1);
  EXPECT_EQ(position[index_of(AxisName::X)], 0.2);
  EXPECT_EQ(position[index_of(AxisName::Z)], 0.0);
}

}  // namespace
}  // namespace volcal
