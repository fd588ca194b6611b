#pragma once
/// Comments above a rewritten program: what it was made of and is valid for, and the conditions at which its
/// errors were taken.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/errors/conditions.h"

namespace volcal {

inline constexpr std::size_t kLongestLine = 255;  ///< characters without line end: what LinuxCNC reads

/// "(text)", or "; text" where brackets are no comment, as in programs with TRAORI.
enum class CommentStyle { Brackets, Semicolon };

/// "(volcal compensate: MADE_OF)", then "(conditions: T_air_degC=23.3 as stated, ...)" where there are any
/// (acting_conditions.h); lines without their ends, of at most kLongestLine characters. Brackets and control
/// characters become underscores.
std::vector<std::string> program_header(std::string_view made_of, std::span<const StatedCondition> conditions,
                                        CommentStyle style = CommentStyle::Brackets);

/// Whether a line begins such a header.
bool is_compensated(std::string_view line);

}  // namespace volcal
