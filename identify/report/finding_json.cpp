#include "volcal/identify/report/finding_json.h"

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/effects/registry.h"

namespace volcal::report {
Json finding_json(const EffectFinding& effect) {
  Json amplitudes = Json::array();
  for (const AmplitudeFigure& each : effect.amplitudes) {
    amplitudes.push_back({{"label", each.label},
                          {"value", rounded(each.value / each.si_per_unit, kDigitsBesideU)},
                          {"U95", rounded(kCoverageFactor * each.u / each.si_per_unit, 3)},
                          {"mdb", rounded(each.mdb / each.si_per_unit, 3)},
                          {"unit", shown_unit(each.unit)}});
  }
  return {{"label", effect.label},
          {"kind", effect.name.kind},
          {"driver", effect.name.driver.name()},
          {"shape", effect.shape_text.empty() ? effect.name.shape : effect.shape_text},
          {"log10_p", rounded(effect.log10_p, 4)},
          {"visible_fraction", rounded(effect.visible_fraction, 3)},
          {"resolution", effect.resolution},
          {"amplitudes", std::move(amplitudes)}};
}

Json meaning_json(const EffectName& name) {
  const EffectKind* kind = find_effect(name.kind);
  if (kind == nullptr) return {{"plain", ""}, {"usual_causes", ""}};
  const EffectSchema& schema = kind->schema();
  return {{"plain", schema.plain.empty() ? schema.summary : schema.plain},
          {"usual_causes", schema.usual_causes}};
}

Json law_json(const FormulaFinding& law) {
  return {{"label", law.label},
          {"shape", law.shape_text},
          {"amplitude", rounded(law.amplitude / law.si_per_unit, 4)},
          {"U95", rounded(kCoverageFactor * law.u / law.si_per_unit, 2)},
          {"unit", shown_unit(law.unit)}};
}

Json binned_json(const BinnedMean& means, double centre_factor, double value_factor) {
  return {{"centre", rounded_array(means.centre, centre_factor, 5)},
          {"mean", rounded_array(means.mean, value_factor, 4)},
          {"noise", rounded_array(means.noise, value_factor, 3)},
          {"count", means.count}};
}

}  // namespace volcal::report
