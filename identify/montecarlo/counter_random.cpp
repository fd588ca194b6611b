#include "volcal/identify/montecarlo/counter_random.h"

#include <Random123/philox.h>

#include <algorithm>

#include "volcal/identify/montecarlo/box_muller.h"
#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

std::uint32_t low_word(std::uint64_t value) { return static_cast<std::uint32_t>(value); }
std::uint32_t high_word(std::uint64_t value) { return static_cast<std::uint32_t>(value >> 32U); }

constexpr double kTwoTo32 = 4294967296.0;

/// r123::u01<double> of the 64-bit number high 2^32 + low, to the bit: both halves and the product are exact.
[[gnu::always_inline]] inline double uniform_from(std::uint32_t low, std::uint32_t high) {
  constexpr double kTwoToMinus64 = 1.0 / (kTwoTo32 * kTwoTo32);
  return (static_cast<double>(high) * kTwoTo32 + static_cast<double>(low)) * kTwoToMinus64 +
         0.5 * kTwoToMinus64;
}

/// Uniform numbers of consecutive counters, whose first word begins at `begin`.
VOLCAL_VECTOR_LOOPS void uniform_pairs(const std::uint32_t (&key_words)[2], std::uint32_t begin,
                                       const std::uint32_t (&counter_words)[3], std::size_t count,
                                       double* __restrict first, double* __restrict second) {
  r123::Philox4x32 philox;
  const r123::Philox4x32::key_type key = {{key_words[0], key_words[1]}};
  const std::uint32_t b = counter_words[0], c = counter_words[1], d = counter_words[2];
  for (std::size_t i = 0; i < count; ++i) {
    const r123::Philox4x32::ctr_type counter = {{begin + static_cast<std::uint32_t>(i), b, c, d}};
    const r123::Philox4x32::ctr_type words = philox(counter, key);
    first[i] = uniform_from(words[0], words[1]);
    second[i] = uniform_from(words[2], words[3]);
  }
}

}  // namespace

CounterRandom::CounterRandom(std::uint64_t seed, std::uint64_t draw, RandomSource source)
    : key_{low_word(seed), high_word(seed)},
      source_(static_cast<std::uint32_t>(source)),
      draw_{low_word(draw), high_word(draw)} {}

/// Calls use(begin, end, first, second) for stretches of [0, size): numbers begin, begin + 2, ... are
/// `first`, the others `second`.
template <class Use>
void CounterRandom::for_each_stretch(std::size_t size, const Use& use) const {
  constexpr std::size_t kPairs = 256;
  double first[kPairs], second[kPairs];
  for (std::size_t begin = 0; begin < size; begin += 2 * kPairs) {
    const std::size_t end = std::min(begin + 2 * kPairs, size);
    uniform_pairs(key_, low_word(begin / 2), {source_, draw_[0], draw_[1]}, (end - begin + 1) / 2, first,
                  second);
    use(begin, end, first, second);
  }
}

namespace {

void interleave(const double* first, const double* second, std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (i % 2 == 0 ? first : second)[i / 2];
}

}  // namespace

void CounterRandom::normals(std::span<double> out) const {
  for_each_stretch(out.size(), [&](std::size_t begin, std::size_t end, double* first, double* second) {
    box_muller((end - begin + 1) / 2, first, second);
    interleave(first, second, out.subspan(begin, end - begin));
  });
}

void CounterRandom::uniforms(std::span<double> out) const {
  for_each_stretch(out.size(), [&](std::size_t begin, std::size_t end, double* first, double* second) {
    interleave(first, second, out.subspan(begin, end - begin));
  });
}

}  // namespace volcal
