#pragma once
/// An even choice of few out of many, the same on every run.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace volcal {

/// Scrambles an index (Steele, Lea and Flood 2014, SplitMix64): a choice by it does not beat with the regular
/// positions of a measuring line, as every n-th reading would.
std::uint64_t scrambled(std::uint64_t index);

/// `limit` of 0 ... count - 1, ascending; all when there are no more.
std::vector<std::size_t> even_sample(std::size_t count, std::size_t limit);

}  // namespace volcal
