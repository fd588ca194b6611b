#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "volcal/identify/planning/plan_instrument.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

constexpr double kBesideShare = 0.3;   // of the travel
constexpr double kLeastBeside = 0.25;  // m
constexpr double kFarAbove = 100.0;    // m: the spindle's end

/// Tracking interferometer or laser tracker: lengths, and angles, from a station beside the volume.
class PlannedTracking : public PlanInstrument {
 public:
  explicit PlannedTracking(bool angles) : angles_(angles) {}

  std::string name() const override { return instrument(); }

  std::string instrument() const override { return angles_ ? "laser-tracker" : "laser-tracer"; }

  std::string study_kind() const override { return instrument(); }

  InstrumentWords words() const override {
    return {
        "station",
        "stations",
        "Stations, workpiece coordinates",
        "stations may stand",
        "Checked: range and elevation of the instrument, that beams pass by the spindle, that stations are "
        "clear of what tools and spindle sweep; not columns, covers and clamped parts.",
        "no station sees the positions: range, elevation or the spindle are in the way",
        "give a wider --range-mm or --elevation-deg, a smaller --spindle-mm or another --region-mm"};
  }

  std::vector<std::string> own_options() const override {
    return {"--range-mm", "--elevation-deg", "--clearance-mm", "--angle-noise-urad"};
  }

  double usual_reading_time() const override { return 4.0; }

  void check(const PlanSettings& /*settings*/) const override {}

  Eigen::AlignedBox3d region_w(const PlanScene& scene) const override {
    if (scene.settings.surroundings.stations_w) return *scene.settings.surroundings.stations_w;
    const Eigen::AlignedBox3d& swept = scene.swept.box_w();
    const Eigen::Vector3d beside = (kBesideShare * swept.sizes()).cwiseMax(kLeastBeside);
    Eigen::AlignedBox3d region(swept.min() - beside, swept.max() + beside);
    const int along = scene.swept.along_spindle();
    const bool up = scene.swept.spindle_w()[along] > 0.0;
    (up ? region.max() : region.min())[along] = swept.center()[along];
    (up ? region.min() : region.max())[along] = (up ? swept.min() : swept.max())[along];
    return region;
  }

  bool can_stand(const PlanScene& scene, const Eigen::Vector3d& place_w) const override {
    const Eigen::AlignedBox3d& swept = scene.swept.box_w();
    const Eigen::Vector3d clearance = Eigen::Vector3d::Constant(scene.settings.surroundings.clearance);
    Eigen::AlignedBox3d kept_clear(swept.min() - clearance, swept.max() + clearance);
    kept_clear.extend(kept_clear.center() + kFarAbove * scene.swept.spindle_w());
    return region_w(scene).contains(place_w) && !kept_clear.contains(place_w);
  }

  bool reaches(const PlanScene& scene, const Eigen::Vector3d& place_w, const AxisPosition& position,
               std::size_t tool) const override {
    const Eigen::Vector3d beam = scene.swept.point_w(position, tool) - place_w;
    const double range = beam.norm();
    const InstrumentLimits& limits = scene.settings.limits;
    if (range < limits.range_min || range > limits.range_max) return false;
    const double elevation = std::asin(std::clamp(beam.z() / range, -1.0, 1.0));
    if (elevation < limits.elevation_min || elevation > limits.elevation_max) return false;
    return scene.swept.passes_spindle(place_w, position, tool);
  }

  /// Around the floor of the region, at its corners where there are four; the fourth at its top, since four
  /// stations in one plane know next to nothing (Takatsuji et al. 1998, Meas. Sci. Technol. 9, 1357).
  std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const override {
    const int up = scene.swept.along_spindle();
    const int first = (up + 1) % 3, second = (up + 2) % 3;
    const Eigen::AlignedBox3d region = region_w(scene);
    const Eigen::AlignedBox3d& swept = scene.swept.box_w();
    const bool spindle_above = scene.swept.spindle_w()[up] > 0.0;
    const double floor =
        std::clamp(spindle_above ? swept.min()[up] : swept.max()[up], region.min()[up], region.max()[up]);
    constexpr int kAround[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    std::vector<Eigen::Vector3d> stations;
    for (int i = 0; i < count; ++i) {
      const double turn = 4.0 * i / count;
      const int corner = static_cast<int>(turn);
      const double share = turn - corner;
      Eigen::Vector3d station;
      const bool raised = i % 4 == 3;
      station[up] = raised ? spindle_above ? region.max()[up] : region.min()[up] : floor;
      for (int k = 0; k < 2; ++k) {
        const int axis = k == 0 ? first : second;
        const double place = kAround[corner][k] + share * (kAround[corner + 1][k] - kAround[corner][k]);
        station[axis] = region.min()[axis] + place * region.sizes()[axis];
      }
      stations.push_back(station);
    }
    return stations;
  }

  bool takes_runs_whole() const override { return false; }

  /// One run: a jittered grid over the whole travel, in path order.
  std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                      const PlanRun& at, const CandidateGrid& grid) const override {
    const Machine& machine = scene.settings.machine;
    PlanRun run = at;
    run.positions = grid_over_travel(machine, even_grid(machine, grid.positions), grid.jitter,
                                     scene.settings.seed, grid.stream);
    run = moved(scene, place_w, run);
    run.positions = in_path_order(std::move(run.positions));
    return {run};
  }

  /// The positions that are still seen.
  PlanRun moved(const PlanScene& scene, const Eigen::Vector3d& place_w, const PlanRun& run) const override {
    PlanRun seen = run;
    std::erase_if(seen.positions, [&](const PlanPosition& each) {
      return !reaches(scene, place_w, each.position, run.tool);
    });
    return seen;
  }

  void describe(const PlanSettings& settings, const NamedPlace& place, Setup& setup) const override {
    setup.options.set("station", place.name);
    setup.options.set("station", place.place_w);
    setup.has_noise = true;
    setup.noise.set("constant", settings.noise.constant);
    setup.noise.set("per_metre", settings.noise.per_metre);
    if (angles_) setup.noise.set("angle", settings.noise.angle);
    setup.repeatability = settings.noise.repeatability;
  }

  std::vector<double> nominal_reading(const Eigen::Vector3d& place_w,
                                      const Eigen::Vector3d& point_w) const override {
    const Eigen::Vector3d beam = point_w - place_w;
    if (!angles_) return {beam.norm()};
    return {beam.norm(), std::atan2(beam.y(), beam.x()),
            std::atan2(beam.z(), std::hypot(beam.x(), beam.y()))};
  }

  std::optional<NamedPlace> place_of(const Setup& setup, const Machine& /*machine*/) const override {
    const auto place_w = setup.options.vector("station");
    if (!place_w) return std::nullopt;
    return NamedPlace{setup.options.text("station").value_or(setup.name), *place_w};
  }

 private:
  bool angles_;
};

/// The same tracing interferometer while rotary axes move: on the table, with which it turns, or beside the
/// volume of a machine whose tool alone turns. Every combination of the rotary axes' positions is met, the
/// linear axes anywhere in their travel.
class PlannedTurningTracer : public PlannedTracking {
 public:
  PlannedTurningTracer() : PlannedTracking(false) {}

  std::string name() const override { return "laser-tracer-rotary"; }

  InstrumentWords words() const override {
    InstrumentWords words = PlannedTracking::words();
    words.checked =
        "Checked: range and elevation of the instrument, as it turns with the table that it stands on, and "
        "that beams pass by the spindle as it stands at every pose; not whether spindle, table and "
        "instrument "
        "keep clear of each other, nor whether the reflector looks at the station.";
    words.unreached_remedy =
        "give a wider --range-mm or --elevation-deg, a smaller --spindle-mm, or --region-mm, where stations "
        "may "
        "stand on the table";
    return words;
  }

  std::vector<std::string> own_options() const override {
    std::vector<std::string> options = PlannedTracking::own_options();
    options.emplace_back("--turn-deg-s");
    std::erase(options, "--angle-noise-urad");
    return options;
  }

  void check(const PlanSettings& settings) const override { require_rotary_axes(settings.machine, name()); }

  bool turns_rotary_axes() const override { return true; }

  Eigen::AlignedBox3d judged_region_w(const PlanScene& scene) const override {
    return rotary_region_w(scene.settings.machine, scene.swept);
  }

  Eigen::AlignedBox3d region_w(const PlanScene& scene) const override {
    if (scene.settings.surroundings.stations_w || !stands_on_table(scene))
      return PlannedTracking::region_w(scene);
    return rotary_region_w(scene.settings.machine, scene.swept);
  }

  /// On a table the beam's range keeps spindle and tool away.
  bool can_stand(const PlanScene& scene, const Eigen::Vector3d& place_w) const override {
    if (stands_on_table(scene)) return region_w(scene).contains(place_w);
    return PlannedTracking::can_stand(scene, place_w);
  }

  /// On a circle about the table's axis, every fourth as high as it may stand.
  std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const override {
    if (!stands_on_table(scene)) return PlannedTracking::textbook_places_w(scene, count);
    const int up = scene.swept.along_spindle();
    std::vector<Eigen::Vector3d> places = places_on_circle_w(region_w(scene), up, count);
    for (std::size_t i = 3; i < places.size(); i += 4) places[i][up] = region_w(scene).max()[up];
    return places;
  }

  std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                      const PlanRun& at, const CandidateGrid& grid) const override {
    const Machine& machine = scene.settings.machine;
    PlanRun run = at;
    run.positions = rotary_grid(machine, grid.positions > 0 ? grid.positions : kUsualPoses, grid.jitter,
                                scene.settings.seed, grid.stream);
    int number = 1 + static_cast<int>(grid.stream % kOtherStart);
    for (PlanPosition& each : run.positions) {
      place_linear_axes(machine, number, each.position);
      ++number;
    }
    run = moved(scene, place_w, run);
    run.positions = in_path_order(std::move(run.positions));
    return {run};
  }

 private:
  static constexpr std::size_t kUsualPoses = 108;
  static constexpr std::uint64_t kOtherStart = 1009;

  static bool stands_on_table(const PlanScene& scene) {
    return innermost_table(scene.settings.machine) != nullptr;
  }

  static void place_linear_axes(const Machine& machine, int number, AxisPosition& position) {
    constexpr std::array<int, 3> kBases = {2, 3, 5};
    for (const AxisName name : kLinearAxes) {
      const Axis& axis = machine.axis(name);
      const double share = radical_inverse(number, kBases[static_cast<std::size_t>(direction_of(name))]);
      position[index_of(name)] = std::clamp(programmed_position(axis.travel_min + share * axis.travel()),
                                            axis.travel_min, axis.travel_max);
    }
  }
};

}  // namespace

const PlanInstrument& planned_turning_tracer() {
  static const PlannedTurningTracer instrument;
  return instrument;
}

const PlanInstrument& planned_laser_tracer() {
  static const PlannedTracking instrument(false);
  return instrument;
}

const PlanInstrument& planned_laser_tracker() {
  static const PlannedTracking instrument(true);
  return instrument;
}

}  // namespace volcal
