#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "volcal/identify/planning/instruments/bar_instrument.h"

namespace volcal {
namespace {

constexpr int kPositionsPerTurn = 36;
constexpr std::size_t kLeastPositions = 10;  // of an arc: a quarter of a turn

/// Coordinate plane of the workpiece, its circle turning from the first direction to the second.
struct CirclePlane {
  const char* name;
  int first;
  int second;
};
constexpr std::array<CirclePlane, 3> kPlanes = {{{"XY", 0, 1}, {"YZ", 1, 2}, {"ZX", 2, 0}}};

using Around = std::array<std::optional<AxisPosition>, kPositionsPerTurn>;

/// The longest arc of a circle that the machine reaches, the whole circle if it can; in its sense of turn.
std::vector<PlanPosition> longest_arc(const Around& around) {
  const auto at = [&](int i) { return around[static_cast<std::size_t>(i % kPositionsPerTurn)]; };
  int longest_first = 0, longest = 0;
  for (int first = 0; first < kPositionsPerTurn; ++first) {
    int count = 0;
    while (count < kPositionsPerTurn && at(first + count)) ++count;
    if (count <= longest) continue;
    longest_first = first;
    longest = count;
  }
  std::vector<PlanPosition> arc;
  arc.reserve(static_cast<std::size_t>(longest));
  for (int i = 0; i < longest; ++i) arc.push_back({*at(longest_first + i), {i, 0, 0}});
  return arc;
}

/// Telescoping ball-bar (ISO 230-4): circles about a centre ball, both ways round.
class PlannedBallBar : public BarInstrument {
 public:
  std::string name() const override { return "ball-bar"; }

  InstrumentWords words() const override {
    return words_of_bar(
        "Checked: that the arcs are within the travel, that the bar passes by the spindle; not the table, "
        "the holder of the centre ball, the tool's shank, covers and clamped parts.",
        "nothing can be measured about the middle of the volume: no tool gets round it",
        "give a shorter --bar-mm, a smaller --spindle-mm or another --region-mm");
  }

  std::vector<std::string> own_options() const override { return {"--bar-mm", "--bar-sigma-um"}; }

  Eigen::AlignedBox3d region_w(const PlanScene& scene) const override {
    return scene.settings.surroundings.stations_w.value_or(scene.swept.box_w());
  }

  /// Through the middle of the volume, evenly along its longest side.
  std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const override {
    const Eigen::AlignedBox3d region = region_w(scene);
    int longest = 0;
    region.sizes().maxCoeff(&longest);
    std::vector<Eigen::Vector3d> places(static_cast<std::size_t>(count), region.center());
    for (int i = 0; i < count; ++i) {
      places[static_cast<std::size_t>(i)][longest] =
          region.min()[longest] + (2 * i + 1) * region.sizes()[longest] / (2 * count);
    }
    return places;
  }

  /// A run in each plane where a quarter of a turn at least is reached.
  std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                      const PlanRun& at, const CandidateGrid& /*grid*/) const override {
    std::vector<PlanRun> runs;
    for (const CirclePlane& plane : kPlanes) {
      PlanRun run = at;
      run.part = plane.name;
      run.positions = arc_in(scene, plane, place_w, at.tool);
      if (run.positions.size() >= kLeastPositions) runs.push_back(std::move(run));
    }
    return runs;
  }

 private:
  std::vector<PlanPosition> arc_in(const PlanScene& scene, const CirclePlane& plane,
                                   const Eigen::Vector3d& place_w, std::size_t tool) const {
    Around around;
    for (int i = 0; i < kPositionsPerTurn; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kPositionsPerTurn;
      Eigen::Vector3d point_w = place_w;
      point_w[plane.first] += scene.settings.bar.length * std::cos(angle);
      point_w[plane.second] += scene.settings.bar.length * std::sin(angle);
      auto position = scene.swept.position_at(point_w, tool);
      if (position && reaches(scene, place_w, *position, tool))
        around[static_cast<std::size_t>(i)] = position;
    }
    return longest_arc(around);
  }
};

}  // namespace

const PlanInstrument& planned_ball_bar() {
  static const PlannedBallBar instrument;
  return instrument;
}

}  // namespace volcal
