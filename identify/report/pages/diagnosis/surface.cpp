/// A surface or curve that was drawn for what has no name: values, cuts, readings and laws.

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/surface_json.h"
#include "volcal/identify/result/result.h"

namespace volcal::report {
namespace {

DrawnSurface drawn(const SurfaceFinding& surface) {
  SurfaceValues values;
  values.label = surface.label;
  values.target = surface.name.target.name();
  values.factor = surface.spec.options.text("factor").value_or("");
  values.drivers = surface.drivers;
  values.unit = surface.unit;
  values.si_per_unit = surface.si_per_unit;
  values.rms = surface.rms;
  values.largest = surface.largest;
  values.largest_u = surface.largest_u;
  values.at = surface.at;
  return {std::move(values), surface.figure};
}

}  // namespace

Json surface_json(const SurfaceFinding& surface) {
  Json formulas = Json::array();
  for (const FormulaFinding& formula : surface.formulas) formulas.push_back(law_json(formula));
  Json json = surface_json(drawn(surface), kCoverageFactor);
  json["log_evidence"] = rounded(surface.log_evidence, 3);
  json["effective_parameters"] = rounded(surface.effective_parameters, 2);
  json["formulas"] = std::move(formulas);
  json["free"] = surface.free;
  return json;
}

}  // namespace volcal::report
