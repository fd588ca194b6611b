#pragma once
/// Sine and cosine for loops that the compiler turns into vector instructions, the same to the bit for every
/// instruction set.

#include <bit>
#include <cstdint>
#include <numbers>

namespace volcal {

struct UnitVector {
  double cosine, sine;
};

/// Direction of `turns` turns, |turns| below 10^5: the nearest quarter turn, and Taylor series over the rest.
/// To 5e-16 (1 + 2 pi |turns|), of which the part in proportion is the rounding of `turns` itself.
[[gnu::always_inline]] inline UnitVector unit_vector(double turns) {
  constexpr double kRounds = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to a whole number
  const double shifted = 4.0 * turns + kRounds;
  const auto quarter = std::bit_cast<std::uint64_t>(shifted);
  const double x = (4.0 * turns - (shifted - kRounds)) * (0.5 * std::numbers::pi), z = -x * x;
  double sine = 1.0, cosine = 1.0;
  for (int n = 16; n >= 2; n -= 2) {
    sine = 1.0 + sine * (z * (1.0 / (n * (n + 1))));
    cosine = 1.0 + cosine * (z * (1.0 / (n * (n - 1))));
  }
  sine *= x;
  const bool swaps = (quarter & 1U) != 0;
  const double across = swaps ? cosine : sine, along = swaps ? sine : cosine;
  return {((quarter + 1U) & 2U) != 0 ? -along : along, (quarter & 2U) != 0 ? -across : across};
}

}  // namespace volcal
