#pragma once
/// The compensation of a simulated control: tables as their file holds them, and what they add to the
/// commands. Interpolation, directions and signs are the simulator's own and share nothing with the exporters
/// (identify/compensation), so that a mistake there cannot cancel. m and rad; types of ISO/TR
/// 16907:2015, 8.2.

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "volcal/sim/machine/truth_machine.h"

namespace volcal::sim {

enum class TableValue {
  Correction,  ///< the control adds it
  Error        ///< actual minus nominal: the control subtracts it
};

/// Linear between positions, the end values beyond them unless they repeat; a column per direction of
/// approach, the mean of both where the direction is unknown. A rotary output is turned, rad.
struct ControlAxisTable {
  AxisName input = AxisName::X;
  AxisName output = AxisName::X;
  TableValue meaning = TableValue::Correction;
  std::vector<double> position;  ///< of `input`, ascending
  std::vector<double> towards_plus;
  std::vector<double> towards_minus;
  double period = 0.0;  ///< of `input`, after which the table begins anew; 0 = it does not
};

/// What the product of two tables adds to the first one's output: value times value of `factor` as a number.
struct ControlProduct {
  ControlAxisTable table;
  ControlAxisTable factor;
};

/// Trilinear between nodes, the end values beyond them.
struct ControlGrid {
  TableValue meaning = TableValue::Correction;
  std::array<std::vector<double>, 3> nodes;  ///< of X, Y, Z, ascending; one node: the axis does not matter
  std::vector<Eigen::Vector3d> mean;         ///< of both directions, Z fastest
  /// Per axis, value approaching towards + minus value approaching towards -; empty = none.
  std::array<std::vector<Eigen::Vector3d>, 3> reversal;
};

/// Printer firmware: x -= y xy + z (xz - xy yz), y -= z yz.
struct ControlSkew {
  double xy = 0.0, xz = 0.0, yz = 0.0;
};

/// Rigid twists over positions of the rotary axes of one body, multilinear between nodes (ISO/TR
/// 16907, 9.3.2, Table 3). The control knows its axes and the tool, and moves its linear axes so that the
/// functional point goes where the twist took it from, first order.
struct ControlTwistGrid {
  Machine machine;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  TableValue meaning = TableValue::Correction;
  bool of_table = true;                                 ///< else of the tool
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  ///< of the displacements, in the carrying body
  std::vector<AxisName> axes;
  std::vector<std::vector<double>> nodes;          ///< per axis, ascending
  std::vector<bool> full_turn;                     ///< per axis: modulo a turn, else end values held
  std::vector<Eigen::Matrix<double, 6, 1>> twist;  ///< displacement, rotation; the last axis fastest
};

/// How a control that computes with single errors corrects those of rotary axes.
enum class RotaryModel {
  None,            ///< it does not
  TurnsTheAxes,    ///< an axis takes back its own rotation, linear axes the rest
  MovesLinearAxes  ///< linear axes alone: the position is right, the orientation stays
};

/// A control that computes the functional point from tables of single errors and the tool it was told, with
/// the exact transforms of truth_machine.h. Errors of linear axes count with the rotary axes at 0 and are
/// zero at home approached towards +, but where the control turns the workpiece: their error at home does not
/// turn with it.
struct ControlModel {
  Machine machine;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  TableValue meaning = TableValue::Correction;
  std::map<ErrorSymbol, ControlAxisTable> motions;  ///< `output` is not used; angles in rad
  std::map<LocationSymbol, double> locations;
  RotaryModel rotary = RotaryModel::None;
};

/// LinuxCNC's kinematics of a table C on a tilting A or B, xyzac-trt-kins and xyzbc-trt-kins (trtfuncs.c):
/// the pins of the module, m. The offset counts across the tilting axis: along y of A, along x of B, and
/// along z.
struct ControlPivots {
  AxisName tilt = AxisName::A;
  Eigen::Vector3d rot_point = Eigen::Vector3d::Zero();
  double across_offset = 0.0, z_offset = 0.0;
};

/// A control that runs programs under other pivots than those that the machine was drawn with, for work that
/// was touched off again on a table that stands displaced.
struct ControlPivotChange {
  ControlPivots drawn, loaded;
  Eigen::Vector3d work_moved = Eigen::Vector3d::Zero();
  double tool_length = 0.0;  ///< m
};

/// Tables of one folder; their corrections add up.
struct ControlTables {
  std::vector<ControlAxisTable> axis_tables;
  std::vector<ControlProduct> products;
  std::vector<ControlGrid> grids;
  std::vector<ControlSkew> skews;
  std::vector<ControlTwistGrid> twist_grids;
  std::vector<ControlModel> models;
  std::vector<ControlPivotChange> pivots;

  bool empty() const {
    return axis_tables.empty() && products.empty() && grids.empty() && skews.empty() && twist_grids.empty() &&
           models.empty() && pivots.empty();
  }
};

struct ActiveCompensation {
  ControlTables tables;
  /// m; corrections of linear axes come in whole steps of it (ISO/TR 16907, 11.2 c); 0 = none
  double least_increment = 0.0;
  std::string description;  ///< for the campaign file
};

/// What the control adds to the commands of all axes.
CommandCorrection command_correction(const ActiveCompensation& compensation);

}  // namespace volcal::sim
