#pragma once
/// The parameters of a fit and its error tables, each with their covariance, as one NumPy archive.

#include <string>

#include "volcal/identify/io/exports/joint_values.h"

namespace volcal {

/// Arrays `names`, `units`, `values`, `covariance` of the parameters; `table_names`, `table_positions`,
/// `table_position_units`, `table_directions`, `table_extrapolated`, `table_units`, `table_values`,
/// `table_covariance` of the rows of the tables.
std::string covariance_npz(const JointValues& parameters, const JointTable& table);

}  // namespace volcal
