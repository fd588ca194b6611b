#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "volcal/identify/planning/instruments/bar_instrument.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

/// How dense a path is.
struct PathDensity {
  double per_turn;       ///< positions of one axis
  int fewest;            ///< of an axis that does not turn right round
  std::size_t combined;  ///< positions of all axes together, about
};
constexpr PathDensity kAsMeasured = {36.0, 12, 60};
constexpr PathDensity kWhileSearching = {18.0, 9, 24};
constexpr double kLeastReached = 0.5;  // of a path's positions, that the machine must reach
constexpr double kJitter = 0.5;  // of a grid step: other positions on every path, so that high harmonics show
constexpr std::uint64_t kMostTools = 100;
constexpr double kOnTheAxis = 1e-3;  // m: no radial direction any more
constexpr std::array<const char*, 3> kToTheAxis = {"radial", "axial", "tangential"};
constexpr std::array<const char*, 3> kOfTheMachine = {"x", "y", "z"};

double turn_of(double length) { return length / (2.0 * std::numbers::pi); }

/// The longest row of positions without a gap.
std::vector<PlanPosition> longest_row(const std::vector<std::optional<PlanPosition>>& all) {
  std::vector<PlanPosition> longest, row;
  for (const std::optional<PlanPosition>& each : all) {
    if (!each) row.clear();
    if (each) row.push_back(*each);
    if (row.size() > longest.size()) longest = row;
  }
  return longest;
}

/// Directions of a bar about one place, for one tool. Workpiece coordinates.
class BarDirections {
 public:
  BarDirections(const PlanScene& scene, const Eigen::Vector3d& place_w, std::size_t tool)
      : machine_(scene.settings.machine), swept_(scene.swept), chain_(machine_) {
    home_ = home_position(machine_);
    const Eigen::Vector3d& offset = machine_.tools[tool].offset;
    levers_.resize(chain_.joint_count());
    const Eigen::Vector3d point_w = chain_.levers(home_, offset, levers_.data());
    from_point_w_ = place_w - point_w;
  }

  /// Radial, axial and tangential to an axis at home, by columns. Of a table the place lies radially, of a
  /// head the tool; on the axis itself any direction across it counts as radial.
  Eigen::Matrix3d to_axis_w(AxisName axis) const {
    const JointLever& lever = joint_lever(levers_.data(), levers_.size(), axis);
    const Eigen::Vector3d along_s = Eigen::Vector3d::Unit(direction_of(axis));
    Eigen::Vector3d arm_s = lever.arm_s;
    if (lever.workpiece_side) arm_s += lever.rotation_ws.transpose() * from_point_w_;
    arm_s -= arm_s.dot(along_s) * along_s;
    if (arm_s.norm() < kOnTheAxis) arm_s = Eigen::Vector3d::Unit((direction_of(axis) + 1) % 3);
    const Eigen::Vector3d radial_w = lever.rotation_ws * arm_s.normalized();
    Eigen::Vector3d axial_w = lever.rotation_ws * along_s;
    if (axial_w.dot(swept_.spindle_w()) < 0.0) axial_w = -axial_w;
    Eigen::Matrix3d directions_w;
    directions_w << radial_w, axial_w, axial_w.cross(radial_w);
    return directions_w;
  }

  /// Such a direction where its axis has turned: it goes with the table, and with the head.
  Eigen::Vector3d turned_w(const Eigen::Vector3d& direction_w, AxisName axis,
                           const AxisPosition& position) const {
    if (joint_lever(levers_.data(), levers_.size(), axis).workpiece_side) return direction_w;
    return chain_.nominal_rotation_wt(position) * chain_.nominal_rotation_wt(home_).transpose() * direction_w;
  }

  /// A coordinate direction of the machine, away from the table where it is the spindle's.
  Eigen::Vector3d of_machine_w(int direction, AxisPosition position) const {
    for (const Joint& joint : machine_.structure.joints) {
      if (!joint.workpiece_side && is_rotary(joint.axis)) position[index_of(joint.axis)] = 0.0;
    }
    const bool down = direction == swept_.along_spindle() && swept_.spindle_w()[direction] < 0.0;
    return chain_.nominal_rotation_wt(position).col(direction) * (down ? -1.0 : 1.0);
  }

 private:
  const Machine& machine_;
  const SweptVolume& swept_;
  KinematicChain chain_;
  AxisPosition home_{};
  std::vector<JointLever> levers_;
  Eigen::Vector3d from_point_w_;  ///< of the tool with the axes at home, to the place
};

/// Telescoping ball-bar while rotary axes move, the linear axes following so that the bar keeps its length
/// (the kind of test of ISO 10791-6): one axis after another with the bar radial, axial and tangential to it,
/// and all combinations of their positions with the bar along x, y and z of the machine.
class PlannedRotaryBallBar : public BarInstrument {
 public:
  std::string name() const override { return "ball-bar-rotary"; }

  InstrumentWords words() const override {
    return words_of_bar(
        "Checked: that the linear axes follow within their travel over half of a path at least, that the "
        "bar passes by the spindle as it stands at every pose; not whether bar, spindle, tool, table and "
        "the holder of the centre ball keep clear of each other.",
        "no bar keeps its length while the rotary axes turn: the linear axes do not follow, or the spindle "
        "is in the way",
        "give --region-mm, where centre balls may stand on the table, nearer to the rotary axes, a shorter "
        "--bar-mm or a smaller --spindle-mm");
  }

  std::vector<std::string> own_options() const override {
    return {"--bar-mm", "--bar-sigma-um", "--turn-deg-s"};
  }

  void check(const PlanSettings& settings) const override {
    require_rotary_axes(settings.machine, name());
    BarInstrument::check(settings);
  }

  bool turns_rotary_axes() const override { return true; }

  Eigen::AlignedBox3d region_w(const PlanScene& scene) const override {
    if (scene.settings.surroundings.stations_w) return *scene.settings.surroundings.stations_w;
    return rotary_region_w(scene.settings.machine, scene.swept);
  }

  std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const override {
    return places_on_circle_w(region_w(scene), scene.swept.along_spindle(), count);
  }

  std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                      const PlanRun& at, const CandidateGrid& grid) const override {
    const PathDensity& density = grid.positions > 0 ? kWhileSearching : kAsMeasured;
    const BarDirections directions(scene, place_w, at.tool);
    std::vector<PlanRun> runs;
    const std::vector<RotaryStretch> stretches = rotary_stretches(scene.settings.machine);
    for (const RotaryStretch& stretch : stretches) {
      const std::vector<PlanPosition> sweep = sweep_of(scene.settings.machine, stretch, density);
      const Eigen::Matrix3d to_axis_w = directions.to_axis_w(stretch.axis);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto bar_w = [&](const AxisPosition& rotary) {
          const Eigen::Vector3d at_home_w = to_axis_w.col(static_cast<Eigen::Index>(k));
          return directions.turned_w(at_home_w, stretch.axis, rotary);
        };
        PlanRun run = at;
        run.part = letter_of(stretch.axis) + std::string("-") + kToTheAxis[k];
        run.positions = longest_row(followed(scene, place_w, at.tool, sweep, bar_w));
        if (is_enough(run, sweep)) runs.push_back(std::move(run));
      }
    }
    if (stretches.size() > 1) add_combined(scene, place_w, at, density, directions, runs);
    return runs;
  }

 private:
  static std::vector<PlanPosition> sweep_of(const Machine& machine, const RotaryStretch& stretch,
                                            const PathDensity& density) {
    const auto count = static_cast<int>(std::lround(density.per_turn * turn_of(stretch.length())));
    return rotary_sweep(machine, stretch, std::max(density.fewest, count));
  }

  static bool is_enough(const PlanRun& run, const std::vector<PlanPosition>& wanted) {
    return static_cast<double>(run.positions.size()) >= kLeastReached * static_cast<double>(wanted.size());
  }

  /// Paths through all combinations of the rotary axes' positions, those that the machine reaches.
  void add_combined(const PlanScene& scene, const Eigen::Vector3d& place_w, const PlanRun& at,
                    const PathDensity& density, const BarDirections& directions,
                    std::vector<PlanRun>& runs) const {
    std::string letters;
    for (const RotaryStretch& stretch : rotary_stretches(scene.settings.machine))
      letters += letter_of(stretch.axis);
    for (int k = 0; k < 3; ++k) {
      const auto bar_w = [&](const AxisPosition& rotary) { return directions.of_machine_w(k, rotary); };
      const auto stream = static_cast<std::uint64_t>(k) + 3 * (at.tool + kMostTools * at.station);
      const std::vector<PlanPosition> all =
          rotary_grid(scene.settings.machine, density.combined, kJitter, scene.settings.seed, stream);
      PlanRun run = at;
      run.part = letters + "-" + kOfTheMachine[static_cast<std::size_t>(k)];
      run.positions.clear();
      for (const auto& each : followed(scene, place_w, at.tool, all, bar_w)) {
        if (each) run.positions.push_back(*each);
      }
      if (is_enough(run, all)) runs.push_back(std::move(run));
    }
  }

  /// The linear axes at the bar's length from the place, where they can be.
  template <class Bar>
  std::vector<std::optional<PlanPosition>> followed(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                                    std::size_t tool, const std::vector<PlanPosition>& rotary,
                                                    const Bar& bar_w) const {
    std::vector<std::optional<PlanPosition>> positions;
    for (const PlanPosition& each : rotary) {
      const Eigen::Vector3d point_w = place_w + scene.settings.bar.length * bar_w(each.position);
      const auto position = scene.swept.position_at(point_w, tool, each.position);
      const bool reached = position && reaches(scene, place_w, *position, tool);
      positions.push_back(reached ? std::optional(PlanPosition{*position, each.cell}) : std::nullopt);
    }
    return positions;
  }
};

}  // namespace

const PlanInstrument& planned_rotary_ball_bar() {
  static const PlannedRotaryBallBar instrument;
  return instrument;
}

}  // namespace volcal
