// H. M. Dobariya, Y. D. Patel, D. A. Jani: Improving dimensional accuracy by error modelling and its
// compensation for 3-axis Vertical Machining Centre. Tables 1 and 2, eq. 3 to 16, the 12-error model, 1-D
// elements.
//
// Misprint: Table 1 gives T14 the link length b4. Eq. 3 and 11 need -b4: after T13 (180 degrees) and the 90
// degrees of T14 itself its x axis points along -y. Table 3 gives Z a mean error of 63 um above its maximum
// of 38 um; no test uses that row.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using testing_support::error_of;
using testing_support::machine_of;
using testing_support::random_vector;

Matrix4d translation(const Vector3d& v) {
  Matrix4d t = Matrix4d::Identity();
  t.topRightCorner<3, 1>() = v;
  return t;
}

/// Rot_z(theta) Trans(a, 0, d) Rot_x(alpha), angles in degrees.
Matrix4d denavit_hartenberg(double theta_deg, double d, double a, double alpha_deg) {
  const double theta = theta_deg * std::numbers::pi / 180.0;
  const double alpha = alpha_deg * std::numbers::pi / 180.0;
  const double ct = std::cos(theta), st = std::sin(theta), ca = std::cos(alpha), sa = std::sin(alpha);
  Matrix4d t;
  t << ct, -st * ca, st * sa, a * ct,  //
      st, ct * ca, -ct * sa, a * st,   //
      0, sa, ca, d,                    //
      0, 0, 0, 1;
  return t;
}

/// Machine elements a_i, b_i, c_i (i = 1..4), joint displacements x_i (i = 1..3), cutting point a_t, b_t,
/// c_t.
struct Dimensions {
  std::array<double, 4> a, b, c;
  Vector3d x;
  Vector3d cutting_point;
  Vector3d target_point;
};

Dimensions dimensions() {
  return {{0.11, -0.23, 0.31, 0.07}, {0.53, 0.19, -0.41, 0.13}, {-0.29, 0.37, 0.17, 0.43},
          {0.47, 0.61, -0.59},       {0.02, -0.03, 0.05},       {0.67, -0.71, 0.73}};
}

/// delta_x1, delta_x2, delta_y, delta_z of axis x and likewise y and z: the scale error in its two parts.
struct DenavitErrors {
  double scale_slide = 0.0;
  double scale_screw = 0.0;
  double first = 0.0;   ///< x: delta_y; y: delta_x; z: delta_x
  double second = 0.0;  ///< x: delta_z; y: delta_z; z: delta_y
};
struct Errors12 {
  DenavitErrors x, y, z;
};

Matrix4d x_slide(const Dimensions& m, const DenavitErrors& e) {
  return denavit_hartenberg(0, 0, m.a[0] + e.scale_slide, 0) *
         denavit_hartenberg(0, m.c[0] + e.second, 0, 180) * denavit_hartenberg(90, 0, -m.b[0] - e.first, 0) *
         denavit_hartenberg(-90, 0, m.x[0] + e.scale_screw, 180);
}
Matrix4d y_slide(const Dimensions& m, const DenavitErrors& e) {
  return denavit_hartenberg(0, m.c[1] + e.second, 0, 0) *
         denavit_hartenberg(-90, 0, -m.b[1] - e.scale_slide, 0) *
         denavit_hartenberg(-90, 0, -m.a[1] - e.first, 0) *
         denavit_hartenberg(-90, 0, m.x[1] + e.scale_screw, 0) * denavit_hartenberg(-90, 0, 0, 0);
}
Matrix4d z_slide(const Dimensions& m, const DenavitErrors& e) {
  return denavit_hartenberg(0, m.c[2] + e.scale_slide, 0, 0) *
         denavit_hartenberg(90, 0, m.b[2] + e.second, 0) * denavit_hartenberg(-90, 0, m.a[2] + e.first, 0) *
         denavit_hartenberg(0, m.x[2] + e.scale_screw, 0, 0);
}
/// `t14_length`: +b4 as printed, -b4 as eq. 11 needs.
Matrix4d probe(const Dimensions& m, double t14_length) {
  return denavit_hartenberg(180, 0, -m.a[3], 0) * denavit_hartenberg(90, 0, t14_length, 0) *
         denavit_hartenberg(90, m.c[3], 0, 0);
}

/// T_tp T_x T_y T_z T_p T_c; T_tp and T_c are the translations by X_i and (a_t, b_t, c_t) that eq. 3 implies.
Matrix4d closed_loop(const Dimensions& m, const Errors12& e, double t14_length) {
  return translation(m.target_point) * x_slide(m, e.x) * y_slide(m, e.y) * z_slide(m, e.z) *
         probe(m, t14_length) * translation(m.cutting_point);
}

/// Eq. 3.
Vector3d printed_sum(const Dimensions& m) {
  const auto sum = [](const std::array<double, 4>& v) { return v[0] + v[1] + v[2] + v[3]; };
  return Vector3d(sum(m.a), sum(m.b), sum(m.c)) + m.x + m.target_point + m.cutting_point;
}

Errors12 some_errors() {
  return {{3e-6, 5e-6, -7e-6, 11e-6}, {-13e-6, 17e-6, 19e-6, -23e-6}, {29e-6, -31e-6, 37e-6, 41e-6}};
}

/// Eq. 14.
Vector3d error_sum(const Errors12& e) {
  return {e.x.scale_slide + e.x.scale_screw + e.y.first + e.z.first,
          e.x.first + e.y.scale_slide + e.y.scale_screw + e.z.second,
          e.x.second + e.y.second + e.z.scale_slide + e.z.scale_screw};
}

TEST(DenavitHartenberg, ProductOfTable1IsEquation3) {
  const Dimensions m = dimensions();
  const Matrix4d product = closed_loop(m, {}, -m.b[3]);
  EXPECT_LT((product - translation(printed_sum(m))).norm(), 1e-15);
  EXPECT_LT((probe(m, -m.b[3]) - translation({m.a[3], m.b[3], m.c[3]})).norm(), 1e-15);  // eq. 11
}

TEST(DenavitHartenberg, ProductOfTable1AsPrintedIsNot) {
  const Dimensions m = dimensions();
  const Matrix4d product = closed_loop(m, {}, m.b[3]);
  const Vector3d difference = product.topRightCorner<3, 1>() - printed_sum(m);
  EXPECT_LT((difference - Vector3d(0, -2.0 * m.b[3], 0)).norm(), 1e-15);
  EXPECT_LT((product.topLeftCorner<3, 3>() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

/// Eq. 2: the loop closes when the target point is where the tool is.
TEST(DenavitHartenberg, LoopClosesWithoutErrors) {
  Dimensions m = dimensions();
  m.target_point -= printed_sum(m);
  EXPECT_LT((closed_loop(m, {}, -m.b[3]) - Matrix4d::Identity()).norm(), 1e-15);
}

TEST(DenavitHartenberg, ProductOfTable2IsEquation13) {
  const Dimensions m = dimensions();
  const Errors12 e = some_errors();
  EXPECT_LT((closed_loop(m, e, -m.b[3]) - translation(printed_sum(m) + error_sum(e))).norm(), 1e-15);
  // Eq. 5, 9 and 10, one slide each.
  const Vector3d x(m.a[0] + m.x[0] + e.x.scale_slide + e.x.scale_screw, m.b[0] + e.x.first,
                   m.c[0] + e.x.second);
  const Vector3d y(m.a[1] + e.y.first, m.b[1] + m.x[1] + e.y.scale_slide + e.y.scale_screw,
                   m.c[1] + e.y.second);
  const Vector3d z(m.a[2] + e.z.first, m.b[2] + e.z.second,
                   m.c[2] + m.x[2] + e.z.scale_slide + e.z.scale_screw);
  EXPECT_LT((x_slide(m, e.x) - translation(x)).norm(), 1e-15);
  EXPECT_LT((y_slide(m, e.y) - translation(y)).norm(), 1e-15);
  EXPECT_LT((z_slide(m, e.z) - translation(z)).norm(), 1e-15);
}

/// Twelve errors: nine displacements and, eq. 7 and 8 and their like for y, three squareness angles. As a
/// machine of ours: primary axis Z, secondary Y, so that alpha_xy, alpha_xz and alpha_yz belong to X, X and
/// Y; a rotation about y lifts +x to -z, hence alpha_xz = -EB0X.
struct TwelveErrors {
  std::array<Vector3d, 3> displacement;  ///< delta' of axis x, y, z
  double alpha_xy, alpha_xz, alpha_yz;
};

Errors12 of_the_paper(const TwelveErrors& t, const Vector3d& q) {
  const auto& d = t.displacement;
  return {{d[0].x(), 0.0, d[0].y() + t.alpha_xy * q.x(), d[0].z() + t.alpha_xz * q.x()},
          {d[1].y(), 0.0, d[1].x(), d[1].z() + t.alpha_yz * q.y()},
          {d[2].z(), 0.0, d[2].x(), d[2].y()}};
}

PoseErrors<double> of_ours(const TwelveErrors& t) {
  PoseErrors<double> errors;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < 3; ++k) {
      errors.motion[axis][k] = t.displacement[axis][static_cast<Eigen::Index>(k)];
    }
  }
  error_of(errors, "EC0X") = t.alpha_xy;
  error_of(errors, "EB0X") = -t.alpha_xz;
  error_of(errors, "EA0Y") = t.alpha_yz;
  return errors;
}

TEST(DenavitHartenberg, TwelveErrorModelIsOneOfOursWithTheOppositeSign) {
  std::mt19937_64 random(12);
  Machine machine = machine_of("w X' Y' b Z t");
  machine.datum = {AxisName::Z, AxisName::Y};
  for (Axis& axis : machine.axes) axis.reference_point = random_vector(random, 0.4);
  const KinematicChain chain(machine);
  for (int i = 0; i < 50; ++i) {
    const TwelveErrors t{
        {random_vector(random, 50e-6), random_vector(random, 50e-6), random_vector(random, 50e-6)},
        80e-6,
        -60e-6,
        40e-6};
    const Vector3d q = random_vector(random, 1.0);
    const Vector3d tool = random_vector(random, 0.3);
    const AxisPosition position = {q.x(), q.y(), q.z(), 0, 0, 0};
    const Vector3d ours = chain.first_order(position, tool, of_ours(t)).displacement_w;
    const Vector3d point = chain.nominal_point_w(position, tool);
    // Eq. 1: E = P - Pa, where the actual point Pa lies off by the deltas of the chain.
    const Vector3d actual = point + error_sum(of_the_paper(t, q));
    EXPECT_LT((ours + (point - actual)).norm(), 1e-15);
    const Vector3d exact = chain.exact_pose<double>(position, tool, of_ours(t)).point_w - point;
    EXPECT_LT((exact - ours).norm(), 0.02e-6);
  }
}

TEST(DenavitHartenberg, TwelveErrorModelLeavesOutTheRotations) {
  Campaign campaign;
  campaign.machine = machine_of("w X' Y' b Z t");
  campaign.machine.datum = {AxisName::Z, AxisName::Y};
  ModelSpec spec;
  spec.default_function.degree = 1;
  for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
    for (const Component component : kAllComponents) {
      FunctionSpec& function = spec.functions[{component, axis}];
      function.basis = is_rotation(component) ? "zero" : "bspline";
      function.degree = 1;
      if (!is_rotation(component)) function.breakpoints = {0.0, 1.0};
    }
  }
  const MeasurementModel model(campaign, spec);
  std::vector<std::string> names;
  for (const ErrorSymbol symbol : model.layout().symbols()) names.push_back(symbol.name());
  for (const ParameterBlock& block : model.layout().blocks) names.push_back(block.name);
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"EA0Y", "EB0X", "EC0X", "EXX", "EXY", "EXZ", "EYX", "EYY", "EYZ",
                                             "EZX", "EZY", "EZZ"}));
}

std::unique_ptr<Basis> spline_on(int degree, const std::vector<double>& nodes) {
  Axis axis;
  axis.travel_min = nodes.front();
  axis.travel_max = nodes.back();
  FunctionSpec spec;
  spec.degree = degree;
  spec.breakpoints = nodes;
  return find_basis("bspline")->make(spec, axis);
}

/// 4.1: linear 1-D elements, N = (1 - xi) / 2, (1 + xi) / 2 on every element: splines of degree 1 with the
/// nodal values as coefficients.
TEST(DenavitHartenberg, LinearElementsAreSplinesOfDegreeOne) {
  const std::vector<double> nodes = {0.0, 0.03, 0.06, 0.08};
  const Eigen::Vector4d nodal(5e-6, 96e-6, 250e-6, 363e-6);
  const auto basis = spline_on(1, nodes);
  for (std::size_t element = 0; element + 1 < nodes.size(); ++element) {
    for (const double xi : {-1.0, -0.4, 0.0, 0.7, 1.0}) {
      const double q =
          0.5 * (nodes[element] + nodes[element + 1]) + 0.5 * xi * (nodes[element + 1] - nodes[element]);
      const auto left = static_cast<Eigen::Index>(element);
      const double expected = 0.5 * (1.0 - xi) * nodal[left] + 0.5 * (1.0 + xi) * nodal[left + 1];
      EXPECT_NEAR(basis->value(q, nodal), expected, 1e-18);
    }
  }
}

/// 4.1: the quadratic 1-D element, N = -xi (1 - xi) / 2, 1 - xi^2, xi (1 + xi) / 2: one interval of degree 2.
/// The middle coefficient is 2 f2 - (f1 + f3) / 2.
TEST(DenavitHartenberg, QuadraticElementIsASplineOfDegreeTwo) {
  const Vector3d nodal(-17e-6, 38e-6, 12e-6);
  const Vector3d coefficients(nodal[0], 2.0 * nodal[1] - 0.5 * (nodal[0] + nodal[2]), nodal[2]);
  const auto basis = spline_on(2, {0.0, 0.01});
  for (const double xi : {-1.0, -0.4, 0.0, 0.7, 1.0}) {
    const double expected =
        -0.5 * xi * (1.0 - xi) * nodal[0] + (1.0 - xi * xi) * nodal[1] + 0.5 * xi * (1.0 + xi) * nodal[2];
    EXPECT_NEAR(basis->value(0.005 * (1.0 + xi), coefficients), expected, 1e-18);
  }
}

}  // namespace
}  // namespace volcal
