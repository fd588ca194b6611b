#include "volcal/model/description/rotary_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace volcal {
namespace {

constexpr double kWholeTurn = 2.0 * std::numbers::pi;
constexpr double kSamePlace = 1e-4;  // rad
constexpr std::size_t kFewestRegular = 3;

std::vector<double> angles_in_turn(const Campaign& campaign, AxisName axis) {
  std::vector<double> angles = used_positions(campaign, axis);
  for (double& angle : angles) angle -= kWholeTurn * std::floor(angle / kWholeTurn);
  std::ranges::sort(angles);
  return angles;
}

}  // namespace

std::vector<double> used_positions(const Campaign& campaign, AxisName axis) {
  std::vector<double> used;
  for (const Setup& setup : campaign.setups) {
    const std::vector<bool> left_out = setup.rows_left_out();
    const std::vector<double>& position = setup.readings.position[index_of(axis)];
    for (std::size_t row = 0; row < position.size(); ++row) {
      if (!left_out[row]) used.push_back(position[row]);
    }
  }
  std::ranges::sort(used);
  return used;
}

std::vector<double> places_in_turn(const Campaign& campaign, AxisName axis) {
  std::vector<double> places;
  double last = -kWholeTurn;
  for (const double angle : angles_in_turn(campaign, axis)) {
    if (angle - last > kSamePlace) places.push_back(angle);
    last = angle;
  }
  if (places.size() > 1 && places.front() + kWholeTurn - last <= kSamePlace) places.pop_back();
  return places;
}

int most_periods(const std::vector<double>& places) {
  return std::max(0, (static_cast<int>(places.size()) - 1) / 2);
}

int regular_parts(const std::vector<double>& places) {
  if (places.size() < kFewestRegular) return 0;
  std::vector<double> steps = {places.front() + kWholeTurn - places.back()};
  for (std::size_t i = 1; i < places.size(); ++i) steps.push_back(places[i] - places[i - 1]);
  const double parts = std::round(kWholeTurn / *std::ranges::min_element(steps));
  const auto in_parts = [&](double angle) { return std::round(angle * parts / kWholeTurn); };
  const auto is_at_an_end = [&](double place) {
    const double angle = place - places.front();
    return std::abs(angle - in_parts(angle) * kWholeTurn / parts) <= kSamePlace;
  };
  const bool is_one_arc = std::ranges::count_if(steps, [&](double step) { return in_parts(step) > 1.0; }) < 2;
  const bool few_are_missing = parts <= 2.0 * static_cast<double>(places.size());
  const bool is_regular = std::ranges::all_of(places, is_at_an_end) && (is_one_arc || few_are_missing);
  return is_regular ? static_cast<int>(parts) : 0;
}

}  // namespace volcal
