#pragma once
/// Skews of printer firmware as the simulated control takes them, the part of control_tables.cpp for them:
/// apart from the formats' own readers. A number or a word that is not there throws a std::logic_error.

#include <span>

#include "volcal/identify/text/table_text.h"
#include "volcal/sim/machine/control.h"

namespace volcal {

sim::ControlTables klipper_control(std::span<const TableFile> files);
sim::ControlTables marlin_control(std::span<const TableFile> files);

}  // namespace volcal
