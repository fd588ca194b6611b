#include "volcal/identify/report/noise_rows.h"

#include "volcal/identify/words/noise_words.h"

namespace volcal::report {

Json noise_rows(const std::vector<NoiseRow>& rows, const std::vector<std::string>& instruments) {
  Json all = Json::array();
  for (const NoiseRow& row : rows) {
    const EdgeNoise edge = edge_noise(row, instruments[row.instrument]);
    all.push_back({{"instrument", instruments[row.instrument]},
                   {"term", row.term},
                   {"meaning", edge.meaning},
                   {"value", rounded(edge.value, 4)},
                   {"low", rounded(edge.low, 3)},
                   {"high", rounded(edge.high, 3)},
                   {"unit", shown_unit(edge.unit)},
                   {"likelihood_ratio", rounded(row.likelihood_ratio, 4)},
                   {"remark", row.remark}});
  }
  return all;
}

}  // namespace volcal::report
