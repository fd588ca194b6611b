// A sample: a ball-bar on a holder that lets it turn in the plane XY alone, a position every 30 degrees.
#include <cmath>
#include <numbers>

#include "volcal/identify/planning/instruments/bar_instrument.h"

namespace volcal {
namespace {

constexpr int kSamplePositions = 12;

class PlannedSample final : public BarInstrument {
 public:
  std::string name() const override { return "sample-bar"; }
  InstrumentWords words() const override {
    return words_of_bar("Checked: that whole circles are within the travel.",
                        "nothing can be measured about the middle of the volume: no circle fits there",
                        "give a shorter --bar-mm");
  }
  std::vector<std::string> own_options() const override { return {"--bar-mm", "--bar-sigma-um"}; }

  Eigen::AlignedBox3d region_w(const PlanScene& scene) const override { return scene.swept.box_w(); }
  std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const override {
    return std::vector<Eigen::Vector3d>(static_cast<std::size_t>(count), region_w(scene).center());
  }

  /// The whole circle, or none.
  std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                      const PlanRun& at, const CandidateGrid& /*grid*/) const override {
    PlanRun run = at;
    run.part = "XY";
    run.positions.clear();
    for (int i = 0; i < kSamplePositions; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSamplePositions;
      const Eigen::Vector3d across(std::cos(angle), std::sin(angle), 0.0);
      const auto position = scene.swept.position_at(place_w + scene.settings.bar.length * across, at.tool);
      if (!position || !reaches(scene, place_w, *position, at.tool)) return {};
      run.positions.push_back({*position, {i, 0, 0}});
    }
    return {run};
  }

#ifdef VOLCAL_WRONG_SAMPLE
  std::optional<NamedPlace> place_of(const Setup& /*setup*/, const Machine& /*machine*/) const override {
    return std::nullopt;
  }
#endif
};

}  // namespace

const PlanInstrument& planned_sample() {
  static const PlannedSample instrument;
  return instrument;
}

}  // namespace volcal
