/// Noise of every instrument by restricted maximum likelihood.

#include "volcal/identify/report/noise_rows.h"

namespace volcal::report {

Json noise_model_page(const DiagnosisInput& input) {
  return {{"rows", noise_rows(input.diagnosis.noise, input.diagnosis.noise_instruments)},
          {"removed_readings", input.diagnosis.removed_readings.size()}};
}

}  // namespace volcal::report
