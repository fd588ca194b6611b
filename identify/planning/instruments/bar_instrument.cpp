#include "volcal/identify/planning/instruments/bar_instrument.h"

#include <cmath>
#include <utility>

#include "volcal/model/description/errors.h"

namespace volcal {

void BarInstrument::check(const PlanSettings& settings) const {
  if (settings.bar.length > kHalfStroke) return;
  throw InputError({}, "the length of the ball-bar is missing", "give --bar-mm, between the ball centres");
}

InstrumentWords BarInstrument::words_of_bar(std::string checked, std::string unreached, std::string remedy) {
  return {"place",
          "places",
          "Places of the centre ball, workpiece coordinates",
          "centre balls may stand",
          std::move(checked),
          std::move(unreached),
          std::move(remedy)};
}

bool BarInstrument::can_stand(const PlanScene& scene, const Eigen::Vector3d& place_w) const {
  return region_w(scene).contains(place_w);
}

bool BarInstrument::reaches(const PlanScene& scene, const Eigen::Vector3d& place_w,
                            const AxisPosition& position, std::size_t tool) const {
  const double length = (scene.swept.point_w(position, tool) - place_w).norm();
  return std::abs(length - scene.settings.bar.length) <= kHalfStroke &&
         scene.swept.passes_spindle(place_w, position, tool);
}

PlanRun BarInstrument::moved(const PlanScene& scene, const Eigen::Vector3d& place_w,
                             const PlanRun& run) const {
  for (const PlanRun& each : candidate_runs(scene, place_w, run, {})) {
    if (each.part == run.part) return each;
  }
  PlanRun lost = run;
  lost.positions.clear();
  return lost;
}

void BarInstrument::describe(const PlanSettings& settings, const NamedPlace& place, Setup& setup) const {
  setup.options.set("centre", place.place_w);
  if (settings.bar.length_sigma) setup.options.set("length_sigma", *settings.bar.length_sigma);
  setup.has_noise = true;
  setup.noise.set("constant", settings.noise.constant);
  setup.noise.set("per_metre", settings.noise.per_metre);
  setup.repeatability = settings.noise.repeatability;
}

std::vector<double> BarInstrument::nominal_reading(const Eigen::Vector3d& place_w,
                                                   const Eigen::Vector3d& point_w) const {
  return {(point_w - place_w).norm()};
}

std::optional<NamedPlace> BarInstrument::place_of(const Setup& setup, const Machine& machine) const {
  const auto place_w = setup.options.vector("centre");
  if (!place_w) return std::nullopt;
  const std::string tool = "_" + machine.tools[setup.tool].name + "_";
  const std::size_t place_ends = setup.name.rfind(tool);
  const std::string part = place_ends == std::string::npos ? "" : setup.name.substr(place_ends + tool.size());
  return NamedPlace{setup.name.substr(0, place_ends), *place_w, part};
}

}  // namespace volcal
