/// Heat map of the generic scan over pairs of recorded variables.

#include <algorithm>
#include <iterator>

#include "volcal/identify/criticism/data/scan_direction.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/report/numbers.h"

namespace volcal::report {
namespace {

constexpr int kDigits = 3;  // of -log10 p

}  // namespace

Json generic_map_page(const DiagnosisInput& input) {
  const GenericMap& map = input.diagnosis.figures.generic;
  Json directions = Json::array();
  for (std::size_t d = 0; d < std::min(map.given.size(), kScanDirections.size()); ++d) {
    directions.push_back({{"name", name_of(kScanDirections[d])},
                          {"given", rounded_triangle(map.given[d], kDigits, true)},
                          {"reached", rounded_triangle(map.reached[d], kDigits, true)}});
  }
  return {{"variables", map.variables},
          {"threshold", rounded(log10_scan_risk(), 4)},
          {"tests", input.diagnosis.generic_tests},
          {"two_models", input.diagnosis.ladder.size() > 1},
          {"directions", std::move(directions)}};
}

}  // namespace volcal::report
