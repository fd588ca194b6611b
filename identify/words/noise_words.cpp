#include "volcal/identify/words/noise_words.h"

#include "volcal/model/description/units.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

std::string meaning(const std::string& term) {
  if (term == "white") return "independent, times the stated sigma";
  if (term == "wander") return "correlated drift";
  if (term == "tau") return "correlation time of the drift";
  if (term == "line") return "offset that the readings of a line share";
  return "independent, in proportion to length";
}

std::string unit_of(const NoiseRow& row, const std::string& instrument) {
  if (row.unit == "m or rad") return noise_group_unit(instrument);
  if (row.unit == "m/m") return "um/m";
  return row.unit == "1" ? "" : row.unit;
}

}  // namespace

EdgeNoise edge_noise(const NoiseRow& row, const std::string& instrument) {
  const double si = row.unit == "m or rad" || row.unit == "m/m" ? kMicro : 1.0;
  return {row.value / si, row.low / si, row.high / si, unit_of(row, instrument), meaning(row.term)};
}

}  // namespace volcal
