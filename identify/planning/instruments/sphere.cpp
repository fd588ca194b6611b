#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "volcal/identify/planning/plan_instrument.h"
#include "volcal/identify/planning/rotary_positions.h"

namespace volcal {
namespace {

constexpr double kOnSphere = 5e-6;       // m: linear axes stand in whole micrometres
constexpr std::size_t kUsualGrid = 108;  // positions, where none are asked for

/// Spheres on the table that the tool stays on while all combinations of the rotary axes' positions are met:
/// an R-test (ISO 10791-6), or a touch probe that finds the centres.
class PlannedSphere : public PlanInstrument {
 public:
  explicit PlannedSphere(bool probed) : probed_(probed) {}

  std::string name() const override { return probed_ ? "probed-sphere" : "r-test"; }

  std::string study_kind() const override { return name(); }

  InstrumentWords words() const override {
    return {
        "sphere",
        "spheres",
        "Spheres, workpiece coordinates",
        "spheres may stand",
        "Checked: that the linear axes reach the sphere at every position of the rotary axes; not whether "
        "spindle, tool, table and the sphere's shank keep clear of each other.",
        "no tool stays on a sphere while the rotary axes turn: the linear axes do not reach it",
        "give --region-mm, where spheres may stand on the table, nearer to the rotary axes, or a shorter "
        "tool"};
  }

  std::vector<std::string> own_options() const override { return {"--turn-deg-s"}; }

  double usual_reading_time() const override { return probed_ ? 30.0 : 2.0; }

  void check(const PlanSettings& settings) const override { require_rotary_axes(settings.machine, name()); }

  bool turns_rotary_axes() const override { return true; }

  bool stays_at_its_place() const override { return true; }

  Eigen::AlignedBox3d region_w(const PlanScene& scene) const override {
    if (scene.settings.surroundings.stations_w) return *scene.settings.surroundings.stations_w;
    return rotary_region_w(scene.settings.machine, scene.swept);
  }

  bool can_stand(const PlanScene& scene, const Eigen::Vector3d& place_w) const override {
    if (!region_w(scene).contains(place_w)) return false;
    for (std::size_t tool = 0; tool < scene.settings.machine.tools.size(); ++tool) {
      if (scene.swept.position_at(place_w, tool)) return true;
    }
    return false;
  }

  bool reaches(const PlanScene& scene, const Eigen::Vector3d& place_w, const AxisPosition& position,
               std::size_t tool) const override {
    return (scene.swept.point_w(position, tool) - place_w).norm() <= kOnSphere &&
           scene.swept.position_at(place_w, tool, position).has_value();
  }

  std::vector<Eigen::Vector3d> textbook_places_w(const PlanScene& scene, int count) const override {
    return places_on_circle_w(region_w(scene), scene.swept.along_spindle(), count);
  }

  bool takes_runs_whole() const override { return false; }

  /// One run: a grid of all combinations of the rotary axes' positions, in path order.
  std::vector<PlanRun> candidate_runs(const PlanScene& scene, const Eigen::Vector3d& place_w,
                                      const PlanRun& at, const CandidateGrid& grid) const override {
    PlanRun run = at;
    run.positions = rotary_grid(scene.settings.machine, grid.positions > 0 ? grid.positions : kUsualGrid,
                                grid.jitter, scene.settings.seed, grid.stream);
    run = moved(scene, place_w, run);
    run.positions = in_path_order(std::move(run.positions));
    return {run};
  }

  /// The same rotary positions on the sphere's new place, those that the linear axes reach.
  PlanRun moved(const PlanScene& scene, const Eigen::Vector3d& place_w, const PlanRun& run) const override {
    PlanRun followed = run;
    followed.positions.clear();
    for (const PlanPosition& each : run.positions) {
      if (const auto position = scene.swept.position_at(place_w, run.tool, each.position))
        followed.positions.push_back({*position, each.cell});
    }
    return followed;
  }

  void describe(const PlanSettings& settings, const NamedPlace& place, Setup& setup) const override {
    setup.options.set("sphere", place.name);
    setup.has_noise = true;
    setup.noise.set("constant", settings.noise.constant);
    setup.repeatability = settings.noise.repeatability;
  }

  std::vector<double> nominal_reading(const Eigen::Vector3d& place_w,
                                      const Eigen::Vector3d& point_w) const override {
    const Eigen::Vector3d read = probed_ ? place_w : Eigen::Vector3d(point_w - place_w);
    return {read.x(), read.y(), read.z()};
  }

  /// The nominal tool point of the first reading is where the sphere stands.
  std::optional<NamedPlace> place_of(const Setup& setup, const Machine& machine) const override {
    if (setup.readings.size() == 0) return std::nullopt;
    AxisPosition position{};
    for (const Axis& axis : machine.axes)
      position[index_of(axis.name)] = setup.readings.position[index_of(axis.name)].front();
    const Eigen::Vector3d point_w =
        KinematicChain(machine).nominal_point_w(position, machine.tools[setup.tool].offset);
    return NamedPlace{setup.options.text("sphere").value_or(setup.name),
                      (point_w * 1e5).array().round() * 1e-5};
  }

 private:
  bool probed_;
};

}  // namespace

const PlanInstrument& planned_r_test() {
  static const PlannedSphere instrument(false);
  return instrument;
}

const PlanInstrument& planned_probed_sphere() {
  static const PlannedSphere instrument(true);
  return instrument;
}

}  // namespace volcal
