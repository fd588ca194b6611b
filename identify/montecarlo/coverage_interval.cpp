#include "volcal/identify/montecarlo/coverage_interval.h"

#include <cmath>
#include <cstddef>

namespace volcal {
namespace {

/// Walks up a histogram; targets must not fall.
class QuantileWalk {
 public:
  explicit QuantileWalk(const HistogramView& histogram) : histogram_(histogram) {}

  double at(double target) {
    while (bin_ + 1 < histogram_.counts.size() &&
           below_ + static_cast<double>(histogram_.counts[bin_]) < target) {
      below_ += static_cast<double>(histogram_.counts[bin_++]);
    }
    const auto own = static_cast<double>(histogram_.counts[bin_]);
    const double share = own > 0.0 ? (target - below_) / own : 0.0;
    return histogram_.first_edge + histogram_.bin_width * (static_cast<double>(bin_) + share);
  }

 private:
  const HistogramView& histogram_;
  std::size_t bin_ = 0;
  double below_ = 0.0;
};

}  // namespace

double HistogramView::quantile(double probability) const {
  return QuantileWalk(*this).at(probability * static_cast<double>(total));
}

CoverageInterval symmetric_interval(const HistogramView& histogram, double probability) {
  return {histogram.quantile(0.5 - 0.5 * probability), histogram.quantile(0.5 + 0.5 * probability)};
}

CoverageInterval shortest_interval(const HistogramView& histogram, double probability) {
  const auto total = static_cast<double>(histogram.total);
  const double inside = probability * total;
  QuantileWalk upper(histogram);
  CoverageInterval shortest = symmetric_interval(histogram, probability);
  double below = 0.0;
  for (std::size_t bin = 0; bin < histogram.counts.size() && below + inside <= total; ++bin) {
    const double low = histogram.first_edge + histogram.bin_width * static_cast<double>(bin);
    const double high = upper.at(below + inside);
    if (histogram.counts[bin] > 0 && high - low < shortest.high - shortest.low) shortest = {low, high};
    below += static_cast<double>(histogram.counts[bin]);
  }
  return shortest;
}

double numerical_tolerance(double u, int digits) {
  const int exponent = static_cast<int>(std::floor(std::log10(u))) - (digits - 1);
  const double unit = std::pow(10.0, exponent);
  const bool rounds_up_a_digit = std::round(u / unit) >= std::pow(10.0, digits);
  return 0.5 * (rounds_up_a_digit ? 10.0 * unit : unit);
}

}  // namespace volcal
