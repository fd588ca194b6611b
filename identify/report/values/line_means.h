#pragma once
/// Means of residuals that share something, with what they may be off by chance.

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

namespace volcal::report {

/// One mean over readings of several measured lines. Its standard deviation is that of independent readings,
/// or what the scatter between the lines says where that is more (Liang and Zeger 1986, Biometrika 73, 13:
/// sums of deviations over clusters): drift and offsets of lines move all readings of a line together.
class LineMean {
 public:
  /// `sigma`: standard deviation of the value; `setup` and `line` say what is read together.
  void add(double value, double sigma, std::size_t setup, std::int64_t line);

  std::size_t count() const { return count_; }
  double mean() const;        ///< 0 without readings
  double rms() const;         ///< 0 without readings
  double standard_u() const;  ///< of the mean; 0 without readings

 private:
  struct Sum {
    double value = 0.0;
    double count = 0.0;
  };
  std::map<std::pair<std::size_t, std::int64_t>, Sum> lines_;
  std::size_t count_ = 0;
  double sum_ = 0.0;
  double squares_ = 0.0;
  double variances_ = 0.0;
};

}  // namespace volcal::report
