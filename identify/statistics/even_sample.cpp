#include "volcal/identify/statistics/even_sample.h"

#include <algorithm>
#include <numeric>

namespace volcal {

std::uint64_t scrambled(std::uint64_t index) {
  std::uint64_t z = index + 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::vector<std::size_t> even_sample(std::size_t count, std::size_t limit) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (count <= limit) return order;
  std::ranges::nth_element(order, order.begin() + static_cast<std::ptrdiff_t>(limit), {}, scrambled);
  order.resize(limit);
  std::ranges::sort(order);
  return order;
}

}  // namespace volcal
