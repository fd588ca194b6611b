#pragma once
/// Whether the instrument of a plan at a place reads the tool at a position, and whether it can stand there:
/// the settings' instrument (plan_instrument.h) on the settings' machine.
///
/// Not checked: columns, covers, clamped workpieces, a reflector's own angle of acceptance, the tool's shank.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "volcal/identify/planning/measured_positions.h"
#include "volcal/identify/planning/plan_instrument.h"
#include "volcal/identify/planning/swept_volume.h"

namespace volcal {

class LineOfSight {
 public:
  /// The settings must outlive the object. Throws InputError for an instrument that cannot be planned for.
  explicit LineOfSight(const PlanSettings& settings);

  const PlanInstrument& instrument() const { return instrument_; }
  /// Box of the functional points of all tools, workpiece coordinates, rotary axes at home.
  const Eigen::AlignedBox3d& swept_w() const { return swept_.box_w(); }
  /// Where stations may be looked for.
  const Eigen::AlignedBox3d& stations_w() const { return stations_w_; }
  /// Direction from the tool to the spindle, workpiece coordinates, rotary axes at home.
  const Eigen::Vector3d& spindle_w() const { return swept_.spindle_w(); }
  int along_spindle() const { return swept_.along_spindle(); }

  bool can_stand(const Eigen::Vector3d& station_w) const;
  bool sees(const Eigen::Vector3d& station_w, const AxisPosition& position, std::size_t tool) const;
  Eigen::Vector3d point_w(const AxisPosition& position, std::size_t tool) const;

  std::vector<Eigen::Vector3d> textbook_stations_w(int count) const;
  /// As PlanInstrument says; `station` and `tool` number the runs.
  std::vector<PlanRun> candidate_runs(const Eigen::Vector3d& station_w, std::size_t station, std::size_t tool,
                                      const CandidateGrid& grid) const;
  PlanRun moved(const Eigen::Vector3d& station_w, const PlanRun& run) const;
  /// Poses of a tool over which the error of the machine is judged: a grid of the linear axes with rotary
  /// axes at home; of an instrument that turns rotary axes corners and middle of its judged region,
  /// `per_axis` positions of every rotary axis.
  std::vector<AxisPosition> volume(std::size_t tool, int per_axis) const;

 private:
  PlanScene scene() const { return {settings_, swept_}; }
  PlanRun apart(PlanRun run) const;

  const PlanSettings& settings_;
  const PlanInstrument& instrument_;
  SweptVolume swept_;
  Eigen::AlignedBox3d stations_w_;
  MeasuredPositions measured_;
};

}  // namespace volcal
