#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/planning/plan_instrument.h"

namespace volcal {
namespace {

constexpr double kBesideShare = 0.3;   // of the travel
constexpr double kLeastBeside = 0.25;  // m
constexpr double kFarAbove = 100.0;    // m: the spindle's end

/// Tracking interferometer or laser tracker: lengths, and angles, from a station beside the volume.
class PlannedTracking : public PlanInstrument {
 public:
  explicit PlannedTracking(bool angles) : angles_(angles) {}

  std::string name() const override { return angles_ ? "laser-tracker" : "laser-tracer"; }

  std::string study_kind() const override { return name(); }

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

}  // namespace

const PlanInstrument& planned_laser_tracer() {
  static const PlannedTracking instrument(false);
  return instrument;
}

const PlanInstrument& planned_laser_tracker() {
  static const PlannedTracking instrument(true);
  return instrument;
}

}  // namespace volcal
