#pragma once

namespace volcal {

/// Quantile of the standard normal distribution at `probability` in (0, 1); relative accuracy 1e-12.
double normal_quantile(double probability);

}  // namespace volcal
