#pragma once
/// Coverage intervals and numerical tolerances of GUM Supplement 1 (JCGM 101:2008).

#include <cstdint>
#include <span>

namespace volcal {

struct CoverageInterval {
  double low = 0.0;
  double high = 0.0;
};

/// A histogram of equal bins, values linear within a bin.
struct HistogramView {
  std::span<const std::uint32_t> counts;
  double first_edge = 0.0;
  double bin_width = 1.0;
  std::uint64_t total = 0;  ///< sum of the counts

  /// Value below which the share `probability` of the counts lies, 0..1; `total` must be positive.
  double quantile(double probability) const;
};

/// From the (1 - p) / 2 to the (1 + p) / 2 quantile (3.15, 7.7.2).
CoverageInterval symmetric_interval(const HistogramView& histogram, double probability);
/// The shortest interval that holds the share p (3.16, 7.7.4), its lower end at an edge of a bin; of several
/// equally short ones the first.
CoverageInterval shortest_interval(const HistogramView& histogram, double probability);

/// delta = 1/2 10^l where u = c 10^l with an integer c of `digits` decimal digits (7.9.2). u > 0.
double numerical_tolerance(double u, int digits);

}  // namespace volcal
