/// A surface or curve that was drawn for what has no name: values, cuts and readings.

#include <cmath>

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/shown_variable.h"
#include "volcal/identify/result/result.h"

namespace volcal::report {
namespace {

/// "y [mm]", "t [s]", "T_column [°C]", "c [°]".
std::string axis_title(const Variable& driver) {
  const std::string unit = shown_unit_of(driver);
  return driver.written() + (unit.empty() ? "" : " [" + unit + "]");
}

std::vector<double> entries(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

}  // namespace

Json surface_json(const SurfaceFinding& surface) {
  const double factor = 1.0 / surface.si_per_unit;
  Json axes = Json::array();
  for (std::size_t i = 0; i < surface.figure.places.size(); ++i) {
    axes.push_back({{"title", axis_title(surface.drivers[i])},
                    {"name", surface.drivers[i].written()},
                    {"places", rounded_array(surface.figure.places[i], 1.0)},
                    {"dots", i < surface.figure.dots.size() ? rounded_array(surface.figure.dots[i], 1.0, 4)
                                                            : Json::array()}});
  }
  Json formulas = Json::array();
  for (const FormulaFinding& formula : surface.formulas) {
    formulas.push_back({{"label", formula.label},
                        {"shape", formula.shape_text},
                        {"amplitude", rounded(formula.amplitude / formula.si_per_unit, 4)},
                        {"U95", rounded(kCoverageFactor * formula.u / formula.si_per_unit, 2)},
                        {"unit", shown_unit(formula.unit)}});
  }
  return {{"label", surface.label},
          {"target", surface.name.target},
          {"factor", surface.spec.options.text("factor").value_or("")},
          {"unit", shown_unit(surface.unit)},
          {"axes", std::move(axes)},
          {"value", rounded_array(entries(surface.figure.value), factor, 4)},
          {"U95", rounded_array(entries(surface.figure.u), kCoverageFactor * factor, 3)},
          {"largest", rounded(surface.largest * factor, 4)},
          {"largest_U95", rounded(kCoverageFactor * surface.largest_u * factor, 2)},
          {"at", rounded_array(surface.at, 1.0, 4)},
          {"third", surface.drivers.size() > 2 ? Json(surface.drivers[2].written()) : Json()},
          {"third_at", rounded(surface.figure.third, 4)},
          {"log_evidence", rounded(surface.log_evidence, 3)},
          {"rms", rounded(surface.rms * factor, 3)},
          {"effective_parameters", rounded(surface.effective_parameters, 2)},
          {"formulas", std::move(formulas)},
          {"free", surface.free}};
}

}  // namespace volcal::report
