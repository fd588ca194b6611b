// K.-C. Fan, H.-M. Yen, K.-Y. Li: A New Concept of Volumetric Error Analysis of Machine Tools Based on Abbe
// Principle. Eq. 3 to 10 for a milling machine whose table moves in Y and whose Z axis rides on X.
//
// The paper counts x and z against our axes: x = -q_X and z = -q_Z in the Abbe offsets (eq. 4 and 6), and
// only there; displacements and angles keep our signs.
//
// Misprint: eq. 2, row 2, column 1 has Z. It is -Z: the matrix is that of the cross product of angles and
// point.

#include <gtest/gtest.h>

#include <string>

#include "tests/support/machines.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing_support::error_of;
using testing_support::machine_of;
using testing_support::random_vector;

/// Matrix of eq. 5, 7 and 9.
Matrix3d angular_matrix(const Vector3d& epsilon) {
  Matrix3d m;
  m << 0, -epsilon.z(), epsilon.y(), epsilon.z(), 0, -epsilon.x(), -epsilon.y(), epsilon.x(), 0;
  return m;
}

/// Offsets of the cutter from the three read heads at x = y = z = 0.
struct AbbeOffsets {
  Vector3d of_y, of_x, of_z;
};

struct MillingMachine {
  Machine machine = machine_of("w Y' b X Z t");
  Vector3d tool{0.05, -0.04, -0.25};
  AbbeOffsets at_zero;
};

MillingMachine milling_machine(std::mt19937_64& random) {
  MillingMachine m;
  for (Axis& axis : m.machine.axes) axis.reference_point = random_vector(random, 0.6);
  m.at_zero = {m.tool - m.machine.axis(AxisName::Y).reference_point,
               m.tool - m.machine.axis(AxisName::X).reference_point,
               m.tool - m.machine.axis(AxisName::Z).reference_point};
  return m;
}

/// Eq. 4, 6 and 8.
AbbeOffsets offsets_at(const AbbeOffsets& zero, double x, double y, double z) {
  return {{zero.of_y.x() - x, zero.of_y.y() + y, zero.of_y.z() - z},
          {zero.of_x.x(), zero.of_x.y(), zero.of_x.z() - z},
          zero.of_z};
}

void set_angles(PoseErrors<double>& errors, AxisName axis, const Vector3d& epsilon) {
  for (std::size_t k = 0; k < 3; ++k) {
    errors.motion[index_of(axis)][k + 3] = epsilon[static_cast<Eigen::Index>(k)];
  }
}

TEST(AbbeOffsets, FollowFromReferencePoints) {
  std::mt19937_64 random(21);
  for (int i = 0; i < 100; ++i) {
    const MillingMachine m = milling_machine(random);
    const KinematicChain chain(m.machine);
    const Vector3d q = random_vector(random, 1.0);
    const AbbeOffsets offsets = offsets_at(m.at_zero, -q.x(), q.y(), -q.z());
    std::array<JointLever, 3> levers;
    chain.levers({q.x(), q.y(), q.z(), 0, 0, 0}, m.tool, levers.data());
    EXPECT_LT((levers[0].arm_s - offsets.of_y).norm(), 1e-15);
    EXPECT_LT((levers[1].arm_s - offsets.of_x).norm(), 1e-15);
    EXPECT_LT((levers[2].arm_s - offsets.of_z).norm(), 1e-15);
  }
}

TEST(AbbeOffsets, VolumetricErrorIsEquations5To10) {
  std::mt19937_64 random(22);
  for (int i = 0; i < 100; ++i) {
    const MillingMachine m = milling_machine(random);
    const KinematicChain chain(m.machine);
    const Vector3d q = random_vector(random, 1.0);
    const AxisPosition position = {q.x(), q.y(), q.z(), 0, 0, 0};
    const AbbeOffsets offsets = offsets_at(m.at_zero, -q.x(), q.y(), -q.z());
    const Vector3d of_y = random_vector(random, 50e-6);
    const Vector3d of_x = random_vector(random, 50e-6);
    const Vector3d of_z = random_vector(random, 50e-6);
    const auto displacement = [&](AxisName axis, const Vector3d& epsilon) -> Vector3d {
      PoseErrors<double> errors;
      set_angles(errors, axis, epsilon);
      return chain.first_order(position, m.tool, errors).displacement_w;
    };
    const Vector3d equation_5 = angular_matrix(of_y) * offsets.of_y;
    const Vector3d equation_7 = angular_matrix(of_x) * offsets.of_x;
    const Vector3d equation_9 = angular_matrix(of_z) * offsets.of_z;
    EXPECT_LT((displacement(AxisName::Y, of_y) - equation_5).norm(), 1e-18);
    EXPECT_LT((displacement(AxisName::X, of_x) - equation_7).norm(), 1e-18);
    EXPECT_LT((displacement(AxisName::Z, of_z) - equation_9).norm(), 1e-18);
    PoseErrors<double> all;
    set_angles(all, AxisName::Y, of_y);
    set_angles(all, AxisName::X, of_x);
    set_angles(all, AxisName::Z, of_z);
    const Vector3d total = chain.first_order(position, m.tool, all).displacement_w;
    EXPECT_LT((total - equation_5 - equation_7 - equation_9).norm(), 1e-18);  // eq. 10
  }
}

/// Angles about the origin displace the point (X, Y, Z) by their cross product with it; with +Z in row 2, as
/// printed, a roll would move the point along +Y where it moves along -Y.
TEST(AbbeOffsets, Equation2NeedsMinusZInRow2) {
  const Vector3d point(0.3, -0.2, 0.4), angles(20e-6, -30e-6, 10e-6);
  const auto equation_2 = [&](double row_2_column_1) -> Vector3d {
    Eigen::Matrix3d matrix;
    matrix << 0, point.z(), -point.y(), row_2_column_1, 0, point.x(), point.y(), -point.x(), 0;
    return matrix * angles;
  };
  PoseErrors<double> errors;
  set_angles(errors, AxisName::X, angles);
  const Vector3d displacement =
      KinematicChain(machine_of("w Y' b X Z t")).first_order({}, point, errors).displacement_w;
  EXPECT_LT((displacement - equation_2(-point.z())).norm(), 1e-18);
  EXPECT_NEAR((displacement - equation_2(point.z())).norm(), 2.0 * 0.4 * 20e-6, 1e-18);
}

/// What the paper argues: with the cutter's coordinates instead of its offset from the read head (eq. 2) the
/// error is another one. Read head of X 0.5 m below the cutter, pitch 20 urad: 10 um that eq. 2 misses.
TEST(AbbeOffsets, CutterCoordinatesAloneMissTheReadHead) {
  Machine machine = machine_of("w Y' b X Z t");
  machine.axes[1].reference_point = Vector3d(0, 0, -0.5);
  PoseErrors<double> errors;
  error_of(errors, "EBX") = 20e-6;
  const Vector3d with_read_head =
      KinematicChain(machine).first_order({}, Vector3d::Zero(), errors).displacement_w;
  const Vector3d from_coordinates =
      KinematicChain(machine_of("w Y' b X Z t")).first_order({}, Vector3d::Zero(), errors).displacement_w;
  EXPECT_NEAR(with_read_head.x(), 10e-6, 1e-18);
  EXPECT_EQ(from_coordinates.x(), 0.0);
}

}  // namespace
}  // namespace volcal
