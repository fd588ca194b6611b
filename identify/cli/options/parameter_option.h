#pragma once
/// Option --parameter of the expressions that a user writes.

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace volcal::cli {

/// --parameter NAME=VALUE or NAME=VALUE+-U, as written_effect() takes them.
void add_parameter_option(CLI::App& app, std::vector<std::string>& parameters);

}  // namespace volcal::cli
