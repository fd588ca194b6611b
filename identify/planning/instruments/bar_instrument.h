#pragma once
/// What plans for a telescoping ball-bar have in common, whether rotary axes move or not: a centre ball on
/// the workpiece's side, a bar of one length, paths that are taken whole, read on their way there and back.

#include <string>
#include <vector>

#include "volcal/identify/planning/plan_instrument.h"

namespace volcal {

class BarInstrument : public PlanInstrument {
 public:
  static constexpr double kHalfStroke = 1e-3;  ///< m, that a bar is longer or shorter than nominal

  std::string instrument() const override { return "ball-bar"; }
  std::string study_kind() const override { return "ball-bar-circles"; }
  double usual_reading_time() const override { return 0.1; }
  /// Throws InputError without a length of the bar.
  void check(const PlanSettings& settings) const override;

  /// Words of a plan whose centre balls stand at places: what was checked, why nothing can be measured, the
  /// remedy.
  static InstrumentWords words_of_bar(std::string checked, std::string unreached, std::string remedy);

  bool can_stand(const PlanScene& scene, const Eigen::Vector3d& place_w) const override;
  bool reaches(const PlanScene& scene, const Eigen::Vector3d& place_w, const AxisPosition& position,
               std::size_t tool) const override;

  bool takes_runs_whole() const override { return true; }
  /// The same path about the new place.
  PlanRun moved(const PlanScene& scene, const Eigen::Vector3d& place_w, const PlanRun& run) const override;

  void describe(const PlanSettings& settings, const NamedPlace& place, Setup& setup) const override;
  std::vector<double> nominal_reading(const Eigen::Vector3d& place_w,
                                      const Eigen::Vector3d& point_w) const override;
  /// Setups of a plan are called PLACE_TOOL_PART; others name their place themselves.
  std::optional<NamedPlace> place_of(const Setup& setup, const Machine& machine) const override;
};

}  // namespace volcal
