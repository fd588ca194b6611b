/// Surfaces and curves of the model: effects without a formula, drawn from the readings alone.

#include "volcal/identify/report/surface_json.h"

namespace volcal::report {

Json surfaces_page(const PageInput& input) {
  Json surfaces = Json::array();
  for (const DrawnSurface& surface : drawn_surfaces(input.result, input.campaign))
    surfaces.push_back(surface_json(surface, input.result.coverage_factor));
  if (surfaces.empty()) return {};
  return {{"surfaces", std::move(surfaces)}};
}

}  // namespace volcal::report
