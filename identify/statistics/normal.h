#pragma once

namespace volcal {

inline constexpr double kCoverageFactor = 1.96;  ///< U95 = 1.96 u: 95 % of a normal distribution

/// Quantile of the standard normal distribution at `probability` in (0, 1); relative accuracy 1e-12.
double normal_quantile(double probability);

}  // namespace volcal
