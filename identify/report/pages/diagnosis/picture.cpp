/// What was found first, alone: surface, curve, or added-variable plot.

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {

Json picture_page(const DiagnosisInput& input) {
  const Diagnosis& diagnosis = input.diagnosis;
  const std::vector<std::string> words = sentences(diagnosis.findings);
  return {{"words", words.empty() ? "" : words.front()},
          {"surface", diagnosis.surfaces.empty() ? Json() : surface_json(diagnosis.surfaces.front())},
          {"added_variable", diagnosis.surfaces.empty() ? added_variable_page(input) : Json()}};
}

}  // namespace volcal::report
