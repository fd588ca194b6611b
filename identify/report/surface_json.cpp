#include "volcal/identify/report/surface_json.h"

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/shown_variable.h"

namespace volcal::report {
namespace {

/// "y [mm]", "t [s]", "T_column [°C]", "c [°]".
std::string axis_title(const Variable& driver) {
  const std::string unit = shown_unit_of(driver);
  return driver.written() + (unit.empty() ? "" : " [" + unit + "]");
}

std::vector<double> entries(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

Json axes_json(const DrawnSurface& surface) {
  const SurfaceFigure& figure = surface.figure;
  Json axes = Json::array();
  for (std::size_t i = 0; i < figure.places.size(); ++i) {
    const Variable& driver = surface.values.drivers[i];
    axes.push_back(
        {{"title", axis_title(driver)},
         {"name", driver.written()},
         {"unit", shown_unit_of(driver)},
         {"places", rounded_array(figure.places[i], 1.0)},
         {"dots", i < figure.dots.size() ? rounded_array(figure.dots[i], 1.0, 4) : Json::array()}});
  }
  return axes;
}

}  // namespace

Json surface_json(const DrawnSurface& surface, double coverage_factor) {
  const SurfaceValues& values = surface.values;
  const double factor = 1.0 / values.si_per_unit;
  return {{"label", values.label},
          {"target", values.target},
          {"factor", values.factor},
          {"unit", shown_unit(values.unit)},
          {"axes", axes_json(surface)},
          {"value", rounded_array(entries(surface.figure.value), factor, 6)},
          {"U95", rounded_array(entries(surface.figure.u), coverage_factor * factor, 3)},
          {"largest", rounded(values.largest * factor, kDigitsBesideU)},
          {"largest_U95", rounded(coverage_factor * values.largest_u * factor, 2)},
          {"at", rounded_array(values.at, 1.0, 4)},
          {"third", values.drivers.size() > 2 ? Json(values.drivers[2].written()) : Json()},
          {"third_unit", values.drivers.size() > 2 ? Json(shown_unit_of(values.drivers[2])) : Json()},
          {"third_at", rounded(surface.figure.third, 4)},
          {"rms", rounded(values.rms * factor, 3)}};
}

}  // namespace volcal::report
