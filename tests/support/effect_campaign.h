#pragma once
/// A campaign in which every effect could act: every instrument of interest, two tools, a station that is
/// visited twice, all optional columns.

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "tests/support/machines.h"
#include "volcal/model/description/campaign.h"

namespace volcal::testing_support {

inline constexpr std::size_t kEffectRows = 24;

/// Positions, directions, temperatures, feeds and lines that all differ from one reading to the next.
inline Readings varied_readings(double start_s, double phase) {
  Readings readings;
  for (std::size_t row = 0; row < kEffectRows; ++row) {
    const auto t = static_cast<double>(row);
    for (const AxisName axis : kAllAxes) {
      const double k = static_cast<double>(index_of(axis)) + 1.0;
      readings.position[index_of(axis)].push_back(0.25 + 0.2 * std::sin(1.7 * k * t + phase + k));
      readings.direction[index_of(axis)].push_back(std::sin(2.3 * t + k + phase) > 0.0 ? 1 : -1);
    }
    readings.time.push_back(start_s + 20.0 * t);
    readings.line.push_back(static_cast<std::int32_t>(row / 6));
    readings.run.push_back(static_cast<std::int32_t>(row / 12));
    readings.feed.push_back(0.01 + 0.001 * static_cast<double>(row % 5));
    readings.temperature["air"].push_back(20.1 + 0.3 * std::sin(0.3 * t + phase));
    readings.temperature["spindle"].push_back(20.0 + 0.2 * t);
    readings.source_line.push_back(static_cast<std::int64_t>(row) + 2);
  }
  return readings;
}

inline Setup effect_setup(const std::string& name, const std::string& instrument, std::size_t channels,
                          double start_s) {
  Setup setup;
  setup.name = name;
  setup.instrument = instrument;
  setup.noise.set("constant", 0.3e-6);
  setup.has_noise = true;
  setup.readings = varied_readings(start_s, start_s / 1000.0);
  setup.readings.value.assign(channels, std::vector<double>(kEffectRows, 0.2));
  return setup;
}

inline Setup tracer_setup(const std::string& name, const std::string& station, std::size_t tool,
                          double start_s) {
  Setup setup = effect_setup(name, "laser-tracer", 1, start_s);
  setup.tool = tool;
  setup.options.set("station", station);
  setup.options.set("station", Eigen::Vector3d(-0.4, station == "P1" ? -0.3 : 0.9, -0.2));
  return setup;
}

inline Campaign effect_campaign(const std::string& structure = "w X' b Y Z t") {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine = machine_of(structure);
  campaign.machine.tools = {{"short", {0.0, 0.0, -0.1}, 0.0}, {"side", {0.15, 0.05, -0.2}, 0.0}};
  campaign.setups = {tracer_setup("S1", "P1", 0, 0.0), tracer_setup("S2", "P2", 1, 1000.0),
                     tracer_setup("S3", "P1", 0, 7000.0)};
  Setup tracker = effect_setup("K1", "laser-tracker", 3, 2000.0);
  tracker.options.set("station", Eigen::Vector3d(1.6, 0.4, 0.3));
  tracker.noise.set("angle", 1e-6);
  Setup bar = effect_setup("B1", "ball-bar", 1, 3000.0);
  bar.options.set("centre", Eigen::Vector3d(0.25, 0.25, 0.1));
  bar.options.set("length_sigma", 0.0);
  campaign.setups.push_back(tracker);
  campaign.setups.push_back(bar);
  campaign.setups.push_back(effect_setup("D1", "displacement", 1, 4000.0));
  campaign.setups.push_back(effect_setup("A1", "angle", 1, 5000.0));
  campaign.setups.back().options.set("axis", Eigen::Vector3d(0.0, 0.0, 1.0));
  return campaign;
}

/// Single contacts with a sphere, normals in all directions.
inline Setup contacts_setup(const std::string& name, double start_s) {
  Setup setup = effect_setup(name, "probed-sphere", 1, start_s);
  setup.readings.column_set = 1;
  setup.readings.given.assign(6, std::vector<double>(kEffectRows, 0.1));
  for (std::size_t row = 0; row < kEffectRows; ++row) {
    const auto t = static_cast<double>(row);
    const Eigen::Vector3d normal =
        Eigen::Vector3d(std::cos(1.1 * t), std::sin(1.3 * t), std::sin(0.7 * t)).normalized();
    for (std::size_t k = 0; k < 3; ++k) setup.readings.given[3 + k][row] = normal[static_cast<int>(k)];
  }
  return setup;
}

/// The same on a table that turns on a cradle, and a sphere that is probed.
inline Campaign five_axis_effect_campaign() {
  Campaign campaign = effect_campaign("w C' A' X' b Y Z t");
  campaign.setups.push_back(contacts_setup("T1", 6000.0));
  return campaign;
}

}  // namespace volcal::testing_support
