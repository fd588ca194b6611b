#include "volcal/identify/montecarlo/counter_random.h"

#include <Random123/philox.h>

#include <Random123/uniform.hpp>
#include <cmath>
#include <numbers>

namespace volcal {
namespace {

std::uint32_t low_word(std::uint64_t value) { return static_cast<std::uint32_t>(value); }
std::uint32_t high_word(std::uint64_t value) { return static_cast<std::uint32_t>(value >> 32U); }
std::uint64_t joined(std::uint32_t low, std::uint32_t high) {
  return static_cast<std::uint64_t>(high) << 32U | low;
}

}  // namespace

CounterRandom::CounterRandom(std::uint64_t seed, std::uint64_t draw, RandomSource source)
    : key_{low_word(seed), high_word(seed)},
      source_(static_cast<std::uint32_t>(source)),
      draw_{low_word(draw), high_word(draw)} {}

/// Calls use(2 k, uniform, uniform) until `count` numbers are made.
template <class Use>
void CounterRandom::for_each_pair(std::size_t count, const Use& use) const {
  r123::Philox4x32 philox;
  const r123::Philox4x32::key_type key = {{key_[0], key_[1]}};
  for (std::size_t i = 0; i < count; i += 2) {
    const r123::Philox4x32::ctr_type counter = {{low_word(i / 2), source_, draw_[0], draw_[1]}};
    const r123::Philox4x32::ctr_type words = philox(counter, key);
    use(i, r123::u01<double>(joined(words[0], words[1])), r123::u01<double>(joined(words[2], words[3])));
  }
}

void CounterRandom::normals(std::span<double> out) const {
  for_each_pair(out.size(), [&](std::size_t i, double first, double second) {
    const double radius = std::sqrt(-2.0 * std::log(first));
    const double angle = 2.0 * std::numbers::pi * second;
    out[i] = radius * std::cos(angle);
    if (i + 1 < out.size()) out[i + 1] = radius * std::sin(angle);
  });
}

void CounterRandom::uniforms(std::span<double> out) const {
  for_each_pair(out.size(), [&](std::size_t i, double first, double second) {
    out[i] = first;
    if (i + 1 < out.size()) out[i + 1] = second;
  });
}

}  // namespace volcal
