#include "volcal/identify/planning/plan_layout.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/swept_volume.h"
#include "volcal/identify/planning/uniform_random.h"

namespace volcal {
namespace {

constexpr double kResting = 1e-12;
constexpr double kPause = 600.0;  // s, between setups where nothing is said

std::array<std::int8_t, kAxisCount> approach(const AxisPosition& from, const AxisPosition& to,
                                             std::array<std::int8_t, kAxisCount> before) {
  for (std::size_t k = 0; k < kAxisCount; ++k) {
    const double move = to[k] - from[k];
    if (std::abs(move) > kResting) before[k] = static_cast<std::int8_t>(move > 0.0 ? 1 : -1);
  }
  return before;
}

double move_time(const AxisPosition& from, const AxisPosition& to, const TimeCosts& costs) {
  double longest = 0.0;
  for (const AxisName axis : kAllAxes) {
    const double speed = is_rotary(axis) ? costs.turn : costs.feed;
    longest = std::max(longest, std::abs(to[index_of(axis)] - from[index_of(axis)]) / speed);
  }
  return longest;
}

double run_duration(const PlanRun& run, const PlanSettings& settings) {
  double time = 0.0;
  const AxisPosition* last = nullptr;
  const std::vector<PlanReading> readings = readings_of(run);
  for (const PlanReading& reading : readings) {
    time += settings.costs.reading;
    if (last != nullptr) time += move_time(*last, reading.position, settings.costs);
    last = &reading.position;
  }
  return time;
}

/// There and back without a stop, already on the way at the first; axes that rest count as approached in the
/// + direction.
std::vector<PlanReading> read_on_the_way(std::vector<PlanPosition> ordered, bool both) {
  std::vector<PlanReading> path;
  for (int pass = 0; pass < (both ? 2 : 1); ++pass) {
    std::array<std::int8_t, kAxisCount> direction{};
    direction.fill(1);
    for (std::size_t i = 0; i < ordered.size(); ++i) {
      const std::size_t from = i > 0 ? i - 1 : 0, to = std::min(from + 1, ordered.size() - 1);
      direction = approach(ordered[from].position, ordered[to].position, direction);
      path.push_back({ordered[i].position, direction, pass, pass});
    }
    std::ranges::reverse(ordered);
  }
  return path;
}

class SetupMaker {
 public:
  SetupMaker(const PlanLayout& layout, const PlanSettings& settings)
      : layout_(layout),
        settings_(settings),
        instrument_(plan_instrument_of(settings)),
        chain_(settings.machine) {}

  Setup make(const PlanRun& run, bool both, double start) const {
    Setup setup;
    setup.name = run_name(layout_, run, settings_.machine);
    setup.instrument = instrument_.instrument();
    setup.tool = run.tool;
    instrument_.describe(settings_, {layout_.station_names[run.station], layout_.stations_w[run.station]},
                         setup);
    fill(run, both, start, setup);
    return setup;
  }

 private:
  void fill(const PlanRun& run, bool both, double start, Setup& setup) const {
    Readings& readings = setup.readings;
    double time = start;
    for (const PlanReading& reading : readings_of(run, both)) {
      for (const Axis& axis : settings_.machine.axes) {
        const std::size_t k = index_of(axis.name);
        readings.position[k].push_back(reading.position[k]);
        readings.direction[k].push_back(reading.direction[k]);
      }
      const std::vector<double> values = instrument_.nominal_reading(
          layout_.stations_w[run.station],
          chain_.nominal_point_w(reading.position, settings_.machine.tools[run.tool].offset));
      readings.value.resize(values.size());
      for (std::size_t channel = 0; channel < values.size(); ++channel)
        readings.value[channel].push_back(values[channel]);
      readings.line.push_back(reading.line);
      readings.run.push_back(reading.run);
      readings.time.push_back(time);
      readings.source_line.push_back(static_cast<std::int64_t>(readings.source_line.size()) + 2);
      time += settings_.costs.reading;
    }
  }

  const PlanLayout& layout_;
  const PlanSettings& settings_;
  const PlanInstrument& instrument_;
  KinematicChain chain_;
};

double end_of_existing(const Campaign& campaign) {
  double end = 0.0;
  for (const Setup& setup : campaign.setups) {
    for (const double time : setup.readings.time) end = std::max(end, time);
  }
  return end + kPause;
}

}  // namespace

std::vector<PlanPosition> in_path_order(std::vector<PlanPosition> positions) {
  std::ranges::sort(positions, {}, [](const PlanPosition& each) {
    const auto [i, j, k] = each.cell;
    const int row = k % 2 == 0 ? j : -j;
    const int column = (j + k) % 2 == 0 ? i : -i;
    return std::tuple(k, row, column, each.position);
  });
  return positions;
}

std::size_t PlanLayout::positions() const {
  std::size_t count = 0;
  for (const PlanRun& run : runs) count += run.positions.size();
  return count;
}

std::vector<PlanReading> readings_of(const PlanRun& run, bool both) {
  const std::vector<PlanPosition> ordered = in_path_order(run.positions);
  if (!run.part.empty()) return read_on_the_way(ordered, both);
  std::vector<PlanReading> path;
  std::array<std::int8_t, kAxisCount> direction{};
  direction.fill(1);
  std::int32_t line = -1;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const bool new_row = i == 0 || ordered[i].cell[1] != ordered[i - 1].cell[1] ||
                         ordered[i].cell[2] != ordered[i - 1].cell[2];
    if (new_row) ++line;
    if (i > 0) direction = approach(ordered[i - 1].position, ordered[i].position, direction);
    path.push_back({ordered[i].position, direction, line, 0});
  }
  if (!both) return path;
  for (std::size_t i = ordered.size(); i-- > 0;) {
    PlanReading reading = path[i];
    for (std::int8_t& each : reading.direction) each = static_cast<std::int8_t>(-each);
    reading.line = 2 * line + 1 - reading.line;
    reading.run = 1;
    path.push_back(reading);
  }
  return path;
}

double duration(const PlanLayout& layout, const PlanSettings& settings) {
  double time = settings.costs.station * static_cast<double>(layout.stations_w.size());
  for (const PlanRun& run : layout.runs) time += settings.costs.run + run_duration(run, settings);
  return time;
}

std::string run_name(const PlanLayout& layout, const PlanRun& run, const Machine& machine) {
  return layout.station_names[run.station] + "_" + machine.tools[run.tool].name +
         (run.part.empty() ? "" : "_" + run.part);
}

Campaign campaign_of(const PlanLayout& layout, const PlanSettings& settings, bool both) {
  Campaign campaign;
  campaign.machine = settings.machine;
  double start = 0.0;
  if (settings.existing != nullptr) {
    campaign.setups = settings.existing->setups;
    start = end_of_existing(*settings.existing);
  }
  const SetupMaker maker(layout, settings);
  for (const PlanRun& run : layout.runs) {
    if (run.positions.empty()) continue;
    campaign.setups.push_back(maker.make(run, both, start));
    start += settings.costs.run + run_duration(run, settings);
  }
  return campaign;
}

std::vector<PlanPosition> grid_over_travel(const Machine& machine, const Eigen::Vector3i& per_axis,
                                           double jitter, std::uint64_t seed, std::uint64_t stream) {
  std::seed_seq mixed{seed, stream};
  std::mt19937_64 random(mixed);
  std::vector<PlanPosition> positions;
  for (int k = 0; k < per_axis.z(); ++k) {
    for (int j = 0; j < per_axis.y(); ++j) {
      for (int i = 0; i < per_axis.x(); ++i) {
        PlanPosition each;
        each.cell = {i, j, k};
        for (const Axis& axis : machine.axes) {
          double& q = each.position[index_of(axis.name)];
          q = axis.home;
          if (is_rotary(axis.name)) continue;
          const int d = direction_of(axis.name);
          const double step = axis.travel() / (per_axis[d] - 1);
          const int place = each.cell[static_cast<std::size_t>(d)];
          q = axis.travel_min + step * (place + jitter * symmetric_uniform(random));
          q = std::clamp(programmed_position(q), axis.travel_min, axis.travel_max);
        }
        positions.push_back(each);
      }
    }
  }
  return positions;
}

Eigen::Vector3i even_grid(const Machine& machine, std::size_t positions) {
  Eigen::Vector3i counts = Eigen::Vector3i::Ones();
  double product = 1.0, moving = 0.0;
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) continue;
    product *= std::cbrt(axis.travel());
    moving += 1.0;
  }
  const double factor = std::pow(static_cast<double>(positions) / product, 1.0 / std::max(1.0, moving));
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) continue;
    const double even_count = factor * std::cbrt(axis.travel());
    counts[direction_of(axis.name)] = std::max(3, static_cast<int>(std::lround(even_count)));
  }
  return counts;
}

}  // namespace volcal
