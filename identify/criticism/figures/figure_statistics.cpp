#include "volcal/identify/criticism/figures/figure_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "volcal/identify/criticism/projection/score_statistics.h"

namespace volcal {
namespace {

constexpr int kLags[] = {1, 2, 3, 4, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 224, 320};
constexpr std::size_t kFewestPairs = 30;
constexpr double kFeltShare = 0.03;

/// Observations of a sequence that are not left out, in the order of time: places within the sequence.
std::vector<std::size_t> in_order(const NoiseData& data, const NoiseSequence& sequence) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
    if (std::isfinite(data.sigma[sequence.observation[k]])) order.push_back(k);
  }
  if (!sequence.time.empty())
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return sequence.time[k]; });
  return order;
}

double influence_on(const Eigen::VectorXd& felt, std::size_t observation) {
  return felt.size() == 0 ? 1.0 : felt[static_cast<Eigen::Index>(observation)];
}

double length_of(const NoiseData& data, std::size_t observation) {
  return data.length.empty() ? 0.0 : data.length[observation];
}

double independent_variance(const NoiseData& data, const NoiseParameters& noise, std::size_t observation) {
  const double white = noise.white * data.sigma[observation];
  const double long_part = noise.per_metre * length_of(data, observation);
  return white * white + long_part * long_part;
}

/// Covariance of two observations of a sequence.
double covariance(const NoiseSequence& sequence, const NoiseParameters& noise, std::size_t a, std::size_t b) {
  double sum = 0.0;
  if (!sequence.time.empty()) {
    sum += noise.drift * noise.drift * std::exp(-std::abs(sequence.time[a] - sequence.time[b]) / noise.tau);
  }
  if (!sequence.line.empty() && sequence.line[a] == sequence.line[b]) sum += noise.line * noise.line;
  return sum;
}

/// Sums over pairs of one lag.
struct LagSums {
  std::size_t pairs = 0;
  double gap = 0.0, residual = 0.0, expected = 0.0, whitened = 0.0;
};

}  // namespace

std::vector<int> equal_bins(const Eigen::VectorXd& abscissa, int count) {
  std::vector<int> bin(static_cast<std::size_t>(abscissa.size()), -1);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double x : abscissa) {
    if (std::isnan(x)) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  for (std::size_t i = 0; i < bin.size(); ++i) {
    const double x = abscissa[static_cast<Eigen::Index>(i)];
    if (std::isnan(x)) continue;
    bin[i] = high > low ? std::min(count - 1, static_cast<int>(count * (x - low) / (high - low))) : 0;
  }
  return bin;
}

/// The sum of e^(-|t_i - t_j| / tau) over the pairs of a bin follows, in the order of time, from that of the
/// pairs before.
std::vector<double> mean_variance(const NoiseData& data, std::span<const NoiseParameters> noise,
                                  const std::vector<int>& bin, int count, const Eigen::VectorXd& felt) {
  const auto bins = static_cast<std::size_t>(count);
  std::vector<double> sum(bins, 0.0), squares(bins, 0.0);
  for (const NoiseSequence& sequence : data.sequences) {
    const NoiseParameters& part = noise[sequence.group];
    std::vector<double> memory(bins, 0.0), last(bins, 0.0);
    std::map<std::pair<std::int32_t, std::size_t>, double> of_line;
    for (const std::size_t k : in_order(data, sequence)) {
      const std::size_t i = sequence.observation[k];
      if (bin[i] < 0) continue;
      const auto b = static_cast<std::size_t>(bin[i]);
      const double weight = influence_on(felt, i);
      squares[b] += weight * weight;
      sum[b] += weight * weight * independent_variance(data, part, i);
      if (!sequence.time.empty() && part.drift > 0.0) {
        memory[b] *= std::exp(-(sequence.time[k] - last[b]) / part.tau);
        sum[b] += part.drift * part.drift * weight * (weight + 2.0 * memory[b]);
        memory[b] += weight;
        last[b] = sequence.time[k];
      }
      if (!sequence.line.empty() && part.line > 0.0) of_line[{sequence.line[k], b}] += weight;
    }
    for (const auto& [place, n] : of_line) sum[place.second] += part.line * part.line * n * n;
  }
  for (std::size_t b = 0; b < bins; ++b) sum[b] = squares[b] > 0.0 ? sum[b] / (squares[b] * squares[b]) : 0.0;
  return sum;
}

BinnedMean binned_mean(const Eigen::VectorXd& abscissa, const Eigen::VectorXd& value,
                       const std::vector<int>& bin, const std::vector<double>& variance,
                       const Eigen::VectorXd& felt) {
  const std::size_t bins = variance.size();
  std::vector<double> x(bins, 0.0), y(bins, 0.0), squares(bins, 0.0);
  std::vector<std::size_t> n(bins, 0);
  for (std::size_t i = 0; i < bin.size(); ++i) {
    if (bin[i] < 0) continue;
    const auto b = static_cast<std::size_t>(bin[i]);
    const double weight = influence_on(felt, i);
    x[b] += abscissa[static_cast<Eigen::Index>(i)];
    y[b] += weight * value[static_cast<Eigen::Index>(i)];
    squares[b] += weight * weight;
    ++n[b];
  }
  BinnedMean means;
  for (std::size_t b = 0; b < bins; ++b) {
    const auto count = static_cast<double>(n[b]);
    if (n[b] == 0 || squares[b] < kFeltShare * kFeltShare * count) continue;
    means.centre.push_back(x[b] / count);
    means.mean.push_back(y[b] / squares[b]);
    means.noise.push_back(std::sqrt(variance[b]));
    means.count.push_back(n[b]);
  }
  return means;
}

Autocorrelation autocorrelation(const NoiseData& data, std::span<const NoiseParameters> noise,
                                std::size_t group, const Eigen::VectorXd& residual,
                                const Eigen::VectorXd& whitened) {
  const NoiseParameters& part = noise[group];
  std::vector<LagSums> sums(std::size(kLags));
  double count = 0.0, residual_squares = 0.0, whitened_squares = 0.0;
  for (const NoiseSequence& sequence : data.sequences) {
    if (sequence.group != group) continue;
    const std::vector<std::size_t> order = in_order(data, sequence);
    std::vector<double> deviation, scaled, white;
    for (const std::size_t k : order) {
      const std::size_t i = sequence.observation[k];
      deviation.push_back(
          std::sqrt(independent_variance(data, part, i) + part.drift * part.drift + part.line * part.line));
      scaled.push_back(residual[static_cast<Eigen::Index>(i)] / deviation.back());
      white.push_back(whitened[static_cast<Eigen::Index>(i)]);
      residual_squares += scaled.back() * scaled.back();
      whitened_squares += white.back() * white.back();
      count += 1.0;
    }
    for (std::size_t l = 0; l < sums.size(); ++l) {
      const auto lag = static_cast<std::size_t>(kLags[l]);
      for (std::size_t k = 0; k + lag < order.size(); ++k) {
        ++sums[l].pairs;
        sums[l].residual += scaled[k] * scaled[k + lag];
        sums[l].whitened += white[k] * white[k + lag];
        sums[l].expected +=
            covariance(sequence, part, order[k], order[k + lag]) / (deviation[k] * deviation[k + lag]);
        sums[l].gap += sequence.time.empty() ? std::numeric_limits<double>::quiet_NaN()
                                             : sequence.time[order[k + lag]] - sequence.time[order[k]];
      }
    }
  }
  Autocorrelation out;
  out.group = group;
  for (std::size_t l = 0; l < sums.size(); ++l) {
    if (sums[l].pairs < kFewestPairs) continue;
    const auto pairs = static_cast<double>(sums[l].pairs);
    out.lag.push_back(kLags[l]);
    out.pairs.push_back(sums[l].pairs);
    out.gap.push_back(sums[l].gap / pairs);
    out.residual.push_back(sums[l].residual / pairs / (residual_squares / count));
    out.expected.push_back(sums[l].expected / pairs);
    out.whitened.push_back(sums[l].whitened / pairs / (whitened_squares / count));
  }
  return out;
}

Eigen::VectorXd left_over(const NoiseProblem& problem, std::span<const Eigen::MatrixXd> accepted,
                          const Eigen::VectorXd& column, const Eigen::VectorXd& parameters) {
  Eigen::Index at = problem.jacobian.cols();
  Eigen::VectorXd left = column - problem.jacobian * parameters.head(at);
  for (const Eigen::MatrixXd& columns : accepted) {
    left -= columns * parameters.segment(at, columns.cols());
    at += columns.cols();
  }
  return left;
}

PartialRegression partial_regression(const NoiseProblem& problem, const NoiseData& data,
                                     std::span<const NoiseParameters> noise, const Projector& rest,
                                     std::span<const Eigen::MatrixXd> accepted,
                                     const Eigen::MatrixXd& candidate) {
  const ScoreTest test = score_test(rest.project(candidate), 0, candidate.cols());
  const double size = test.amplitude.norm();
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(candidate.cols());
  if (candidate.cols() > 1 && size > 0.0) {
    direction = test.amplitude / size;
  } else {
    direction[0] = 1.0;
  }
  const Eigen::VectorXd driver = candidate * direction;
  const Whitener whitener(data, noise);
  PartialRegression partial;
  partial.driver = whitener.whiten(left_over(problem, accepted, driver, rest.imitation(driver)));
  partial.residual = whitener.whiten(left_over(problem, accepted, problem.residual, rest.solution()));
  partial.slope = direction.dot(test.amplitude);
  partial.u = std::sqrt(std::max(0.0, direction.dot(test.covariance * direction)));
  return partial;
}

}  // namespace volcal
