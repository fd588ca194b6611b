#include <algorithm>
#include <cmath>

#include "volcal/identify/planning/plan_search.h"

namespace volcal {
namespace {

constexpr double kTextbookJitter = 0.5;  // of a grid step: no piece of the travel without readings
constexpr std::uint64_t kTextbookStream = 1000000;

/// Exactly `count` of the positions that a station sees, evenly.
std::vector<PlanPosition> even_choice(const std::vector<PlanPosition>& positions, std::size_t count) {
  if (positions.size() <= count) return positions;
  std::vector<PlanPosition> chosen;
  for (std::size_t k = 0; k < count; ++k)
    chosen.push_back(positions[(2 * k + 1) * positions.size() / (2 * count)]);
  return chosen;
}

std::vector<PlanPosition> textbook_grid(const PlanSettings& settings, const LineOfSight& sight,
                                        const PlanLayout& layout, const PlanRun& run, std::size_t count,
                                        std::uint64_t stream) {
  for (std::size_t asked = count; asked <= 4 * count + 64; asked += 1 + asked / 16) {
    std::vector<PlanPosition> seen =
        grid_over_travel(settings.machine, even_grid(settings.machine, asked), kTextbookJitter, settings.seed,
                         kTextbookStream + stream);
    std::erase_if(seen, [&](const PlanPosition& each) {
      return !sight.sees(layout.stations_w[run.station], each.position, run.tool);
    });
    if (seen.size() >= count) return even_choice(in_path_order(std::move(seen)), count);
  }
  return {};
}

/// Around the floor of the region, at its corners where there are four; the fourth at its top, since four
/// stations in one plane know next to nothing (Takatsuji et al. 1998, Meas. Sci. Technol. 9, 1357).
std::vector<Eigen::Vector3d> around_volume(const LineOfSight& sight, int count) {
  int up = 0;
  sight.spindle_w().cwiseAbs().maxCoeff(&up);
  const int first = (up + 1) % 3, second = (up + 2) % 3;
  const Eigen::AlignedBox3d& region = sight.stations_w();
  const Eigen::AlignedBox3d& swept = sight.swept_w();
  const double floor = std::clamp(sight.spindle_w()[up] > 0.0 ? swept.min()[up] : swept.max()[up],
                                  region.min()[up], region.max()[up]);
  constexpr int kAround[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
  std::vector<Eigen::Vector3d> stations;
  for (int i = 0; i < count; ++i) {
    const double turn = 4.0 * i / count;
    const int corner = static_cast<int>(turn);
    const double share = turn - corner;
    Eigen::Vector3d station;
    const bool raised = i % 4 == 3;
    station[up] = raised ? sight.spindle_w()[up] > 0.0 ? region.max()[up] : region.min()[up] : floor;
    for (int k = 0; k < 2; ++k) {
      const int axis = k == 0 ? first : second;
      const double place = kAround[corner][k] + share * (kAround[corner + 1][k] - kAround[corner][k]);
      station[axis] = region.min()[axis] + place * region.sizes()[axis];
    }
    stations.push_back(station);
  }
  return stations;
}

/// Evenly over the runs.
void spread_over_runs(const PlanSettings& settings, const LineOfSight& sight, std::size_t positions,
                      PlanLayout& layout) {
  for (std::size_t r = 0; r < layout.runs.size(); ++r) {
    const std::size_t own = positions / layout.runs.size() + (r < positions % layout.runs.size() ? 1 : 0);
    layout.runs[r].positions = textbook_grid(settings, sight, layout, layout.runs[r], own, r);
  }
}

}  // namespace

PlanLayout textbook_layout(const PlanSettings& settings, const LineOfSight& sight) {
  PlanLayout layout;
  layout.stations_w = around_volume(sight, settings.budget.stations);
  for (std::size_t i = 0; i < layout.stations_w.size(); ++i) {
    layout.station_names.push_back("P" + std::to_string(i + 1));
    for (const std::size_t tool : tools_of(settings)) layout.runs.push_back({i, tool, {}});
  }
  std::size_t positions = affordable_readings(settings, layout) / 2;
  spread_over_runs(settings, sight, positions, layout);
  while (settings.budget.time && positions > layout.runs.size() &&
         duration(layout, settings) > *settings.budget.time) {
    positions -= 1 + positions / 50;
    spread_over_runs(settings, sight, positions, layout);
  }
  std::erase_if(layout.runs, [](const PlanRun& run) { return run.positions.empty(); });
  return layout;
}

}  // namespace volcal
