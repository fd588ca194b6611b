#pragma once
/// Random numbers by counter: number i of a source of a draw is a function of (seed, draw, source, i) alone,
/// so that draws can be made in any order, on any thread, and again. Philox4x32-10 of Random123 (Salmon,
/// Moraes, Dror and Shaw 2011, Parallel random numbers: as easy as 1, 2, 3, SC'11).

#include <cstdint>
#include <span>

namespace volcal {

/// What of a draw the numbers are for; each has a stream of its own.
enum class RandomSource : std::uint32_t {
  Parameters = 0,
  Readings = 1,
  Drift = 2,
  Lines = 3,
  Statements = 4,
  Roughness = 5,
  Disturbances = 6
};

class CounterRandom {
 public:
  /// At most 2^33 numbers a source.
  CounterRandom(std::uint64_t seed, std::uint64_t draw, RandomSource source);

  /// Standard normal, by Box and Muller from 64-bit uniform numbers (to 9.4 standard deviations).
  void normals(std::span<double> out) const;
  /// Uniform on (0, 1].
  void uniforms(std::span<double> out) const;

 private:
  template <class Use>
  void for_each_stretch(std::size_t size, const Use& use) const;

  std::uint32_t key_[2];
  std::uint32_t source_;
  std::uint32_t draw_[2];
};

}  // namespace volcal
