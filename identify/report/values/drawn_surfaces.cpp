#include "volcal/identify/report/values/drawn_surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "volcal/identify/statistics/even_sample.h"
#include "volcal/identify/text/uncertain_number.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/functions/drawn_places.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/campaign_binding.h"

namespace volcal::report {
namespace {

constexpr std::size_t kMostDots = 1500;
constexpr std::size_t kDrawnDrivers = 2;

using Dots = std::vector<std::vector<double>>;  // per driver

/// Where the surface acts on readings of a setup.
void add_dots(const SurfaceValues& surface, const SetupView& view, Dots& dots) {
  const Eigen::MatrixXd rows = surface.effect->drivers(view, surface.effect->shape_values());
  if (rows.isZero(0.0)) return;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    const Eigen::VectorXd values = *recorded_variable(view, surface.drivers[i]);
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      if (!rows.row(row).isZero(0.0)) dots[i].push_back(values[row]);
    }
  }
}

Dots thinned(const Dots& dots) {
  Dots few(dots.size());
  for (const std::size_t i : even_sample(dots.front().size(), kMostDots)) {
    for (std::size_t driver = 0; driver < dots.size(); ++driver) few[driver].push_back(dots[driver][i]);
  }
  return few;
}

SurfaceFigure figure_of(const SurfaceValues& surface, const FitResult& result) {
  const std::vector<double>& at = surface.at;
  DrawnPlaces drawn = drawn_places(*surface.effect->surface(),
                                   at.size() > kDrawnDrivers ? std::optional(at.back()) : std::nullopt);
  SurfaceFigure figure;
  figure.third = drawn.third;
  figure.value = drawn.rows * result.parameters.segment(surface.offset, drawn.rows.cols());
  figure.u = uncertainty_of_values(result, surface, drawn.rows);
  figure.places = std::move(drawn.axes);
  return figure;
}

bool has_length(const SurfaceValues& surface) {
  return std::ranges::any_of(surface.drivers,
                             [](const Variable& driver) { return driver.kind == Variable::Kind::Length; });
}

/// With the lengths to the stations, which the campaign has to be bound for.
std::vector<SetupView> measured_views(const FitResult& result, const Campaign& campaign) {
  ModelSpec without_effects = result.identified;
  without_effects.effects.clear();
  const KinematicChain chain(campaign.machine);
  return setup_views(campaign, bind_campaign(campaign, without_effects, chain), chain);
}

std::vector<SetupView> recorded_views(const Campaign& campaign) {
  const double first_time = time_span(campaign).first;
  std::vector<SetupView> views;
  for (const Setup& setup : campaign.setups) {
    SetupView view{campaign, setup, {}, {}};
    view.clock_start = first_time;
    views.push_back(std::move(view));
  }
  return views;
}

void add_dots(const std::vector<SetupView>& views, DrawnSurface& surface) {
  Dots dots(std::min(kDrawnDrivers, surface.values.drivers.size()));
  for (const SetupView& view : views) add_dots(surface.values, view, dots);
  surface.figure.dots = thinned(dots);
}

}  // namespace

std::vector<DrawnSurface> drawn_surfaces(const FitResult& result, const Campaign& campaign) {
  std::vector<DrawnSurface> surfaces;
  for (SurfaceValues& values : surface_values(result)) {
    SurfaceFigure figure = figure_of(values, result);
    surfaces.push_back({std::move(values), std::move(figure)});
  }
  if (surfaces.empty() || !result.alignment.empty()) return surfaces;
  const std::vector<SetupView> recorded = recorded_views(campaign);
  for (DrawnSurface& surface : surfaces)
    add_dots(has_length(surface.values) ? measured_views(result, campaign) : recorded, surface);
  return surfaces;
}

std::string surface_line(const SurfaceValues& surface, double coverage_factor) {
  return fmt::format("{}: up to {} {} at {}", surface.label,
                     value_with_u(surface.largest / surface.si_per_unit,
                                  coverage_factor * surface.largest_u / surface.si_per_unit),
                     surface.unit, surface.place_words());
}

}  // namespace volcal::report
