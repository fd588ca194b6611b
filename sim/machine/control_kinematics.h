#pragma once
/// Parts of a simulated control: the value of a table, and corrections that it computes with the kinematics
/// that it was told, by exact transforms.

#include <utility>

#include "volcal/sim/machine/control.h"

namespace volcal::sim {

/// -1 where the control subtracts, +1 where it adds.
double sign_of(TableValue meaning);
/// Index of the upper end of the interval that q lies in, and how far q is in it, 0 to 1.
std::pair<std::size_t, double> interval_of(const std::vector<double>& position, double q);
double table_value(const ControlAxisTable& table, const MachineState& state);

CommandCorrection model_correction(const ControlModel& model);
CommandCorrection twist_correction(const ControlTwistGrid& grid);
CommandCorrection pivot_correction(const ControlPivotChange& change);

}  // namespace volcal::sim
