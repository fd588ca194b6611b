#pragma once
/// Studies that count over many simulated campaigns: `volcal study NAME`. A study is one file that defines a
/// `Command` and one line in studies.cpp.

#include <span>

#include "volcal/identify/cli/command.h"

namespace volcal::cli {

std::span<const Command* const> study_commands();

}  // namespace volcal::cli
