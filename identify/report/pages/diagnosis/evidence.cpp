/// Ranked evidence at the model reached, with the threshold, and what was added on the way.

#include <algorithm>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"

namespace volcal::report {
namespace {

constexpr std::size_t kShown = 25;

Json list(const std::vector<EffectFinding>& effects) {
  Json json = Json::array();
  for (std::size_t i = 0; i < std::min(kShown, effects.size()); ++i) json.push_back(finding_json(effects[i]));
  return json;
}

Json asked_laws_json(const AskedLaws& asked) {
  Json rows = Json::array();
  for (const FormulaFinding& law : asked.laws) {
    Json& row = rows.emplace_back(law_json(law));
    row["gain"] = rounded(law.gain, 4);
    row["log10_p"] = rounded(law.log10_p, 4);
    row["log_evidence"] = rounded(law.log_evidence, 4);
  }
  return {{"label", asked.label},
          {"tried", asked.tried},
          {"sufficient", asked.sufficient()},
          {"surface_evidence", rounded(asked.surface_evidence, 4)},
          {"rows", std::move(rows)}};
}

}  // namespace

Json evidence_page(const DiagnosisInput& input) {
  const Diagnosis& diagnosis = input.diagnosis;
  std::vector<EffectFinding> added = diagnosis.effects;
  added.insert(added.end(), diagnosis.model_changes.begin(), diagnosis.model_changes.end());
  Json alternatives = Json::array();
  for (const auto* set : sets_of_alternatives(diagnosis)) alternatives.push_back(list(*set));
  Json asked = Json::array();
  for (const AskedLaws& each : diagnosis.asked_laws) asked.push_back(asked_laws_json(each));
  return {{"threshold", rounded(log10_family_risk(), 4)},
          {"families", diagnosis.families},
          {"added", list(added)},
          {"alternatives", std::move(alternatives)},
          {"own", list(diagnosis.tried)},
          {"laws", std::move(asked)},
          {"ranking", list(diagnosis.ranking)}};
}

}  // namespace volcal::report
