#include "volcal/identify/planning/line_of_sight.h"

#include "volcal/identify/planning/registry.h"

namespace volcal {

LineOfSight::LineOfSight(const PlanSettings& settings)
    : settings_(settings),
      instrument_(plan_instrument_of(settings)),
      swept_(settings),
      stations_w_(instrument_.region_w({settings, swept_})) {}

bool LineOfSight::can_stand(const Eigen::Vector3d& station_w) const {
  return instrument_.can_stand(scene(), station_w);
}

bool LineOfSight::sees(const Eigen::Vector3d& station_w, const AxisPosition& position,
                       std::size_t tool) const {
  return instrument_.reaches(scene(), station_w, position, tool);
}

Eigen::Vector3d LineOfSight::point_w(const AxisPosition& position, std::size_t tool) const {
  return swept_.point_w(position, tool);
}

std::vector<Eigen::Vector3d> LineOfSight::textbook_stations_w(int count) const {
  return instrument_.textbook_places_w(scene(), count);
}

std::vector<PlanRun> LineOfSight::candidate_runs(const Eigen::Vector3d& station_w, std::size_t station,
                                                 std::size_t tool, const CandidateGrid& grid) const {
  return instrument_.candidate_runs(scene(), station_w, {station, tool, {}, {}}, grid);
}

PlanRun LineOfSight::moved(const Eigen::Vector3d& station_w, const PlanRun& run) const {
  return instrument_.moved(scene(), station_w, run);
}

}  // namespace volcal
