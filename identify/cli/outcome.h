#pragma once
/// How the program ends: an exit code, and a sentence for whatever went wrong.

#include <functional>
#include <string>
#include <string_view>

namespace volcal::cli {

/// Exit code of the work (command.h), or of what it throws; standard output is flushed, and told of where it
/// cannot be written.
int outcome_of(const std::function<int()>& work);

/// A message as it may go to a terminal, which what it quotes must not steer: control characters become '?'.
std::string shown(std::string_view message);

}  // namespace volcal::cli
