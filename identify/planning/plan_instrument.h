#pragma once
/// What the planner must know of an instrument: where it may stand, what it reaches from there, what one run
/// of it measures, and how that is written down as a campaign. A new instrument is one file in instruments/
/// and one line in registry.cpp.
///
/// A place is where the instrument stands in workpiece coordinates, m: a tracker's station, the centre ball
/// of a ball-bar, a sphere on the table.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/planning/plan_layout.h"
#include "volcal/identify/planning/swept_volume.h"

namespace volcal {

/// What is planned and the room that the machine leaves.
struct PlanScene {
  const PlanSettings& settings;
  const SweptVolume& swept;
};

/// What reports call things.
struct InstrumentWords {
  std::string place;             ///< "station"
  std::string places;            ///< "stations"
  std::string heading;           ///< of their table
  std::string region;            ///< what the region of places is
  std::string checked;           ///< what is checked of a position and what is not, sentences
  std::string unreached;         ///< what is wrong where nothing can be measured from any place
  std::string unreached_remedy;  ///< and what to do
};

/// How dense the positions are that are chosen from, where they are exchanged one by one.
struct CandidateGrid {
  std::size_t positions = 0;  ///< of a run, about; 0: as it is measured
  double jitter = 0.0;        ///< of a grid step
  std::uint64_t stream = 0;   ///< of random numbers
};

/// Where the instrument of a setup stands.
struct NamedPlace {
  std::string name;
  Eigen::Vector3d place_w = Eigen::Vector3d::Zero();
  std::string part = {};  ///< of what is measured from there with a tool; empty: all of it
};

class PlanInstrument {
 public:
  virtual ~PlanInstrument() = default;

  /// What `--instrument` of `volcal plan` takes.
  virtual std::string name() const = 0;
  /// Of its setups, as in model/instruments/registry.h: what turns rotary axes beside it has a name of its
  /// own.
  virtual std::string instrument() const { return name(); }
  virtual InstrumentWords words() const = 0;
  /// Kind of the measurement of a study file that simulates what is planned.
  virtual std::string study_kind() const = 0;
  /// Those options of `volcal plan` that this instrument has and not every other.
  virtual std::vector<std::string> own_options() const = 0;
  /// s, where the user says nothing.
  virtual double usual_reading_time() const = 0;
  /// Throws InputError for settings that it cannot be planned with.
  virtual void check(const PlanSettings& settings) const = 0;

  /// Where places are looked for.
  virtual Eigen::AlignedBox3d region_w(const PlanScene& scene) const = 0;
  virtual bool can_stand(const PlanScene& scene, const Eigen::Vector3d& place_w) const = 0;
  /// Whether a position can be read with a tool from a place.
  virtual bool reaches(const PlanScene& scene, const Eigen::Vector3d& place_w, const AxisPosition& position,
                       std::size_t tool) const = 0;
  /// What everybody would do.
  virtual std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const = 0;

  /// Its runs move the rotary axes; otherwise they stand at home.
  virtual bool turns_rotary_axes() const { return false; }
  /// The tool stays at the place, a sphere, while they turn.
  virtual bool stays_at_its_place() const { return false; }
  /// Where the error of the machine is judged, of an instrument that turns rotary axes.
  virtual Eigen::AlignedBox3d judged_region_w(const PlanScene& scene) const { return region_w(scene); }
  /// A run is taken whole or not at all; otherwise its positions are exchanged one by one.
  virtual bool takes_runs_whole() const = 0;
  /// Runs of one tool at a place with all the positions that can be chosen of; none where nothing is reached.
  virtual std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                              const PlanRun& at, const CandidateGrid& grid) const = 0;
  /// What becomes of a run when its instrument stands at another place; without positions: nothing.
  virtual PlanRun moved(const PlanScene& scene, const Eigen::Vector3d& place_w, const PlanRun& run) const = 0;

  /// Options and noise of the setup of a run at a place.
  virtual void describe(const PlanSettings& settings, const NamedPlace& place, Setup& setup) const = 0;
  /// Nominal reading of a functional point, m and rad.
  virtual std::vector<double> nominal_reading(const Eigen::Vector3d& place_w,
                                              const Eigen::Vector3d& point_w) const = 0;
  /// Of a setup of this instrument; nullopt where it does not say.
  virtual std::optional<NamedPlace> place_of(const Setup& setup, const Machine& machine) const = 0;
};

}  // namespace volcal
