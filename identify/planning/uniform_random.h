#pragma once

#include <random>

namespace volcal {

/// Uniform in -1 ... 1, the same with every standard library.
inline double symmetric_uniform(std::mt19937_64& random) {
  return 2.0 * (static_cast<double>(random() >> 11U) * 0x1p-53) - 1.0;
}

}  // namespace volcal
