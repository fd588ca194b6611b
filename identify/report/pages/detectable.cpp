/// The smallest amplitude of every effect that these readings would have shown.

#include "volcal/identify/report/numbers.h"

namespace volcal::report {

Json detectable_page(const DiagnosisInput& input) {
  Json rows = Json::array();
  std::size_t not_visible = 0;
  for (const DetectableEffect& effect : input.diagnosis.detectable) {
    if (!effect.visible) ++not_visible;
    rows.push_back({{"label", effect.label},
                    {"kind", effect.name.kind},
                    {"driver", effect.name.driver},
                    {"shape", effect.shape_text.empty() ? effect.name.shape : effect.shape_text},
                    {"mdb", rounded(effect.mdb / effect.si_per_unit, 3)},
                    {"unit", shown_unit(effect.unit)},
                    {"visible", effect.visible},
                    {"visible_fraction", rounded(effect.visible_fraction, 3)},
                    {"volumetric_um", rounded(effect.volumetric * kPerMicro, 3)}});
  }
  return {{"not_visible", not_visible}, {"rows", std::move(rows)}};
}

}  // namespace volcal::report
