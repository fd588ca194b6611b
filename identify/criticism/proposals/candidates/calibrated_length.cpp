// A length that is known without the laser: circles with a ball-bar of calibrated length.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr double kUsualRadius = 0.15;  // m
constexpr double kTravelShare = 0.45;  // of the shortest travel, at most
constexpr double kConstant = 0.3e-6;   // m, noise of a ball-bar
constexpr double kSecondsPerReading = 0.5;

struct Plane {
  AxisName first;
  AxisName second;
  const char* name;
};
constexpr Plane kPlanes[] = {
    {AxisName::X, AxisName::Y, "XY"}, {AxisName::Y, AxisName::Z, "YZ"}, {AxisName::Z, AxisName::X, "ZX"}};

AxisPosition middle(const Machine& machine) {
  AxisPosition position{};
  for (const Axis& axis : machine.axes) {
    position[index_of(axis.name)] =
        is_rotary(axis.name) ? axis.home : 0.5 * (axis.travel_min + axis.travel_max);
  }
  return position;
}

/// Noise of the campaign's ball-bar, or of a usual one with the machine's repeatability.
void set_noise(const Campaign& campaign, Setup& setup) {
  setup.has_noise = true;
  setup.noise.set("constant", kConstant);
  for (const Setup& each : campaign.setups) {
    setup.repeatability = std::max(setup.repeatability, each.repeatability);
  }
  const auto bar = std::ranges::find(campaign.setups, instrument_with_bar(), &Setup::instrument);
  if (bar == campaign.setups.end() || !bar->has_noise) return;
  setup.noise = bar->noise;
  setup.repeatability = bar->repeatability;
}

Setup circle(const CandidateContext& context, const Plane& plane, double radius, double start_s) {
  const Machine& machine = context.campaign.machine;
  const AxisPosition centre = middle(machine);
  Setup setup;
  setup.name = std::string("calibrated ball-bar ") + plane.name;
  setup.instrument = instrument_with_bar();
  setup.options.set("centre", context.chain.nominal_point_w(centre, machine.tools.front().offset));
  setup.options.set("length_sigma", 0.0);
  set_noise(context.campaign, setup);
  Readings& readings = setup.readings;
  for (std::size_t i = 0; i < context.readings; ++i) {
    const double turns = (static_cast<double>(i) + 0.5) / static_cast<double>(context.readings);
    const double angle = 2.0 * std::numbers::pi * turns;
    AxisPosition position = centre;
    position[index_of(plane.first)] += radius * std::cos(angle);
    position[index_of(plane.second)] += radius * std::sin(angle);
    for (const Axis& axis : machine.axes) {
      const std::size_t k = index_of(axis.name);
      readings.position[k].push_back(position[k]);
      std::int8_t direction = 0;
      if (axis.name == plane.first) direction = std::sin(angle) > 0.0 ? -1 : 1;
      if (axis.name == plane.second) direction = std::cos(angle) > 0.0 ? 1 : -1;
      readings.direction[k].push_back(direction);
    }
    readings.line.push_back(0);
  }
  readings.source_line.assign(context.readings, 0);
  readings.value.assign(1, std::vector<double>(context.readings, radius));
  complete_readings(context, start_s, kSecondsPerReading, Temperatures::Last, 1, readings);
  return setup;
}

}  // namespace

std::vector<ExtraMeasurement> calibrated_lengths(const CandidateContext& context) {
  const Machine& machine = context.campaign.machine;
  double shortest = std::numeric_limits<double>::infinity();
  for (const AxisName axis : machine.linear_axes())
    shortest = std::min(shortest, machine.axis(axis).travel());
  const double radius = std::min(kUsualRadius, kTravelShare * shortest);
  std::vector<ExtraMeasurement> all;
  for (const Plane& plane : kPlanes) {
    if (!machine.has_axis(plane.first) || !machine.has_axis(plane.second)) continue;
    ExtraMeasurement extra;
    extra.words = fmt::format("measure a circle of {:.0f} mm in {} with a ball-bar of calibrated length",
                              radius * kPerMilli, plane.name);
    extra.setups.push_back(circle(context, plane, radius, end_of(context.campaign) + kPause));
    all.push_back(std::move(extra));
  }
  return all;
}

}  // namespace volcal
