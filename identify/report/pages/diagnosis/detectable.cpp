/// The smallest amplitude of every effect that these readings would have shown, or those of a plan would
/// show.

#include "volcal/identify/report/numbers.h"

namespace volcal::report {

namespace {

Json detectable_json(const std::vector<DetectableEffect>& effects, const std::string& when) {
  Json rows = Json::array();
  std::size_t not_visible = 0;
  for (const DetectableEffect& effect : effects) {
    if (!effect.visible) ++not_visible;
    rows.push_back({{"label", effect.label},
                    {"kind", effect.name.kind},
                    {"driver", effect.name.driver.name()},
                    {"shape", effect.shape_text.empty() ? effect.name.shape : effect.shape_text},
                    {"mdb", rounded(effect.mdb / effect.si_per_unit, 3)},
                    {"unit", shown_unit(effect.unit)},
                    {"visible", effect.visible},
                    {"visible_fraction", rounded(effect.visible_fraction, 3)},
                    {"volumetric_um", rounded(effect.volumetric * kPerMicro, 3)}});
  }
  return {{"when", when}, {"not_visible", not_visible}, {"rows", std::move(rows)}};
}

}  // namespace

Json detectable_page(const DiagnosisInput& input) {
  return detectable_json(input.diagnosis.detectable, "at the given model");
}

Json plan_detectable_page(const PlanPageInput& input) {
  return detectable_json(input.plan.plan.detectable, "with the readings of the plan and the noise assumed");
}

}  // namespace volcal::report
