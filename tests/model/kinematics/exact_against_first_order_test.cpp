// The two forms of the kinematic model against each other, against automatic differentiation, and against the
// homogeneous transforms of the simulator, which shares no code with them.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/jet_rotation.h"
#include "tests/support/machines.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing_support::random_errors;
using testing_support::random_machine;
using testing_support::random_position;
using testing_support::random_vector;
using testing_support::scaled;

constexpr int kChains = 300;
constexpr double kDisplacement = 100e-6;
constexpr double kRotation = 100e-6;

struct RandomPose {
  Machine machine;
  AxisPosition position;
  Vector3d tool;
  PoseErrors<double> errors;
};

RandomPose random_pose(std::mt19937_64& random) {
  RandomPose pose{random_machine(random), random_position(random), random_vector(random, 0.3), {}};
  pose.errors = random_errors(random, pose.machine, kDisplacement, kRotation);
  return pose;
}

struct Difference {
  double point;
  double rotation;
};

/// Exact minus first order: of the functional point, m, and of the rotation, rad.
Difference difference(const RandomPose& pose, const PoseErrors<double>& errors) {
  const KinematicChain chain(pose.machine);
  const auto exact = chain.exact_pose<double>(pose.position, pose.tool, errors);
  const ToolTwist twist = chain.first_order(pose.position, pose.tool, errors);
  const Vector3d exact_displacement = exact.point_w - chain.nominal_point_w(pose.position, pose.tool);
  const Matrix3d turn = exact.rotation_wt * chain.nominal_rotation_wt(pose.position).transpose();
  const Vector3d exact_rotation(0.5 * (turn(2, 1) - turn(1, 2)), 0.5 * (turn(0, 2) - turn(2, 0)),
                                0.5 * (turn(1, 0) - turn(0, 1)));
  return {(exact_displacement - twist.displacement_w).norm(),
          (exact_rotation - twist.rotation_tool_side_w - twist.rotation_workpiece_side_w).norm()};
}

/// The bound stated in chain.h, with 1 + A for the third order.
Difference stated_bound(const RandomPose& pose) {
  double angles = 0.0;
  double displacements = 0.0;
  double longest = 0.0;
  const KinematicChain chain(pose.machine);
  std::vector<JointLever> levers(chain.joint_count());
  chain.levers(pose.position, pose.tool, levers.data());
  for (const JointLever& lever : levers) {
    const std::size_t axis = index_of(lever.axis);
    longest = std::max(longest, lever.arm_s.norm());
    if (!is_rotary(lever.axis)) longest = std::max(longest, std::abs(lever.position));
    for (const Component component : kAllComponents) {
      const std::size_t k = index_of(component);
      (is_rotation(component) ? angles : displacements) +=
          std::abs(pose.errors.motion[axis][k]) + std::abs(pose.errors.location[axis][k]);
    }
  }
  const double third_order = 1.0 + angles;
  return {(0.5 * angles * angles * longest + angles * displacements) * third_order,
          0.5 * angles * angles * third_order};
}

TEST(ExactAgainstFirstOrder, DiffersByLessThanTheStatedBound) {
  std::mt19937_64 random(20240601);
  double largest = 0.0;
  double largest_share = 0.0;
  for (int i = 0; i < kChains; ++i) {
    const RandomPose pose = random_pose(random);
    const Difference found = difference(pose, pose.errors);
    const Difference bound = stated_bound(pose);
    ASSERT_LE(found.point, bound.point) << pose.machine.structure.code;
    ASSERT_LE(found.rotation, bound.rotation) << pose.machine.structure.code;
    largest = std::max(largest, found.point);
    largest_share = std::max(largest_share, found.point / bound.point);
  }
  RecordProperty("largest_difference_nm", std::to_string(largest * 1e9));
  RecordProperty("largest_share_of_bound", std::to_string(largest_share));
  EXPECT_GT(largest, 0.0);
}

TEST(ExactAgainstFirstOrder, HalvingTheErrorsQuartersTheDifference) {
  std::mt19937_64 random(7);
  for (int i = 0; i < kChains; ++i) {
    const RandomPose pose = random_pose(random);
    const Difference whole = difference(pose, scaled(pose.errors, 10.0));
    const Difference half = difference(pose, scaled(pose.errors, 5.0));
    EXPECT_NEAR(whole.point / half.point, 4.0, 0.1) << pose.machine.structure.code;
    EXPECT_NEAR(whole.rotation / half.rotation, 4.0, 0.1) << pose.machine.structure.code;
  }
}

TEST(ExactAgainstFirstOrder, NoErrorsGiveTheNominalPose) {
  std::mt19937_64 random(8);
  for (int i = 0; i < kChains; ++i) {
    const RandomPose pose = random_pose(random);
    const KinematicChain chain(pose.machine);
    const auto exact = chain.exact_pose<double>(pose.position, pose.tool, {});
    EXPECT_LT((exact.point_w - chain.nominal_point_w(pose.position, pose.tool)).norm(), 1e-14);
    EXPECT_LT((exact.rotation_wt - chain.nominal_rotation_wt(pose.position)).norm(), 1e-14);
    EXPECT_EQ(chain.first_order(pose.position, pose.tool, {}).displacement_w, Vector3d::Zero());
  }
}

constexpr int kErrorCount = 2 * 6 * static_cast<int>(kAxisCount);
using ErrorJet = ceres::Jet<double, kErrorCount>;

PoseErrors<ErrorJet> zero_errors_with_derivatives() {
  PoseErrors<ErrorJet> errors;
  int next = 0;
  for (auto* table : {&errors.motion, &errors.location}) {
    for (auto& axis : *table) {
      for (ErrorJet& value : axis) value = ErrorJet(0.0, next++);
    }
  }
  return errors;
}

int derivative_index(bool location, AxisName axis, Component component) {
  return static_cast<int>((location ? kAxisCount * 6 : 0) + index_of(axis) * 6 + index_of(component));
}

Vector3d derivative(const Eigen::Matrix<ErrorJet, 3, 1>& vector, int k) {
  return {vector[0].v[k], vector[1].v[k], vector[2].v[k]};
}

TEST(ExactAgainstFirstOrder, LeversAreTheDerivativesOfTheExactPose) {
  std::mt19937_64 random(9);
  double largest = 0.0;
  for (int i = 0; i < kChains; ++i) {
    const RandomPose pose = random_pose(random);
    const KinematicChain chain(pose.machine);
    std::vector<JointLever> levers(chain.joint_count());
    chain.levers(pose.position, pose.tool, levers.data());
    const auto exact =
        chain.exact_pose<ErrorJet>(pose.position, pose.tool.cast<ErrorJet>(), zero_errors_with_derivatives());
    const Eigen::Matrix<ErrorJet, 3, 1> turn = testing_support::turn_of(exact.rotation_wt);
    for (const JointLever& lever : levers) {
      for (const Component component : kAllComponents) {
        const int motion = derivative_index(false, lever.axis, component);
        const int location = derivative_index(true, lever.axis, component);
        for (const double error :
             {(derivative(exact.point_w, motion) - KinematicChain::motion_lever_w(lever, component)).norm(),
              (derivative(exact.point_w, location) - KinematicChain::location_lever_w(lever, component))
                  .norm(),
              (derivative(turn, motion) - KinematicChain::motion_rotation_w(lever, component)).norm(),
              (derivative(turn, location) - KinematicChain::location_rotation_w(lever, component)).norm()}) {
          largest = std::max(largest, error);
        }
      }
    }
  }
  RecordProperty("largest_difference", std::to_string(largest * 1e15) + "e-15");
  EXPECT_LT(largest, 1e-12);
}

sim::TruthMachine truth_with(const Machine& machine, const PoseErrors<double>& errors) {
  sim::TruthMachine truth(machine);
  const auto squareness = machine.datum.squareness();
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const double motion = errors.motion[index_of(axis.name)][index_of(component)];
      truth.set_error({component, axis.name}, [motion](double) { return motion; });
      const LocationSymbol location{component, axis.name};
      if (!is_rotary(axis.name) && std::ranges::find(squareness, location) == squareness.end()) continue;
      truth.set_location(location, errors.location[index_of(axis.name)][index_of(component)]);
    }
  }
  return truth;
}

TEST(ExactAgainstFirstOrder, ExactPoseIsThatOfTheSimulator) {
  std::mt19937_64 random(10);
  double largest = 0.0;
  for (int i = 0; i < kChains; ++i) {
    RandomPose pose = random_pose(random);
    pose.errors = scaled(pose.errors, 100.0);
    const auto exact = KinematicChain(pose.machine).exact_pose<double>(pose.position, pose.tool, pose.errors);
    sim::MachineState state;
    state.position = pose.position;
    const Eigen::Matrix4d simulated = truth_with(pose.machine, pose.errors).pose(state, pose.tool);
    largest = std::max(largest, (exact.point_w - simulated.topRightCorner<3, 1>()).norm());
    largest = std::max(largest, (exact.rotation_wt - simulated.topLeftCorner<3, 3>()).norm());
  }
  EXPECT_LT(largest, 1e-13);
}

}  // namespace
}  // namespace volcal
