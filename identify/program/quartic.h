#pragma once
/// The polynomial of degree 4 through five equidistant values.

#include <array>

namespace volcal {

/// Where its values stand, of its length.
inline constexpr std::array<double, 5> kQuarticNodes = {0.0, 0.25, 0.5, 0.75, 1.0};
/// Weights of these values at a share of its length (Lagrange); they add up to 1.
std::array<double, 5> quartic_weights(double share);

}  // namespace volcal
