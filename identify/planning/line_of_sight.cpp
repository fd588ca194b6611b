#include "volcal/identify/planning/line_of_sight.h"

#include <utility>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"

namespace volcal {
namespace {

constexpr double kBeside = 0.04;  // m, towards the middle of the region, of a place that was measured from
constexpr int kMostSteps = 20;

}  // namespace

LineOfSight::LineOfSight(const PlanSettings& settings)
    : settings_(settings),
      instrument_(plan_instrument_of(settings)),
      swept_(settings),
      stations_w_(instrument_.region_w({settings, swept_})),
      measured_(settings) {}

bool LineOfSight::can_stand(const Eigen::Vector3d& station_w) const {
  return !measured_.has_place(station_w) && instrument_.can_stand(scene(), station_w);
}

bool LineOfSight::sees(const Eigen::Vector3d& station_w, const AxisPosition& position,
                       std::size_t tool) const {
  return !measured_.has(position) && instrument_.reaches(scene(), station_w, position, tool);
}

Eigen::Vector3d LineOfSight::point_w(const AxisPosition& position, std::size_t tool) const {
  return swept_.point_w(position, tool);
}

std::vector<Eigen::Vector3d> LineOfSight::textbook_stations_w(int count) const {
  std::vector<Eigen::Vector3d> places_w = instrument_.textbook_places_w(scene(), count);
  const Eigen::Vector3d middle_w = stations_w_.center();
  for (Eigen::Vector3d& place_w : places_w) {
    for (int step = 0; measured_.has_place(place_w) && step < kMostSteps; ++step)
      place_w += kBeside * (middle_w - place_w).normalized();
  }
  return places_w;
}

std::vector<PlanRun> LineOfSight::candidate_runs(const Eigen::Vector3d& station_w, std::size_t station,
                                                 std::size_t tool, const CandidateGrid& grid) const {
  std::vector<PlanRun> runs = instrument_.candidate_runs(scene(), station_w, {station, tool, {}, {}}, grid);
  for (PlanRun& run : runs) run = apart(std::move(run));
  return runs;
}

std::vector<AxisPosition> LineOfSight::volume(std::size_t tool, int per_axis) const {
  if (!instrument_.turns_rotary_axes()) return grid_positions(settings_.machine, per_axis);
  return poses_in_box(settings_.machine, swept_, instrument_.judged_region_w(scene()), tool, per_axis);
}

PlanRun LineOfSight::moved(const Eigen::Vector3d& station_w, const PlanRun& run) const {
  return apart(instrument_.moved(scene(), station_w, run));
}

/// Of circles no position is taken out: they are whole.
PlanRun LineOfSight::apart(PlanRun run) const {
  if (instrument_.takes_runs_whole() || settings_.apart_from == nullptr) return run;
  std::erase_if(run.positions, [&](const PlanPosition& each) { return measured_.has(each.position); });
  return run;
}

}  // namespace volcal
