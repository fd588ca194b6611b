#include "volcal/sim/machine/random.h"

#include <cmath>
#include <numbers>

namespace volcal::sim {
namespace {

/// FNV-1a, 64 bit: std::hash differs between libraries.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

/// SplitMix64 finaliser (Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view label)
    : engine_(mixed(mixed(seed) ^ hash_of(label))) {}

double RandomStream::uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

double RandomStream::uniform(double low, double high) { return low + (high - low) * uniform(); }

double RandomStream::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

double RandomStream::sign() { return uniform() < 0.5 ? -1.0 : 1.0; }

Eigen::Vector3d RandomStream::normal_vector() {
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

}  // namespace volcal::sim
