#pragma once
/// Effects as the user writes them on the command line: a target and an expression.

#include <CLI/App.hpp>
#include <memory>
#include <string>
#include <vector>

#include "volcal/model/effects/effect.h"

namespace volcal::cli {

struct WrittenEffect {
  EffectSpec spec;
  std::unique_ptr<Effect> made;
};

/// Option --parameter NAME=VALUE or NAME=VALUE+-U of the parameters in expressions.
void add_parameter_option(CLI::App& app, std::vector<std::string>& parameters);

/// "EZX: abs(x) / 400 * dir_x" or "EXX += dir_x * (T_column - 20)" as an effect of kind custom. Throws
/// InputError that names `option` and the column of the text.
WrittenEffect written_effect(const std::string& option, const std::string& text,
                             const std::vector<std::string>& parameters);

}  // namespace volcal::cli
