/// Causes of the error in the volume, found effects and error motions, ranked.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/units.h"

namespace volcal::report {

Json volume_causes_page(const DiagnosisInput& input) {
  if (input.causes == nullptr || input.causes->causes.empty()) return nullptr;
  Json rows = Json::array();
  for (const VolumeCause& cause : input.causes->causes) {
    rows.push_back({{"name", cause.name},
                    {"found", cause.found},
                    {"rms_um", rounded(cause.rms * kPerMicro, 3)},
                    {"U95_um", cause.u ? rounded(kCoverageFactor * *cause.u * kPerMicro, 2) : Json()},
                    {"share", rounded(cause.share, 4)}});
  }
  return {{"tool", input.causes->tool},
          {"total_um", rounded(input.causes->total_rms * kPerMicro, 4)},
          {"rows", std::move(rows)},
          {"not_in_volume", input.causes->not_in_volume}};
}

}  // namespace volcal::report
