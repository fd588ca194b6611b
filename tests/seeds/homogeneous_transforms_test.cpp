// A. Bhattacharyya, T. L. Schmitz, S. W. T. Payne, P. R. Choudhury, J. K. Schueller: Introducing engineering
// undergraduates to CNC machine tool error compensation. Equations 6-10 and the three student exercises.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/description/units.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using testing_support::error_of;
using testing_support::machine_of;

constexpr double kRadianPerArcsecond = std::numbers::pi / (180.0 * 3600.0);

Matrix3d rotation_x(double angle) {
  Matrix3d r;
  r << 1, 0, 0, 0, std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle);
  return r;
}
Matrix3d rotation_y(double angle) {
  Matrix3d r;
  r << std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle);
  return r;
}
Matrix3d rotation_z(double angle) {
  Matrix3d r;
  r << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  return r;
}

/// Eq. 10: the small-angle rotation.
Matrix3d small_rotation(const Vector3d& angles) {
  Matrix3d r;
  r << 1, -angles.z(), angles.y(), angles.z(), 1, -angles.x(), -angles.y(), angles.x(), 1;
  return r;
}

/// Eq. 6-8: R321(theta, phi, psi) = R(z, theta) R(y, phi) R(x, psi).
TEST(HomogeneousTransforms, RotationIsThe321Product) {
  for (const Vector3d& angles : {Vector3d(0.3, -0.7, 1.1), Vector3d(-2.0, 0.4, 3.0), Vector3d(0, 0, 0.5)}) {
    const Matrix3d product = rotation_z(angles.z()) * rotation_y(angles.y()) * rotation_x(angles.x());
    EXPECT_LT((rotation_321(angles.x(), angles.y(), angles.z()) - product).norm(), 1e-15);
    for (int k = 0; k < 3; ++k) {
      const Matrix3d single = k == 0 ? rotation_x(0.6) : k == 1 ? rotation_y(0.6) : rotation_z(0.6);
      EXPECT_LT((rotation_about(k, 0.6) - single).norm(), 1e-15);
    }
  }
}

/// Eq. 9 and 10: for small angles the product is the linear form, whatever its order, to second order.
TEST(HomogeneousTransforms, SmallRotationsAddUpInAnyOrder) {
  const Vector3d angles(40e-6, -90e-6, 70e-6);
  const double second_order = angles.lpNorm<1>() * angles.lpNorm<1>();
  const Matrix3d rx = rotation_x(angles.x());
  const Matrix3d ry = rotation_y(angles.y());
  const Matrix3d rz = rotation_z(angles.z());
  const Matrix3d linear = small_rotation(angles);
  EXPECT_LT((rotation_321(angles.x(), angles.y(), angles.z()) - linear).norm(), second_order);
  for (const Matrix3d& product : std::vector<Matrix3d>{rz * ry * rx, rz * rx * ry, ry * rz * rx, ry * rx * rz,
                                                       rx * ry * rz, rx * rz * ry}) {
    EXPECT_LT((product - linear).norm(), second_order);
  }
}

/// Exercise 1: a probe of 100 N on a cantilever of 250 mm, 25 x 50 mm, E = 210 GPa, probe offset 100 mm
/// below. Printed: 9.54 um (from rounded intermediate values; the formula gives 9.52), 57 urad, 5.7 um.
TEST(HomogeneousTransforms, Exercise1CantileverAndAbbeError) {
  const double load = 100.0;
  const double length = 0.25;
  const double inertia = 0.025 * std::pow(0.05, 3) / 12.0;
  const double stiffness = 210e9 * inertia;
  const double deflection = load * std::pow(length, 3) / (3.0 * stiffness);
  const double slope = load * length * length / (2.0 * stiffness);
  EXPECT_NEAR(deflection, 9.5e-6, 0.05e-6);
  EXPECT_NEAR(slope, 57e-6, 0.5e-6);

  const KinematicChain chain(machine_of("w b X t"));
  PoseErrors<double> errors;
  error_of(errors, "EZX") = -deflection;
  error_of(errors, "EBX") = slope;  // positive about y lowers the far end
  const AxisPosition position = {length, 0, 0, 0, 0, 0};
  const Vector3d probe(0, 0, -0.1);
  const Vector3d error = chain.first_order(position, probe, errors).displacement_w;
  EXPECT_NEAR(error.z(), -9.5e-6, 0.05e-6);  // lateral error
  EXPECT_NEAR(error.x(), -5.7e-6, 0.05e-6);  // Abbe error
  EXPECT_EQ(error.y(), 0.0);
  const Vector3d exact = chain.exact_pose<double>(position, probe, errors).point_w;
  EXPECT_LT((exact - chain.nominal_point_w(position, probe) - error).norm(), 1e-9);
}

/// Matrix that takes coordinates about the axis' reference point to coordinates in the frame below.
template <class Point>
Matrix4d transform_of(const Vector3d& reference, Point point_of_tool) {
  Matrix4d matrix = Matrix4d::Identity();
  const Vector3d origin = point_of_tool(reference);
  matrix.topRightCorner<3, 1>() = origin;
  for (int k = 0; k < 3; ++k) matrix.col(k).head<3>() = point_of_tool(reference + Vector3d::Unit(k)) - origin;
  return matrix;
}

/// Exercise 2, eq. 29: frame 2 on the vertical axis, offset by a in y and b in z from frame 1.
TEST(HomogeneousTransforms, Exercise2MatrixOfASlide) {
  const double a = 0.12;
  const double b = 0.34;
  Machine machine = machine_of("w b Z t");
  machine.axes[0].reference_point = Vector3d(0, a, b);
  const KinematicChain chain(machine);
  const Vector3d delta(3e-6, -5e-6, 7e-6);
  const Vector3d epsilon(20e-6, -30e-6, 40e-6);
  PoseErrors<double> errors;
  for (std::size_t k = 0; k < 3; ++k) {
    errors.motion[index_of(AxisName::Z)][k] = delta[static_cast<Eigen::Index>(k)];
    errors.motion[index_of(AxisName::Z)][k + 3] = epsilon[static_cast<Eigen::Index>(k)];
  }
  Matrix4d printed;
  printed << 1, -epsilon.z(), epsilon.y(), delta.x(),  //
      epsilon.z(), 1, -epsilon.x(), a + delta.y(),     //
      -epsilon.y(), epsilon.x(), 1, b + delta.z(),     //
      0, 0, 0, 1;
  const AxisPosition home{};
  const Matrix4d first_order =
      transform_of(machine.axes[0].reference_point, [&](const Vector3d& tool) -> Vector3d {
        return chain.nominal_point_w(home, tool) + chain.first_order(home, tool, errors).displacement_w;
      });
  EXPECT_LT((first_order - printed).norm(), 1e-15);
  const Matrix4d exact = transform_of(machine.axes[0].reference_point, [&](const Vector3d& tool) -> Vector3d {
    return chain.exact_pose<double>(home, tool, errors).point_w;
  });
  EXPECT_LT((exact - printed).norm(), epsilon.lpNorm<1>() * epsilon.lpNorm<1>());
}

/// Rows of numbers below a header.
std::vector<std::vector<double>> read_exercise(const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::path(VOLCAL_SOURCE_DIR) / "datasets" / "exercises" / name;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::string line;
  std::getline(file, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

/// Exercise 3: Table 2 (tool point at 300, 400, 500 mm) from Table 1 (origin of the carriage), to the printed
/// micrometre; eq. 34 is the y component of the twist.
TEST(HomogeneousTransforms, Exercise3Table2FromTable1) {
  const auto carriage = read_exercise("slideway_errors.csv");
  const auto tool_point = read_exercise("tool_point_errors.csv");
  ASSERT_EQ(carriage.size(), 9U);
  ASSERT_EQ(tool_point.size(), 9U);
  const KinematicChain chain(machine_of("w b Y t"));
  const Vector3d tool(0.3, 0.4, 0.5);
  for (std::size_t i = 0; i < carriage.size(); ++i) {
    PoseErrors<double> errors;
    for (std::size_t k = 0; k < 6; ++k) {
      errors.motion[index_of(AxisName::Y)][k] =
          carriage[i][k + 1] * (k < 3 ? kMetrePerMicrometre : kRadianPerArcsecond);
    }
    const AxisPosition position = {0, carriage[i][0] * kMetrePerMillimetre, 0, 0, 0, 0};
    const Vector3d error = chain.first_order(position, tool, errors).displacement_w;
    EXPECT_EQ(std::round(error.y() / kMetrePerMicrometre), tool_point[i][1]) << "y = " << carriage[i][0];
    const auto& e = errors.motion[index_of(AxisName::Y)];
    EXPECT_NEAR(error.y(), 0.3 * e[5] - 0.5 * e[3] + e[1], 1e-18);  // eq. 34
    const Vector3d exact = chain.exact_pose<double>(position, tool, errors).point_w;
    EXPECT_NEAR(exact.y() - 0.4 - position[1], error.y(), 0.02e-6);
  }
}

}  // namespace
}  // namespace volcal
