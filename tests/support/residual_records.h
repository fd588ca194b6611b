#pragma once
/// Residuals as a fit would leave them, from predictions given by hand.

#include <cstddef>
#include <functional>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal::testing {

/// Prediction by setup, row and reading.
using Predict = std::function<double(std::size_t setup, std::size_t row, double reading)>;

/// Of all readings, by setup, row and channel; sigma 1 um or 1 urad.
inline std::vector<ResidualRecord> records_of(const Campaign& campaign, const Predict& predict) {
  std::vector<ResidualRecord> records;
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const Readings& readings = campaign.setups[s].readings;
    for (std::size_t row = 0; row < readings.size(); ++row) {
      for (std::size_t channel = 0; channel < readings.channels(); ++channel) {
        ResidualRecord record;
        record.setup = s;
        record.row = row;
        record.channel = static_cast<int>(channel);
        record.reading = readings.value[channel][row];
        record.predicted = predict(s, row, record.reading);
        record.sigma = 1e-6;
        record.redundancy = 1.0;
        records.push_back(record);
      }
    }
  }
  return records;
}

/// Predictions are the readings times `share`.
inline std::vector<ResidualRecord> records_times(const Campaign& campaign, double share) {
  return records_of(campaign, [share](std::size_t, std::size_t, double reading) { return share * reading; });
}

}  // namespace volcal::testing
