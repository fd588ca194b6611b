#pragma once
/// Terms of a noise model as the reports' tables show them.

#include "volcal/identify/report/numbers.h"

namespace volcal::report {

/// One entry per row: instrument, term, its meaning, value and 95 % interval at edge units, likelihood ratio,
/// remark.
Json noise_rows(const std::vector<NoiseRow>& rows, const std::vector<std::string>& instruments);

}  // namespace volcal::report
