#include <algorithm>
#include <utility>

#include "volcal/identify/planning/path_choice.h"
#include "volcal/identify/planning/plan_search.h"
#include "volcal/model/description/errors.h"

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

std::vector<PlanPosition> textbook_grid(const LineOfSight& sight, const PlanLayout& layout,
                                        const PlanRun& run, std::size_t count, std::uint64_t stream) {
  for (std::size_t asked = count; asked <= 4 * count + 64; asked += 1 + asked / 16) {
    const PlanRun seen = sight
                             .candidate_runs(layout.stations_w[run.station], run.station, run.tool,
                                             {asked, kTextbookJitter, kTextbookStream + stream})
                             .front();
    if (seen.positions.size() >= count) return even_choice(seen.positions, count);
  }
  return {};
}

/// Evenly over the runs.
void spread_over_runs(const LineOfSight& sight, std::size_t positions, PlanLayout& layout) {
  for (std::size_t r = 0; r < layout.runs.size(); ++r) {
    const std::size_t own = positions / layout.runs.size() + (r < positions % layout.runs.size() ? 1 : 0);
    layout.runs[r].positions = textbook_grid(sight, layout, layout.runs[r], own, r);
  }
}

/// Every tool at every station, or as many tools, in turn from station to station, as the budget leaves a
/// position for; refuses a budget that does not hold one run at every station.
void choose_runs(const PlanSettings& settings, PlanLayout& layout) {
  const std::vector<std::size_t> tools = tools_of(settings);
  for (std::size_t turn = 0; turn < tools.size(); ++turn) {
    PlanLayout more = layout;
    for (std::size_t i = 0; i < layout.stations_w.size(); ++i)
      more.runs.push_back({i, tools[(i + turn) % tools.size()], {}});
    if (!carries_a_position_of_each(settings, more)) break;
    layout = std::move(more);
  }
  std::ranges::sort(layout.runs, {}, [](const PlanRun& run) { return std::pair(run.station, run.tool); });
  if (layout.runs.empty()) fail_one_run_at_every_station();
}

/// An even grid for every run.
void lay_grids(const PlanSettings& settings, const LineOfSight& sight, PlanLayout& layout) {
  choose_runs(settings, layout);
  std::size_t positions = affordable_readings(settings, layout) / 2;
  spread_over_runs(sight, positions, layout);
  while (settings.budget.time && positions > layout.runs.size() &&
         duration(layout, settings) > *settings.budget.time) {
    positions -= 1 + positions / 50;
    spread_over_runs(sight, positions, layout);
  }
  std::erase_if(layout.runs, [](const PlanRun& run) { return run.positions.empty(); });
  if (layout.runs.empty()) fail_unseen(sight);
}

/// Refuses a budget that does not hold one path at every place, before anything is searched.
void require_paths(const PlanSettings& settings, const LineOfSight& sight, PlanLayout layout) {
  for (std::size_t place = 0; place < layout.stations_w.size(); ++place) {
    std::vector<PlanRun> runs;
    for (const std::size_t tool : tools_of(settings)) {
      if (runs.empty()) runs = sight.candidate_runs(layout.stations_w[place], place, tool, {});
    }
    if (!runs.empty()) layout.runs.push_back(runs.front());
  }
  if (layout.runs.empty()) {
    fail_unseen(sight);
  }
  if (!fits_budget(layout, settings)) {
    throw InputError({}, "readings or time do not suffice for one path at every place",
                     "give more --readings or --time, or fewer --stations");
  }
}

/// All that a tool measures at a place, tools in turn from place to place so that each is used alike, as far
/// as the budget goes.
void lay_paths(const PlanSettings& settings, const LineOfSight& sight, PlanLayout& layout) {
  require_paths(settings, sight, layout);
  const std::vector<std::size_t> tools = tools_of(settings);
  for (std::size_t turn = 0; turn < tools.size(); ++turn) {
    for (std::size_t place = 0; place < layout.stations_w.size(); ++place) {
      const std::size_t tool = tools[(place + turn) % tools.size()];
      for (PlanRun& run : sight.candidate_runs(layout.stations_w[place], place, tool, {})) {
        layout.runs.push_back(std::move(run));
        if (!fits_budget(layout, settings)) layout.runs.pop_back();
      }
    }
  }
}

}  // namespace

void fail_unseen(const LineOfSight& sight) {
  const InstrumentWords words = sight.instrument().words();
  throw InputError({}, words.unreached, words.unreached_remedy);
}

void fail_one_run_at_every_station() {
  throw InputError({}, "readings or time do not suffice for one run at every station",
                   "give more --readings or --time, fewer --stations, or a smaller --station-min");
}

PlanLayout textbook_layout(const PlanSettings& settings, const LineOfSight& sight) {
  PlanLayout layout;
  layout.stations_w = sight.textbook_stations_w(settings.budget.stations);
  for (std::size_t i = 0; i < layout.stations_w.size(); ++i)
    layout.station_names.push_back((settings.apart_from == nullptr ? "P" : "V") + std::to_string(i + 1));
  if (sight.instrument().takes_runs_whole()) {
    lay_paths(settings, sight, layout);
  } else {
    lay_grids(settings, sight, layout);
  }
  return layout;
}

}  // namespace volcal
