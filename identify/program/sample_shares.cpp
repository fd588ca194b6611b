#include "volcal/identify/program/sample_shares.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace volcal {

double sample_share(std::size_t number) {
  constexpr double kGoldenSection = 0.6180339887498949;
  const double turns = kGoldenSection * static_cast<double>(number + 1);
  return turns - std::floor(turns);
}

void weighted_shares(std::size_t parts, std::vector<WeightedShare>& shares) {
  constexpr std::array<WeightedShare, 3> kGauss = {WeightedShare{0.1127016653792583, 5.0 / 18.0},
                                                   WeightedShare{0.5, 8.0 / 18.0},
                                                   WeightedShare{0.8872983346207417, 5.0 / 18.0}};
  // Of a part: with more, waves as long as two parts are less certain; with less, those within one.
  constexpr double kUneven = 0.75;
  shares.clear();
  double begin = 0.0;
  for (std::size_t i = 1; i <= parts; ++i) {
    // of squares: neighbours differ freely
    const double shift = i < parts ? kUneven * (sample_share(i * i) - 0.5) : 0.0;
    const double end = (static_cast<double>(i) + shift) / static_cast<double>(parts);
    for (const WeightedShare& point : kGauss)
      shares.push_back({begin + point.share * (end - begin), point.weight * (end - begin)});
    begin = end;
  }
}

std::size_t parts_of_length(double length) {
  constexpr double kPart = 1e-3;      // m
  constexpr double kMostParts = 1e5;  // of a line
  return static_cast<std::size_t>(std::clamp(std::ceil(length / kPart), 1.0, kMostParts));
}

}  // namespace volcal
