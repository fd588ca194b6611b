#pragma once
/// Shares of a length at which what changes along it is sampled. They are irrational: a wave whose period
/// divides the length has another phase at each of them.

#include <cstddef>
#include <vector>

namespace volcal {

/// The `number`-th, from 0; the first n of them divide the length into parts shorter than 2 / n of it.
double sample_share(std::size_t number);

struct WeightedShare {
  double share = 0.0;
  double weight = 0.0;
};

/// To integrate by: three Gauss points in each of `parts` parts, which are uneven, none longer than
/// 1.75 of the mean. Weights add up to 1.
void weighted_shares(std::size_t parts, std::vector<WeightedShare>& shares);

/// Parts for a length, m, about a millimetre each.
std::size_t parts_of_length(double length);

}  // namespace volcal
