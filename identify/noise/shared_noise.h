#pragma once
/// What the observations of a sequence share: the correlated drift and the offsets of lines (noise_model.h),
/// that is Sigma without what each reading has on its own.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "volcal/identify/noise/noise_model.h"

namespace volcal {

class SharedNoise {
 public:
  SharedNoise(const NoiseSequence& sequence, const NoiseParameters& noise);

  /// Nothing is shared: neither correlated drift nor offsets, or times and lines are not known.
  bool none() const { return drift_ == 0.0 && offset_ == 0.0; }
  /// Covariance of two observations of the sequence by what they share, and of one with itself.
  double covariance(std::size_t i, std::size_t j) const;
  /// Row i: sum over j of covariance(i, j) weights[observation of j], i in the order of the sequence. O(n).
  /// `weights`: per observation of the data.
  Eigen::VectorXd times(const Eigen::VectorXd& weights) const;

 private:
  const NoiseSequence& sequence_;
  double drift_;  ///< variances
  double offset_;
  double tau_;
  std::vector<std::size_t> order_;  ///< by time
  std::vector<std::size_t> line_;   ///< 0, 1 ... in the order of their first observation
  std::size_t lines_ = 0;
};

}  // namespace volcal
