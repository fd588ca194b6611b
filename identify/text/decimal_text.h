#pragma once
/// Numbers of large tables as text.

#include <fmt/format.h>

namespace volcal {

/// Appends `value` to the nearest of `decimals` decimals, at most 9, without zeros at the end: "-0.25", "3",
/// "0". Numbers that are too large for that, or not finite, as fmt writes them with nine digits.
void append_decimal(double value, int decimals, fmt::memory_buffer& text);

}  // namespace volcal
