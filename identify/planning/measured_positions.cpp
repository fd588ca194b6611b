#include "volcal/identify/planning/measured_positions.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kSameLinear = 2e-3;  // m
constexpr double kSameRotary = kRadianPerDegree;

bool are_alike(const AxisPosition& a, const AxisPosition& b, bool rotary_alone) {
  return std::ranges::all_of(kAllAxes, [&](AxisName axis) {
    if (rotary_alone && !is_rotary(axis)) return true;
    const double apart = std::abs(a[index_of(axis)] - b[index_of(axis)]);
    return apart < (is_rotary(axis) ? kSameRotary : kSameLinear);
  });
}

bool turns_rotary_axes(const Setup& setup) {
  return std::ranges::any_of(kAllAxes, [&](AxisName axis) {
    const std::vector<double>& positions = setup.readings.position[index_of(axis)];
    return is_rotary(axis) &&
           std::ranges::adjacent_find(positions, std::ranges::not_equal_to{}) != positions.end();
  });
}

}  // namespace

MeasuredPositions::MeasuredPositions(const PlanSettings& settings)
    : rotary_alone_(plan_instrument_of(settings).turns_rotary_axes()) {
  if (settings.apart_from == nullptr) return;
  for (const Setup& setup : settings.apart_from->setups) {
    const PlanInstrument* instrument = find_plan_instrument(setup.instrument);
    if (rotary_alone_ && !turns_rotary_axes(setup)) continue;
    if (instrument != nullptr) {
      if (const auto place = instrument->place_of(setup, settings.apart_from->machine))
        places_w_.push_back(place->place_w);
    }
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      AxisPosition& position = positions_.emplace_back();
      position.fill(0.0);
      for (const Axis& axis : settings.apart_from->machine.axes)
        position[index_of(axis.name)] = setup.readings.position[index_of(axis.name)][row];
    }
  }
  if (rotary_alone_) key_ = index_of(rotary_stretches(settings.machine).front().axis);
  std::ranges::sort(positions_, {}, [&](const AxisPosition& each) { return each[key_]; });
}

bool MeasuredPositions::has(const AxisPosition& position) const {
  const double within = std::max(kSameLinear, kSameRotary);
  const auto by_key = [&](const AxisPosition& each) { return each[key_]; };
  const auto first = std::ranges::lower_bound(positions_, position[key_] - within, {}, by_key);
  const auto last = std::ranges::upper_bound(positions_, position[key_] + within, {}, by_key);
  return std::any_of(first, last,
                     [&](const AxisPosition& each) { return are_alike(each, position, rotary_alone_); });
}

bool MeasuredPositions::has_place(const Eigen::Vector3d& place_w) const {
  return is_one_of(place_w, places_w_);
}

bool is_one_of(const Eigen::Vector3d& place_w, const std::vector<Eigen::Vector3d>& places_w) {
  return std::ranges::any_of(
      places_w, [&](const Eigen::Vector3d& each) { return (each - place_w).norm() < kPlacesApart; });
}

bool are_apart(const std::vector<Eigen::Vector3d>& places_w) {
  for (std::size_t i = 0; i < places_w.size(); ++i) {
    if (is_one_of(places_w[i], {places_w.begin() + static_cast<std::ptrdiff_t>(i) + 1, places_w.end()}))
      return false;
  }
  return true;
}

}  // namespace volcal
