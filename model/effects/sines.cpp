#include "volcal/model/effects/sines.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

constexpr double kLargestAngle = 1e6;  // multiples of pi/2 below have 20 bits
constexpr double kToWhole = 0x1.8p52;  // added, it leaves whole numbers, their last bits those of the sum
constexpr double kHalfPi[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34,
                              0x1.3198a2e037073p-69};  // 33 bits, 33, the rest

/// Of angles up to pi/4.
inline double sine_near_zero(double r) {
  const double z = r * r;
  const double even = 8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 +
                                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  return r + z * r * (-1.66666666666666324348e-01 + z * even);
}

inline double cosine_near_zero(double r) {
  const double z = r * r;
  const double even = 4.16666666666666019037e-02 +
                      z * (-1.38888888888741095749e-03 +
                           z * (2.48015872894767294178e-05 +
                                z * (-2.75573143513906633035e-07 +
                                     z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  return 1.0 - (0.5 * z - z * z * even);
}

VOLCAL_VECTOR_LOOPS
void write_of_small_angles(const double* __restrict angle, std::size_t count, double* __restrict cosine,
                           double* __restrict sine) {
  for (std::size_t i = 0; i < count; ++i) {
    const double shifted = angle[i] * (2.0 / std::numbers::pi) + kToWhole;
    const double quarters = shifted - kToWhole;
    const double r = ((angle[i] - quarters * kHalfPi[0]) - quarters * kHalfPi[1]) - quarters * kHalfPi[2];
    const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
    const auto own_sine = std::bit_cast<std::uint64_t>(sine_near_zero(r));
    const auto own_cosine = std::bit_cast<std::uint64_t>(cosine_near_zero(r));
    const std::uint64_t odd = std::uint64_t{0} - (quadrant & 1U);
    const std::uint64_t change = (own_sine ^ own_cosine) & odd;
    sine[i] = std::bit_cast<double>((own_sine ^ change) ^ ((quadrant & 2U) << 62U));
    cosine[i] = std::bit_cast<double>((own_cosine ^ change) ^ (((quadrant + 1U) & 2U) << 62U));
  }
}

}  // namespace

void write_cosines_and_sines(const double* angle, std::size_t count, double* cosine, double* sine) {
  bool small = true;
  for (std::size_t i = 0; i < count; ++i) small = small && std::abs(angle[i]) <= kLargestAngle;
  if (small) return write_of_small_angles(angle, count, cosine, sine);
  for (std::size_t i = 0; i < count; ++i) {
    cosine[i] = std::cos(angle[i]);
    sine[i] = std::sin(angle[i]);
  }
}

}  // namespace volcal
