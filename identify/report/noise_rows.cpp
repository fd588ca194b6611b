#include "volcal/identify/report/noise_rows.h"

namespace volcal::report {
namespace {

std::string meaning(const std::string& term) {
  if (term == "white") return "independent, times the stated σ";
  if (term == "wander") return "slow wander";
  if (term == "tau") return "correlation time of the wander";
  if (term == "line") return "offset that the readings of a line share";
  return "independent, proportional to length";
}

}  // namespace

Json noise_rows(const std::vector<NoiseRow>& rows, const std::vector<std::string>& instruments) {
  Json all = Json::array();
  for (const NoiseRow& row : rows) {
    const bool is_length = row.unit == "m or rad" || row.unit == "m/m";
    const double factor = is_length ? kPerMicro : 1.0;
    all.push_back({{"instrument", instruments[row.instrument]},
                   {"term", row.term},
                   {"meaning", meaning(row.term)},
                   {"value", rounded(row.value * factor, 4)},
                   {"low", rounded(row.low * factor, 3)},
                   {"high", rounded(row.high * factor, 3)},
                   {"unit", row.unit == "m or rad" ? "µm or µrad"
                            : row.unit == "m/m"    ? "µm/m"
                            : row.unit == "1"      ? ""
                                                   : row.unit},
                   {"likelihood_ratio", rounded(row.likelihood_ratio, 4)},
                   {"remark", row.remark}});
  }
  return all;
}

}  // namespace volcal::report
