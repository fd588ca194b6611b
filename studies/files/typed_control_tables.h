#pragma once
/// The simulated control's reading of tables that are entered by hand, the part of control_tables.cpp for
/// HEIDENHAIN and FANUC: from the documents of the controllers, apart from the formats' own readers. A number
/// or a word that is not there throws a std::logic_error.

#include <span>

#include "volcal/identify/text/table_text.h"
#include "volcal/sim/machine/control.h"

namespace volcal {

sim::ControlTables heidenhain_control(std::span<const TableFile> files);
sim::ControlTables fanuc_control(std::span<const TableFile> files);

}  // namespace volcal
