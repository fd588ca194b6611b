#pragma once
/// "Did you mean": the known name closest to one that is unknown.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace volcal {

/// The candidate with the smallest edit distance (insert, delete, replace, swap of neighbours; letter case
/// counts a quarter), or nothing when none is close enough to be a slip of the pen.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates);

/// A remedy in words: `did you mean "tool"?` or `known WHAT: a, b, c`, the former when a name is close.
std::string suggest_name(std::string_view name, std::span<const std::string> candidates,
                         std::string_view what);

/// "a, b, c"; at most twelve names, then "...".
std::string join_names(std::span<const std::string> names);

}  // namespace volcal
