/// Autocorrelation of the residuals, before and after the filter of the noise model.

#include <algorithm>
#include <cmath>

#include "volcal/identify/report/numbers.h"

namespace volcal::report {

Json autocorrelation_page(const DiagnosisInput& input) {
  Json instruments = Json::array();
  for (const Autocorrelation& one : input.diagnosis.figures.autocorrelation) {
    Json band = Json::array();
    for (const std::size_t pairs : one.pairs)
      band.push_back(rounded(2.0 / std::sqrt(static_cast<double>(pairs)), 3));
    instruments.push_back({{"instrument", input.diagnosis.noise_instruments[one.group]},
                           {"lag", one.lag},
                           {"gap_s", rounded_array(one.gap, 1.0, 4)},
                           {"pairs", one.pairs},
                           {"band", std::move(band)},
                           {"residual", rounded_array(one.residual, 1.0, 4)},
                           {"expected", rounded_array(one.expected, 1.0, 4)},
                           {"whitened", rounded_array(one.whitened, 1.0, 4)}});
  }
  return {{"instruments", std::move(instruments)}};
}

}  // namespace volcal::report
