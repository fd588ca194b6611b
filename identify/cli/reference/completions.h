#pragma once
/// Completions of the command line for shells, one file each.

#include <string>

#include "volcal/identify/cli/reference/command_table.h"

namespace volcal::cli {

std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);
std::string fish_completion(const CommandEntry& program);

/// Whether a value may be the name of a file: a text of no fixed words.
bool takes_file(const OptionEntry& option);

}  // namespace volcal::cli
