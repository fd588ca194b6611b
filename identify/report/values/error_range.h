#pragma once
/// An identified error in a line, as tables of results show it.

#include <cmath>
#include <vector>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/result/result.h"

namespace volcal::report {

/// Values of an error where it was measured, SI; NaN where nothing was.
struct ErrorRange {
  double low = std::nan(""), high = std::nan("");
  double expanded = std::nan("");  ///< largest U95

  double magnitude() const { return std::fmax(std::abs(low), std::abs(high)); }
};

/// `table`: error_table() of the result.
ErrorRange error_range(const FitResult& result, const std::vector<ErrorTableRow>& table,
                       const Observability& error);

/// Whether an error is an amplitude of an effect, and no error motion or squareness.
bool is_amplitude(const FitResult& result, const Observability& error);

}  // namespace volcal::report
