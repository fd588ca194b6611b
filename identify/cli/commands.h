#pragma once
/// One accessor per command file, for the registration list.

#include "volcal/identify/cli/command.h"

namespace volcal::cli {

const Command& fit_command();
const Command& compare_command();
const Command& validate_command();
const Command& tables_command();
const Command& init_command();
const Command& simulate_command();

}  // namespace volcal::cli
