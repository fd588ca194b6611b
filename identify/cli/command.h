#pragma once
/// The program's commands. A command is one file that defines a `Command` and one line in commands.cpp.

#include <CLI/App.hpp>
#include <functional>
#include <span>
#include <string_view>

namespace volcal::cli {

/// Exit codes of every command.
inline constexpr int kDone = 0;
inline constexpr int kIncomplete =
    1;  ///< ran, but not converged, rank-deficient, or a given limit was exceeded
inline constexpr int kBadInput = 2;

struct Command {
  std::string_view name;
  std::string_view summary;   ///< one line
  std::string_view examples;  ///< printed below the options
  /// Adds options to the sub-command; the returned function does the work and gives the exit code. Bad input
  /// leaves it as InputError.
  std::function<int()> (*define)(CLI::App& app);
};

std::span<const Command* const> commands();

}  // namespace volcal::cli
