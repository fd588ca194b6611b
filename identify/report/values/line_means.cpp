#include "volcal/identify/report/values/line_means.h"

#include <algorithm>
#include <cmath>

namespace volcal::report {

void LineMean::add(double value, double sigma, std::size_t setup, std::int64_t line) {
  Sum& own = lines_[{setup, line}];
  own.value += value;
  own.count += 1.0;
  ++count_;
  sum_ += value;
  squares_ += value * value;
  variances_ += sigma * sigma;
}

double LineMean::mean() const { return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_); }

double LineMean::rms() const { return count_ == 0 ? 0.0 : std::sqrt(squares_ / static_cast<double>(count_)); }

double LineMean::standard_u() const {
  if (count_ == 0) return 0.0;
  const double here = mean();
  double between = 0.0;
  for (const auto& [line, own] : lines_) between += std::pow(own.value - own.count * here, 2);
  const auto lines = static_cast<double>(lines_.size());
  if (lines > 1.0) between *= lines / (lines - 1.0);
  return std::sqrt(std::max(variances_, between)) / static_cast<double>(count_);
}

}  // namespace volcal::report
