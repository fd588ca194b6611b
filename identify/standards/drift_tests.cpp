#include "volcal/identify/standards/drift_tests.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "volcal/identify/standards/rotary_tests.h"
#include "volcal/identify/standards/test_paths.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr double kSameTime = 1.0;      // s
constexpr double kPointsApart = 5e-3;  // m
constexpr double kAcross = 1e-6;       // share of a direction that counts as none

/// Nothing moves, and time goes on.
bool is_at_rest(const Setup& setup) {
  const std::vector<double>& time = setup.readings.time;
  if (time.size() < 2 || !moving_axes(setup).empty()) return false;
  const auto [first, last] = std::ranges::minmax(time);
  return last > first;
}

std::vector<TemperatureRange> temperatures_of(const Setup& setup) {
  std::vector<TemperatureRange> ranges;
  for (const auto& [channel, values] : setup.readings.temperature) {
    if (values.empty()) continue;
    const auto [low, high] = std::ranges::minmax(values);
    ranges.push_back({channel, low, high});
  }
  return ranges;
}

std::vector<DriftReading> plot_of(const Setup& setup, const SetupValues& values,
                                  const std::vector<double>& value) {
  std::vector<DriftReading> readings;
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (values.has(row)) readings.push_back({setup.readings.time[row], value[row]});
  }
  return readings;
}

DriftTest channel_test(const Setup& setup, const SetupValues& values, std::size_t channel,
                       std::string quantity, bool angle) {
  SideBySide<std::vector<DriftReading>> plots = {plot_of(setup, values, values.reading[channel]),
                                                 plot_of(setup, values, values.predicted[channel])};
  const SideBySide<DriftFigures> figures = {drift_figures(plots.readings), drift_figures(plots.model)};
  return {setup.name,
          std::move(quantity),
          angle,
          figures,
          std::move(plots),
          temperatures_of(setup),
          notes_on_removed(values)};
}

/// The direction that a vector mostly has.
std::string letter_along(const Vector3d& vector, const char* letters) {
  Eigen::Index largest = 0;
  vector.cwiseAbs().maxCoeff(&largest);
  return {letters[largest]};
}

void add_channels(const Setup& setup, const SetupValues& values, std::vector<DriftTest>& tests) {
  if (reads_displacements(setup)) {
    for (std::size_t k = 0; k < 3; ++k) tests.push_back(channel_test(setup, values, k, {"XYZ"[k]}, false));
    return;
  }
  const InstrumentTraits& traits = traits_of(setup);
  if (traits.line_reading == LineReading::Rotation) {
    const Vector3d axis = setup.options.vector("axis").value_or(Vector3d::UnitX());
    tests.push_back(channel_test(setup, values, 0, letter_along(axis, "ABC"), true));
  } else if (traits.line_reading == LineReading::Along || traits.line_reading == LineReading::Across) {
    const auto direction = setup.options.vector("direction");
    tests.push_back(
        channel_test(setup, values, 0, direction ? letter_along(*direction, "XYZ") : "beam", false));
  }
}

/// A setup of displacements with the point where they were read, workpiece coordinates.
struct RestingSphere {
  const Setup* setup = nullptr;
  const SetupValues* values = nullptr;
  Vector3d point_w = Vector3d::Zero();
};

bool read_together(const Setup& one, const Setup& other) {
  return std::ranges::equal(one.readings.time, other.readings.time,
                            [](double a, double b) { return std::abs(a - b) <= kSameTime; });
}

/// Tilts by the difference of two points: (l x (d2 - d1)) / l^2; of directions along l nothing is known.
void add_tilts_between(const Campaign& campaign, const RestingSphere& one, const RestingSphere& other,
                       std::vector<DriftTest>& tests) {
  const Vector3d apart = other.point_w - one.point_w;
  if (apart.norm() < kPointsApart || !read_together(*one.setup, *other.setup)) return;
  const auto tilts = [&](std::vector<std::vector<double>> SetupValues::*of, int about) {
    const auto first = displacements_w(campaign, *one.setup, one.values->*of);
    const auto second = displacements_w(campaign, *other.setup, other.values->*of);
    std::vector<DriftReading> readings;
    for (std::size_t row = 0; row < first.size(); ++row) {
      if (one.values->has(row) && other.values->has(row))
        readings.push_back({one.setup->readings.time[row],
                            (apart.cross(second[row] - first[row]) / apart.squaredNorm())[about]});
    }
    return readings;
  };
  for (int about = 0; about < 3; ++about) {
    const Vector3d across = Vector3d::Unit(about).cross(apart.normalized());
    if (across.squaredNorm() < 1.0 - kAcross) continue;  // the tilt about it is not known alone
    std::vector<Finding> notes = notes_on_removed(*one.values);
    const std::vector<Finding> more = notes_on_removed(*other.values);
    notes.insert(notes.end(), more.begin(), more.end());
    SideBySide<std::vector<DriftReading>> plots = {tilts(&SetupValues::reading, about),
                                                   tilts(&SetupValues::predicted, about)};
    const SideBySide<DriftFigures> figures = {drift_figures(plots.readings), drift_figures(plots.model)};
    tests.push_back({one.setup->name + ", " + other.setup->name,
                     {"ABC"[about]},
                     true,
                     figures,
                     std::move(plots),
                     temperatures_of(*one.setup),
                     std::move(notes)});
  }
}

}  // namespace

std::vector<DriftTest> drift_tests(const Campaign& campaign, std::span<const SetupValues> values) {
  std::vector<DriftTest> tests;
  std::vector<RestingSphere> spheres;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    if (!is_at_rest(setup)) continue;
    add_channels(setup, values[i], tests);
    if (reads_displacements(setup))
      spheres.push_back({&setup, &values[i], nominal_points_w(campaign, setup).front()});
  }
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t k = i + 1; k < spheres.size(); ++k)
      add_tilts_between(campaign, spheres[i], spheres[k], tests);
  }
  return tests;
}

}  // namespace volcal
