// Which location errors of rotary axes readings can tell: ranks and names for structures of ISO 10791-6, by
// singular values of the constants' columns at random poses, and what the program makes of them.

#include "volcal/model/kinematics/rotary_datum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "tests/support/singular_values.h"

namespace volcal {
namespace {

using testing_support::machine_of;
using testing_support::random_position;
using testing_support::random_vector;

/// Centres anywhere, three tools on no line.
Machine five_axis_machine(const std::string& structure, double tool_sigma) {
  std::mt19937_64 random(3);
  Machine machine = machine_of(structure);
  for (Axis& axis : machine.axes) {
    axis.centre = random_vector(random, 0.3);
    axis.reference_point = random_vector(random, 0.3);
  }
  machine.tools = {{"short", {0.0, 0.0, -0.15}, tool_sigma},
                   {"long", {0.0, 0.0, -0.3}, tool_sigma},
                   {"side", {0.06, 0.0, -0.2}, tool_sigma}};
  return machine;
}

struct Structures {
  std::string code;
  int constants_known_tool;          ///< rank of six constants per rotary axis and three squareness errors
  std::size_t locations_known_tool;  ///< five per rotary axis: ISO has no displacement along the axis
};

const std::vector<Structures> kStructures = {{"w C' A' Y' b X Z t", 11, 11},
                                             {"w X' b Y Z C B t", 10, 10},
                                             {"w C' X' b Y Z B t", 10, 10},
                                             {"w C' B' b X Y Z t", 11, 11}};

/// Rank of constants behind the place of the workpiece, and of unknown tools their offsets.
int rank_of_constants(const Machine& machine) {
  std::mt19937_64 random(8);
  const KinematicChain chain(machine);
  std::vector<JointLever> levers(chain.joint_count());
  constexpr int kPoses = 200;
  Eigen::MatrixXd frames, columns;
  for (int pose = 0; pose < kPoses; ++pose) {
    const AxisPosition position = random_position(random);
    const std::size_t tool = static_cast<std::size_t>(pose) % machine.tools.size();
    chain.levers(position, machine.tools[tool].offset, levers.data());
    std::vector<Eigen::Vector3d> own;
    for (const LocationSymbol& symbol : machine.datum.squareness()) {
      own.push_back(KinematicChain::location_lever_w(
          *std::ranges::find(levers, symbol.axis, &JointLever::axis), symbol.component));
    }
    for (const JointLever& lever : levers) {
      if (!is_rotary(lever.axis)) continue;
      for (const Component component : kAllComponents)
        own.push_back(KinematicChain::motion_lever_w(lever, component));
    }
    const auto of_frames = frame_columns(machine, chain, position, tool);
    if (pose == 0) {
      frames.resize(3 * kPoses, of_frames.cols());
      columns.resize(3 * kPoses, static_cast<Eigen::Index>(own.size()));
    }
    frames.middleRows<3>(3 * pose) = of_frames;
    for (std::size_t k = 0; k < own.size(); ++k)
      columns.block<3, 1>(3 * pose, static_cast<Eigen::Index>(k)) = own[k];
  }
  const auto rank = [](const Eigen::MatrixXd& matrix) {
    const Eigen::VectorXd values = testing::singular_values(matrix);
    return static_cast<int>((values.array() > 1e-9 * values[0]).count());
  };
  Eigen::MatrixXd both(frames.rows(), frames.cols() + columns.cols());
  both << frames, columns;
  return rank(both) - rank(frames);
}

std::vector<std::string> names(const std::vector<LocationSymbol>& symbols) {
  std::vector<std::string> result;
  for (const LocationSymbol& symbol : symbols) result.push_back(symbol.name());
  std::ranges::sort(result);
  return result;
}

TEST(RotaryDatum, ConstantsHaveTheRanksOfTheirStructures) {
  for (const Structures& structure : kStructures) {
    EXPECT_EQ(rank_of_constants(five_axis_machine(structure.code, 0.0)), structure.constants_known_tool)
        << structure.code;
    EXPECT_EQ(rank_of_constants(five_axis_machine(structure.code, 1e-3)), 8) << structure.code;
  }
}

TEST(RotaryDatum, LocationsThatAreIndependentAreAsManyAsTheirRank) {
  for (const Structures& structure : kStructures) {
    EXPECT_EQ(independent_locations(five_axis_machine(structure.code, 0.0)).size(),
              structure.locations_known_tool)
        << structure.code;
    EXPECT_EQ(independent_locations(five_axis_machine(structure.code, 1e-3)).size(), 8U) << structure.code;
  }
}

/// ISO 230-1: eight location errors of a five-axis machine, one of them a distance of two axes of rotation.
TEST(RotaryDatum, UnknownToolsLeaveTheEightOfTheStructure) {
  EXPECT_EQ(names(independent_locations(five_axis_machine("w C' A' Y' b X Z t", 1e-3))),
            (std::vector<std::string>{"EA0C", "EA0Z", "EB0A", "EB0C", "EB0Z", "EC0A", "EC0Y", "EY0C"}));
  EXPECT_EQ(names(independent_locations(five_axis_machine("w X' b Y Z C B t", 1e-3))),
            (std::vector<std::string>{"EA0B", "EA0C", "EA0Z", "EB0C", "EB0Z", "EC0B", "EC0Y", "EX0B"}));
}

/// Of three axes, and of a table whose tool stands on its axis alone.
TEST(RotaryDatum, AThreeAxisMachineHasItsSquareness) {
  EXPECT_EQ(names(independent_locations(five_axis_machine("w X' Y' b Z t", 0.0))),
            (std::vector<std::string>{"EA0Z", "EB0Z", "EC0Y"}));
}

TEST(RotaryDatum, PosesLieWithinTheTravelAndAreTheSameAtEveryCall) {
  const Machine machine = five_axis_machine("w C' A' Y' b X Z t", 0.0);
  const auto poses = spread_poses(machine, 50);
  EXPECT_EQ(poses, spread_poses(machine, 50));
  for (const AxisPosition& pose : poses) {
    for (const Axis& axis : machine.axes) {
      EXPECT_GE(pose[index_of(axis.name)], axis.travel_min);
      EXPECT_LE(pose[index_of(axis.name)], axis.travel_max);
    }
  }
}

}  // namespace
}  // namespace volcal
