#include "volcal/identify/errors/correction_positions.h"

#include <cmath>
#include <string>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kSamePosition = 1e-9;  // m
constexpr int kMostPositions = 100000;

}  // namespace

std::vector<double> correction_positions(const Axis& axis, double step, bool equidistant) {
  if (!(step > 0.0) || axis.travel() / step > kMostPositions)
    throw InputError({},
                     "a step of " + std::to_string(step * kPerMilli) + " mm over the travel of " +
                         letter_of(axis.name) + " is out of range",
                     "give a --step that divides the travel into at most " + std::to_string(kMostPositions));
  const double below = (axis.home - axis.travel_min) / step;
  const double above = (axis.travel_max - axis.home) / step;
  const auto steps = [&](double count) {
    return static_cast<int>(equidistant ? std::ceil(count - kSamePosition / step)
                                        : std::floor(count + kSamePosition / step));
  };
  std::vector<double> positions;
  for (int i = -steps(below); i <= steps(above); ++i) positions.push_back(axis.home + i * step);
  if (equidistant) return positions;
  if (positions.empty() || positions.front() > axis.travel_min + kSamePosition)
    positions.insert(positions.begin(), axis.travel_min);
  if (positions.back() < axis.travel_max - kSamePosition) positions.push_back(axis.travel_max);
  return positions;
}

}  // namespace volcal
