#include "volcal/identify/montecarlo/box_muller.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "volcal/model/kinematics/unit_vector.h"
#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

/// log of x in (0, 1]: x = 2^e m with m in [sqrt(1/2), sqrt(2)), log m = 2 artanh((m - 1) / (m + 1)).
[[gnu::always_inline]] inline double natural_log(double x) {
  constexpr std::uint64_t kMantissa = 0xfffffffffffffU, kOne = 0x3ff0000000000000U;
  constexpr std::uint64_t kTwoTo52 = 0x4330000000000000U;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  double exponent = std::bit_cast<double>(bits >> 52U | kTwoTo52) - (4503599627370496.0 + 1023.0);
  auto m = std::bit_cast<double>((bits & kMantissa) | kOne);
  const bool is_large = m > std::numbers::sqrt2;
  m = is_large ? 0.5 * m : m;
  exponent = is_large ? exponent + 1.0 : exponent;
  const double f = (m - 1.0) / (m + 1.0), z = f * f;
  double series = 1.0 / 21.0;
  for (int odd = 19; odd >= 1; odd -= 2) series = series * z + 1.0 / odd;
  return exponent * std::numbers::ln2 + 2.0 * f * series;
}

}  // namespace

VOLCAL_VECTOR_LOOPS void box_muller(std::size_t count, double* __restrict first, double* __restrict second) {
  for (std::size_t i = 0; i < count; ++i) {
    const double radius = std::sqrt(-2.0 * natural_log(first[i]));
    const UnitVector unit = unit_vector(second[i]);
    first[i] = radius * unit.cosine;
    second[i] = radius * unit.sine;
  }
}

}  // namespace volcal
