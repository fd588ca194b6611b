#include "volcal/identify/noise/shared_noise.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace volcal {

SharedNoise::SharedNoise(const NoiseSequence& sequence, const NoiseParameters& noise)
    : sequence_(sequence),
      drift_(sequence.time.empty() ? 0.0 : noise.drift * noise.drift),
      offset_(sequence.line.empty() ? 0.0 : noise.line * noise.line),
      tau_(noise.tau),
      order_(sequence.observation.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!sequence.time.empty()) {
    std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return sequence.time[i]; });
  }
  std::map<std::int32_t, std::size_t> places;
  for (const std::int32_t line : sequence.line)
    line_.push_back(places.try_emplace(line, places.size()).first->second);
  lines_ = places.size();
}

double SharedNoise::covariance(std::size_t i, std::size_t j) const {
  double value = 0.0;
  if (drift_ > 0.0) value += drift_ * std::exp(-std::abs(sequence_.time[i] - sequence_.time[j]) / tau_);
  if (offset_ > 0.0 && line_[i] == line_[j]) value += offset_;
  return value;
}

/// The correlated drift by two sums that decay with time, one from either end.
Eigen::VectorXd SharedNoise::times(const Eigen::VectorXd& weights) const {
  const auto& observation = sequence_.observation;
  const auto weight = [&](std::size_t i) { return weights[static_cast<Eigen::Index>(observation[i])]; };
  Eigen::VectorXd product = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(observation.size()));
  const auto pass = [&](const std::vector<std::size_t>& order, bool own) {
    double sum = 0.0, last = order.empty() ? 0.0 : sequence_.time[order.front()];
    for (const std::size_t i : order) {
      sum *= std::exp(-std::abs(sequence_.time[i] - last) / tau_);
      last = sequence_.time[i];
      product[static_cast<Eigen::Index>(i)] += drift_ * (own ? sum + weight(i) : sum);
      sum += weight(i);
    }
  };
  if (drift_ > 0.0) {
    pass(order_, true);
    pass({order_.rbegin(), order_.rend()}, false);
  }
  if (offset_ > 0.0) {
    std::vector<double> sums(lines_, 0.0);
    for (std::size_t i = 0; i < line_.size(); ++i) sums[line_[i]] += weight(i);
    for (std::size_t i = 0; i < line_.size(); ++i)
      product[static_cast<Eigen::Index>(i)] += offset_ * sums[line_[i]];
  }
  return product;
}

}  // namespace volcal
