#pragma once
/// Manual pages (section 1) of the program and of every command, in the macros of man(7).

#include <string>

#include "volcal/identify/cli/reference/command_table.h"

namespace volcal::cli {

/// The page of one command of the table. `date` as in 2026-01-31.
std::string manual_page(const CommandEntry& program, const CommandEntry& command, const std::string& date);

}  // namespace volcal::cli
