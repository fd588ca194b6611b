// Zhao Y., Li T., Tang X.: Geometric Error Modeling of Machine Tools Based on Screw Theory. Eq. 1 to 17 for
// the 2-DOF mechanism, and ranks of the 60 error twists of the 5-axis machine (Table 1).
//
// Misprints: eq. 12, 14 and 16 repeat dS_xY, dS_zY and dS_bY where dx_Y, dz_Y and dS_bX belong. Eq. 13 and
// 15, which have the same structure, are printed right.

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <numbers>
#include <vector>

#include "tests/support/machines.h"
#include "tests/support/singular_values.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using testing_support::machine_of;
using testing_support::random_vector;
using Twist = Eigen::Matrix<double, 6, 1>;  ///< displacement of the functional point, rotation

Twist twist(const Vector3d& displacement, const Vector3d& rotation) {
  Twist t;
  t << displacement, rotation;
  return t;
}

/// Position-dependent error of an axis, dv_V or du_V: in the frame behind the axis, eq. 1, 2, 7, 8. A rotary
/// axis turns that frame.
Twist position_dependent(const JointLever& lever, Component component) {
  if (!is_rotary(lever.axis)) {
    return twist(KinematicChain::motion_lever_w(lever, component),
                 KinematicChain::motion_rotation_w(lever, component));
  }
  const Matrix3d turn = rotation_about(direction_of(lever.axis), lever.position);
  Twist sum = Twist::Zero();
  for (const Component stator : kAllComponents) {
    if (is_rotation(stator) != is_rotation(component)) continue;
    sum += turn(direction_of(stator), direction_of(component)) *
           twist(KinematicChain::motion_lever_w(lever, stator),
                 KinematicChain::motion_rotation_w(lever, stator));
  }
  return sum;
}

/// Position-independent error, dS_vV or dS_uV: in the frame before the axis, eq. 3, 4, 9, 10. For a linear
/// axis it turns the direction of travel too, which is our squareness.
Twist position_independent(const JointLever& lever, Component component) {
  const Vector3d displacement = KinematicChain::motion_lever_w(lever, component);
  const Vector3d rotation = KinematicChain::motion_rotation_w(lever, component);
  if (is_rotary(lever.axis)) return twist(displacement, rotation);
  return twist(displacement + KinematicChain::location_lever_w(lever, component), rotation);
}

struct AxisErrors {
  std::array<double, 6> moving;  ///< dx dy dz da db dc
  std::array<double, 6> fixed;   ///< dS_x ... dS_c
};

AxisErrors random_axis_errors(std::mt19937_64& random) {
  AxisErrors e{};
  for (double& value : e.moving) value = testing_support::uniform(random, 1e-4);
  for (double& value : e.fixed) value = testing_support::uniform(random, 1e-4);
  return e;
}

/// Eq. 12 to 17, corrected. X and Y: errors of the axes, x and y their positions, (Xt, Yt) the tool.
Twist printed_equations(const AxisErrors& X, const AxisErrors& Y, double x, double y, double Xt, double Yt) {
  const auto& d = X.moving;
  const auto& S = X.fixed;
  const auto& dY = Y.moving;
  const auto& SY = Y.fixed;
  constexpr std::size_t a = 3;
  constexpr std::size_t b = 4;
  constexpr std::size_t c = 5;
  Twist sum;
  sum << d[0] + S[0] + dY[0] + SY[0] - (y + Yt) * (d[c] + SY[c] + S[c]) - Yt * dY[c],
      d[1] + S[1] + dY[1] + SY[1] + Xt * (d[c] + SY[c] + S[c] + dY[c]) + x * S[c],
      d[2] + S[2] + dY[2] + SY[2] + (y + Yt) * (d[a] + S[a] + SY[a]) - Xt * (d[b] + dY[b] + SY[b]) -
          (x + Xt) * S[b] + Yt * dY[a],
      d[a] + S[a] + SY[a] + dY[a],  //
      d[b] + dY[b] + SY[b] + S[b],  //
      d[c] + SY[c] + S[c] + dY[c];
  return sum;
}

/// The same as printed, with the three repeated terms.
Twist misprinted_equations(const AxisErrors& X, const AxisErrors& Y, double x, double y, double Xt,
                           double Yt) {
  Twist sum = printed_equations(X, Y, x, y, Xt, Yt);
  sum[0] += Y.fixed[0] - Y.moving[0];
  sum[2] += Y.fixed[2] - Y.moving[2];
  sum[4] += Y.fixed[4] - X.fixed[4];
  return sum;
}

TEST(ErrorTwists, TwoAxisMechanismIsEquations12To17) {
  std::mt19937_64 random(31);
  const KinematicChain chain(machine_of("w b X Y t"));
  for (int i = 0; i < 100; ++i) {
    const AxisErrors of_x = random_axis_errors(random);
    const AxisErrors of_y = random_axis_errors(random);
    const Vector3d q = random_vector(random, 1.0);
    const Vector3d tool(testing_support::uniform(random, 0.5), testing_support::uniform(random, 0.5), 0.0);
    std::array<JointLever, 2> levers;
    chain.levers({q.x(), q.y(), 0, 0, 0, 0}, tool, levers.data());
    Twist sum = Twist::Zero();
    for (const Component component : kAllComponents) {
      const std::size_t k = index_of(component);
      sum += of_x.moving[k] * position_dependent(levers[0], component);
      sum += of_x.fixed[k] * position_independent(levers[0], component);
      sum += of_y.moving[k] * position_dependent(levers[1], component);
      sum += of_y.fixed[k] * position_independent(levers[1], component);
    }
    EXPECT_LT((sum - printed_equations(of_x, of_y, q.x(), q.y(), tool.x(), tool.y())).norm(), 1e-15);
    EXPECT_GT((sum - misprinted_equations(of_x, of_y, q.x(), q.y(), tool.x(), tool.y())).norm(), 1e-7);
  }
}

// The 5-axis blade milling machine, chain F-X-Y-Z-A-B.

constexpr int kTwists = 60;
constexpr int kPoses = 60;

struct Column {
  int axis;  ///< 0..4 in X Y Z A B
  bool fixed;
  Component component;
};

std::vector<Column> all_columns() {
  std::vector<Column> columns;
  for (int axis = 0; axis < 5; ++axis) {
    for (const bool fixed : {true, false}) {
      for (const Component component : kAllComponents) columns.push_back({axis, fixed, component});
    }
  }
  return columns;
}

enum class Seen { Pose, PositionOnly };

/// Rows: what is seen at random poses with every tool; one column per twist.
MatrixXd jacobian(const std::vector<Column>& columns, const std::vector<Vector3d>& tools, Seen seen) {
  std::mt19937_64 random(33);
  Machine machine = machine_of("w b X Y Z A B t");
  machine.axes[3].centre = Vector3d(0.1, -0.2, 0.15);
  machine.axes[4].centre = Vector3d(-0.05, 0.1, 0.2);
  const KinematicChain chain(machine);
  const int rows = seen == Seen::Pose ? 6 : 3;
  const auto per_tool = static_cast<Eigen::Index>(rows) * kPoses;
  MatrixXd result(per_tool * static_cast<Eigen::Index>(tools.size()),
                  static_cast<Eigen::Index>(columns.size()));
  Eigen::Index row = 0;
  for (const Vector3d& tool : tools) {
    for (int pose = 0; pose < kPoses; ++pose, row += rows) {
      const AxisPosition position = testing_support::random_position(random);
      std::array<JointLever, 5> levers;
      chain.levers(position, tool, levers.data());
      for (std::size_t j = 0; j < columns.size(); ++j) {
        const JointLever& lever = levers[static_cast<std::size_t>(columns[j].axis)];
        const Twist t = columns[j].fixed ? position_independent(lever, columns[j].component)
                                         : position_dependent(lever, columns[j].component);
        result.block(row, static_cast<Eigen::Index>(j), rows, 1) = t.head(rows);
      }
    }
  }
  return result;
}

/// Rank with the gap that makes it certain: singular values beyond it are rounding.
int rank_of(const MatrixXd& matrix) {
  const Eigen::VectorXd values = testing::singular_values(matrix);
  const auto rank = static_cast<int>((values.array() > 1e-10 * values[0]).count());
  EXPECT_GT(values[rank - 1], 1e-4 * values[0]);
  return rank;
}

MatrixXd beside(const MatrixXd& left, const MatrixXd& right) {
  MatrixXd joined(left.rows(), left.cols() + right.cols());
  joined << left, right;
  return joined;
}

/// Table 1; S_F is the frame before X, S_X the frame behind X, and so on.
std::vector<Column> twenty_of_table_1() {
  constexpr bool kBefore = true;
  constexpr bool kBehind = false;
  return {{0, kBefore, Component::X}, {0, kBefore, Component::Y}, {0, kBefore, Component::Z},
          {0, kBehind, Component::A}, {0, kBehind, Component::B}, {0, kBehind, Component::C},
          {0, kBefore, Component::B}, {0, kBefore, Component::C},                              // S_F
          {1, kBehind, Component::A}, {1, kBehind, Component::C},                              // S_Y
          {2, kBehind, Component::A}, {2, kBehind, Component::B},                              // S_Z
          {3, kBehind, Component::B}, {3, kBehind, Component::C}, {3, kBehind, Component::Y},  // S_A
          {3, kBehind, Component::Z}, {4, kBehind, Component::A}, {4, kBehind, Component::C},  // S_B
          {4, kBehind, Component::X}, {4, kBehind, Component::Z}};
}

const Vector3d kAxialTool(0, 0, -0.2);
const Vector3d kLongTool(0, 0, -0.35);
const Vector3d kOffsetTool(0.06, 0, -0.2);

/// 20 = 6 + 2 per linear axis + 4 per rotary axis.
TEST(ErrorTwists, SixtyTwistsHaveRankTwenty) {
  const MatrixXd sixty = jacobian(all_columns(), {kAxialTool}, Seen::Pose);
  ASSERT_EQ(sixty.cols(), kTwists);
  EXPECT_EQ(rank_of(sixty), 20);
}

TEST(ErrorTwists, TheTwentyOfTable1SpanTheSameSpace) {
  const MatrixXd sixty = jacobian(all_columns(), {kAxialTool}, Seen::Pose);
  const MatrixXd twenty = jacobian(twenty_of_table_1(), {kAxialTool}, Seen::Pose);
  ASSERT_EQ(twenty.cols(), 20);
  EXPECT_EQ(rank_of(twenty), 20);
  EXPECT_EQ(rank_of(beside(sixty, twenty)), 20);
}

TEST(ErrorTwists, PositionsAloneSeeLess) {
  const auto rank_with = [](const std::vector<Vector3d>& tools) {
    return rank_of(jacobian(all_columns(), tools, Seen::PositionOnly));
  };
  EXPECT_EQ(rank_with({kAxialTool}), 17);
  EXPECT_EQ(rank_with({kAxialTool, kLongTool}), 19);
  EXPECT_EQ(rank_with({kAxialTool, kLongTool, kOffsetTool}), 20);
}

/// Less the frames of workpiece (before X) and tool (behind B): eight location errors.
TEST(ErrorTwists, EightLocationErrorsRemainWithoutTheFrames) {
  std::vector<Column> frames;
  for (const Component component : kAllComponents) {
    frames.push_back({0, true, component});
    frames.push_back({4, false, component});
  }
  const MatrixXd of_frames = jacobian(frames, {kAxialTool}, Seen::Pose);
  EXPECT_EQ(rank_of(of_frames), 12);
  const MatrixXd sixty = jacobian(all_columns(), {kAxialTool}, Seen::Pose);
  const MatrixXd fit = of_frames.colPivHouseholderQr().solve(sixty);
  EXPECT_EQ(rank_of(sixty - of_frames * fit), 8);
}

}  // namespace
}  // namespace volcal
