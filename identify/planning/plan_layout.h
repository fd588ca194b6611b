#pragma once
/// A plan: stations, what is measured from each with which tool, and where.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/planning/plan_settings.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// Place of a position on the grid that paths follow: x changes fastest.
struct PlanPosition {
  AxisPosition position{};
  std::array<int, 3> cell{};
};

/// One tool at one station.
struct PlanRun {
  std::size_t station = 0;
  std::size_t tool = 0;
  std::vector<PlanPosition> positions;
  std::string part = {};  ///< of what is measured there, where there are several: "XY", the plane of a circle
};

struct PlanLayout {
  std::vector<Eigen::Vector3d> stations_w;  ///< m, workpiece coordinates
  std::vector<std::string> station_names;
  std::vector<PlanRun> runs;

  std::size_t positions() const;
  /// Every position is met from both directions.
  std::size_t readings() const { return 2 * positions(); }
};

/// One reading of a run as the machine takes it.
struct PlanReading {
  AxisPosition position{};
  std::array<std::int8_t, kAxisCount> direction{};
  std::int32_t line = 0;
  std::int32_t run = 0;
};

/// Rows of the grid one after another in serpentines: every second row, and every second plane, the other way
/// round.
std::vector<PlanPosition> in_path_order(std::vector<PlanPosition> positions);

/// There in path order, then the same positions in reverse order
/// from the other side. One pass alone when `both` is false. A run with a part is read on its way
/// instead: each pass has the directions in which the machine comes.
std::vector<PlanReading> readings_of(const PlanRun& run, bool both = true);

/// Time that a plan takes, s: stations, runs, readings, moves between them (the slowest axis at the feed).
double duration(const PlanLayout& layout, const PlanSettings& settings);

std::string run_name(const PlanLayout& layout, const PlanRun& run, const Machine& machine);

/// The plan as a campaign with nominal readings: existing setups first, as they are.
Campaign campaign_of(const PlanLayout& layout, const PlanSettings& settings, bool both = true);

/// Positions of a grid over the whole travel, `per_axis` of them, each moved by up to `jitter` of a step and
/// clipped to the travel, other positions for every `stream`; in whole micrometres.
std::vector<PlanPosition> grid_over_travel(const Machine& machine, const Eigen::Vector3i& per_axis,
                                           double jitter, std::uint64_t seed, std::uint64_t stream);

/// Counts per axis of about `positions` positions, in proportion to the travels' cube roots, 3 at least.
Eigen::Vector3i even_grid(const Machine& machine, std::size_t positions);

}  // namespace volcal
