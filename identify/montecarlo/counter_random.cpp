#include "volcal/identify/montecarlo/counter_random.h"

#include <Random123/philox.h>

#include <Random123/uniform.hpp>
#include <algorithm>

#include "volcal/identify/montecarlo/box_muller.h"

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

/// Calls use(i, uniform, uniform) for numbers i and i + 1 of [begin, end), begin even.
template <class Use>
void CounterRandom::for_each_pair(std::size_t begin, std::size_t end, const Use& use) const {
  r123::Philox4x32 philox;
  const r123::Philox4x32::key_type key = {{key_[0], key_[1]}};
  for (std::size_t i = begin; i < end; i += 2) {
    const r123::Philox4x32::ctr_type counter = {{low_word(i / 2), source_, draw_[0], draw_[1]}};
    const r123::Philox4x32::ctr_type words = philox(counter, key);
    use(i, r123::u01<double>(joined(words[0], words[1])), r123::u01<double>(joined(words[2], words[3])));
  }
}

void CounterRandom::normals(std::span<double> out) const {
  constexpr std::size_t kPairs = 256;
  double first[kPairs], second[kPairs];
  for (std::size_t begin = 0; begin < out.size(); begin += 2 * kPairs) {
    const std::size_t end = std::min(begin + 2 * kPairs, out.size());
    for_each_pair(begin, end, [&](std::size_t i, double a, double b) {
      first[(i - begin) / 2] = a;
      second[(i - begin) / 2] = b;
    });
    box_muller((end - begin + 1) / 2, first, second);
    for (std::size_t i = begin; i < end; ++i) out[i] = (i % 2 == 0 ? first : second)[(i - begin) / 2];
  }
}

void CounterRandom::uniforms(std::span<double> out) const {
  for_each_pair(0, out.size(), [&](std::size_t i, double first, double second) {
    out[i] = first;
    if (i + 1 < out.size()) out[i + 1] = second;
  });
}

}  // namespace volcal
