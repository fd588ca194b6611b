#pragma once
/// What the page of the workbench can draw: a value per observation of the session's campaign, in units of
/// the edge; NaN where it was not recorded.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/session/session.h"

namespace volcal::workbench {

/// A recorded variable.
struct ColumnInfo {
  std::string name;   ///< "x", "dir_x", "T_air"
  std::string label;  ///< "Position X"
  std::string unit;   ///< edge; empty: none
  std::string kind;   ///< "position", "direction", "time" ...
};

/// That vary over the campaign, in the order of Variable::Kind.
std::vector<ColumnInfo> recorded_columns(const Session& session);

/// One of recorded_columns(), or
///   residual@M, sigma@M   of model M, um or urad; sigma of its noise
///   stated_sigma          um or urad
///   heldout, left_out     0 or 1
///   setup, row, channel   from 0; line
///   point_x ... point_z   functional point, workpiece coordinates, mm
///   along_x ... along_z   derivative of the reading to a displacement of the functional point
/// Throws InputError for another name.
Eigen::VectorXd column(const Session& session, const std::string& name);

}  // namespace volcal::workbench
