// A station on the other side of the work volume sees every error along other beams.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr double kNear = 0.2;  // m: a station so near to another says little new

std::vector<Eigen::Vector3d> points_of(const CandidateContext& context, const Setup& setup,
                                       const Readings& readings) {
  const Machine& machine = context.campaign.machine;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t row = 0; row < readings.size(); ++row) {
    AxisPosition position{};
    for (const Axis& axis : machine.axes) {
      position[index_of(axis.name)] = readings.position[index_of(axis.name)][row];
    }
    points.push_back(context.chain.nominal_point_w(position, machine.tools[setup.tool].offset));
  }
  return points;
}

/// Distance and, for a tracker that stands level along the workpiece axes, both angles.
void look_from(const Eigen::Vector3d& station, const std::vector<Eigen::Vector3d>& points,
               Readings& readings) {
  for (std::size_t row = 0; row < points.size(); ++row) {
    const Eigen::Vector3d beam = points[row] - station;
    const double values[] = {beam.norm(), std::atan2(beam.y(), beam.x()),
                             std::atan2(beam.z(), std::hypot(beam.x(), beam.y()))};
    for (std::size_t k = 0; k < readings.value.size(); ++k) readings.value[k][row] = values[k];
  }
}

bool is_new(const Campaign& campaign, const Eigen::Vector3d& place) {
  return std::ranges::none_of(campaign.setups, [&](const Setup& setup) {
    const auto station = setup.options.vector("station");
    return station && (*station - place).norm() < kNear;
  });
}

}  // namespace

/// Every station mirrored at the middle of what it measured, along one coordinate.
std::vector<ExtraMeasurement> further_stations(const CandidateContext& context) {
  std::vector<ExtraMeasurement> all;
  for (const Setup* setup : one_setup_per_station(context.campaign)) {
    const auto station = setup->options.vector("station");
    if (!station) continue;
    for (int along = 0; along < 3; ++along) {
      ExtraMeasurement extra = taken_again(context, *setup, "");
      Setup& other = extra.setups.front();
      const std::vector<Eigen::Vector3d> points = points_of(context, *setup, other.readings);
      double low = points.front()[along], high = low;
      for (const Eigen::Vector3d& point : points) {
        low = std::min(low, point[along]);
        high = std::max(high, point[along]);
      }
      Eigen::Vector3d place = *station;
      place[along] = low + high - place[along];
      const bool offered = std::ranges::any_of(all, [&](const ExtraMeasurement& each) {
        return (*each.setups.front().options.vector("station") - place).norm() < kNear;
      });
      if (offered || !is_new(context.campaign, place)) continue;
      const std::string where =
          fmt::format("a further station near [{:.0f}, {:.0f}, {:.0f}] mm", place.x() * kPerMilli,
                      place.y() * kPerMilli, place.z() * kPerMilli);
      other.name = where;
      other.options.set("station", place);
      other.options.set("station", where);
      look_from(place, points, other.readings);
      extra.setup.clear();
      extra.words = fmt::format("measure from {} with tool {}", where,
                                context.campaign.machine.tools[setup->tool].name);
      all.push_back(std::move(extra));
    }
  }
  return all;
}

}  // namespace volcal
