/// Heat map of the generic scan over pairs of recorded variables.

#include <algorithm>
#include <iterator>

#include "volcal/identify/report/numbers.h"

namespace volcal::report {
namespace {

/// Lower triangle, row by row.
Json map_rows(const Eigen::MatrixXd& map) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < map.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k <= i; ++k) row.push_back(rounded(map(i, k), 3));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Json generic_map_page(const DiagnosisInput& input) {
  const GenericMap& map = input.diagnosis.figures.generic;
  Json directions = Json::array();
  for (std::size_t d = 0; d < std::min(map.given.size(), std::size(kScanDirections)); ++d) {
    directions.push_back({{"name", kScanDirections[d]},
                          {"given", map_rows(map.given[d])},
                          {"reached", map_rows(map.reached[d])}});
  }
  return {{"variables", map.variables},
          {"threshold", rounded(log10_generic_risk(), 4)},
          {"tests", input.diagnosis.generic_tests},
          {"two_models", input.diagnosis.ladder.size() > 1},
          {"directions", std::move(directions)}};
}

}  // namespace volcal::report
