// ISO/TR 16907:2015, Machine tools - Numerical compensation of geometric errors: Figure 6 (7.4.1) and the
// layout of Table 1 (9.2.3).

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::error_of;
using testing_support::machine_of;

constexpr double kMicrometre = 1e-6;
constexpr double kMicroradian = 1e-6;

double x_error_per_microradian_of_ecx(const std::string& structure, double y, const Vector3d& tool) {
  PoseErrors<double> errors;
  error_of(errors, "ECX") = 1.0 * kMicroradian;
  const KinematicChain chain(machine_of(structure));
  return chain.first_order({0.4, y, 0, 0, 0, 0}, tool, errors).displacement_w.x() / kMicrometre;
}

/// Figure 6: on lines 1 000 mm apart in Y, EXX differs by 1 um per urad of ECX, smaller on the +Y side. The
/// distance is a move of Y where Y is carried by X, or carries the tool past a table that X moves; else it is
/// a tool.
TEST(IsoTr16907, Figure6AbbeRule) {
  const Vector3d at_spindle = Vector3d::Zero();
  const Vector3d sideways(0, 1.0, 0);
  for (const char* structure :
       {"w X' b Y Z t", "w b X Y Z t", "w X b Y Z t", "w X' Y' b Z t", "w Y' b X Z t", "w b Y X Z t"}) {
    const double first = x_error_per_microradian_of_ecx(structure, 0.0, at_spindle);
    EXPECT_EQ(first, 0.0) << structure;
    EXPECT_NEAR(x_error_per_microradian_of_ecx(structure, 0.0, sideways) - first, -1.0, 1e-12) << structure;
  }
  for (const char* structure : {"w X' b Y Z t", "w b X Y Z t", "w X' Y' b Z t"}) {
    EXPECT_NEAR(x_error_per_microradian_of_ecx(structure, 1.0, at_spindle), -1.0, 1e-12) << structure;
  }
  // Y nearer the workpiece on the tool side: X does not see it move.
  EXPECT_EQ(x_error_per_microradian_of_ecx("w b Y X Z t", 1.0, at_spindle), 0.0);
}

/// Rows of Table 1: position mm, EXX(+) and EXX(-) in um.
constexpr std::array<std::array<double, 3>, 3> kTable1 = {
    {{0.0, 0.0, 0.8}, {50.0, 1.5, 2.2}, {100.0, 1.9, 2.5}}};
/// EXX(+) - EXX(-) in um: -0.8 at home, -0.7 and -0.6 behind it.
constexpr double kReversalAtHome = -0.8, kReversalPerMetre = 2.0;
/// Mean of both directions in um, from home: that of the table less half of the reversal at home.
constexpr std::array<double, 3> kMeanOfTable1 = {0.0, 1.45, 1.8};

ParameterBlock effect_block(const std::string& name, int offset) {
  ParameterBlock block;
  block.kind = ParameterKind::Effect;
  block.name = name;
  block.offset = offset;
  block.guess = Eigen::VectorXd::Zero(1);
  return block;
}

/// X axis of 100 mm: mean EXX as a spline, a reversal that changes along the travel.
FitResult identified_axis() {
  FitResult result;
  result.machine = machine_of("w b X t");
  Axis& axis = result.machine.axes[0];
  axis.travel_max = 0.1;
  FunctionSpec spec;
  spec.degree = 1;
  spec.breakpoints = {0.0, 0.05, 0.1};
  FunctionGroup group;
  group.basis = find_basis("bspline")->make(spec, axis);
  group.symbols = {{Component::X, AxisName::X}};
  result.layout.groups = {group};
  result.layout.blocks = {effect_block("reversal EXX", 3), effect_block("reversal EXX along the travel", 4)};
  result.layout.function_size = 3;
  result.layout.size = 5;
  for (const char* kind : {"reversal", "position-reversal"})
    result.identified.effects.push_back(effect_spec(kind, {{"symbol", std::string("EXX")}}));
  result.parameters = Eigen::VectorXd(5);
  result.parameters << 0.0, kMeanOfTable1[1], kMeanOfTable1[2], kReversalAtHome, kReversalPerMetre;
  result.parameters *= kMicrometre;
  result.covariance = Eigen::MatrixXd::Zero(5, 5);
  return result;
}

std::vector<ErrorTableRow> rows_of(const std::vector<ErrorTableRow>& table, int direction) {
  std::vector<ErrorTableRow> rows;
  for (const ErrorTableRow& row : table) {
    if (row.symbol.name() == "EXX" && row.direction == direction) rows.push_back(row);
  }
  return rows;
}

/// One column per direction, the + column zero at home.
TEST(IsoTr16907, Table1Layout) {
  const auto table = error_table(identified_axis(), {.positions = 3, .zero_plus = true});
  const auto plus = rows_of(table, +1);
  const auto minus = rows_of(table, -1);
  ASSERT_EQ(plus.size(), kTable1.size());
  ASSERT_EQ(minus.size(), kTable1.size());
  for (std::size_t i = 0; i < kTable1.size(); ++i) {
    EXPECT_NEAR(plus[i].position * 1e3, kTable1[i][0], 1e-12);
    EXPECT_NEAR(plus[i].value / kMicrometre, kTable1[i][1], 1e-12);
    EXPECT_NEAR(minus[i].value / kMicrometre, kTable1[i][2], 1e-12);
  }
}

/// Without the shift the function is the mean of both directions and the columns lie b/2 on either side.
TEST(IsoTr16907, ColumnsLieHalfAReversalFromTheMean) {
  const auto table = error_table(identified_axis(), {.positions = 3});
  const auto plus = rows_of(table, +1);
  const auto minus = rows_of(table, -1);
  ASSERT_EQ(plus.size(), kTable1.size());
  for (std::size_t i = 0; i < plus.size(); ++i) {
    EXPECT_NEAR(0.5 * (plus[i].value + minus[i].value) / kMicrometre, kMeanOfTable1[i], 1e-12);
    EXPECT_NEAR((plus[i].value - minus[i].value) / kMicrometre, kTable1[i][1] - kTable1[i][2], 1e-12);
  }
}

}  // namespace
}  // namespace volcal
