/// Rotary axes of the compared models that were identified.

#include "volcal/identify/report/page.h"
#include "volcal/identify/report/rotary_json.h"

namespace volcal::report {

Json compared_rotary_axes_page(const ComparisonInput& input) {
  Json models = Json::array();
  for (const ComparedModel& model : input.models) {
    if (!model.rotary) continue;
    models.push_back(rotary_json(*model.rotary));
    models.back()["name"] = model.name;
  }
  if (models.empty()) return nullptr;
  return {{"models", std::move(models)}};
}

}  // namespace volcal::report
