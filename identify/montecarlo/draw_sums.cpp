#include "volcal/identify/montecarlo/draw_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace volcal {
namespace {

constexpr double kBinsPerUnit = static_cast<double>(kHistogramBins) / (2.0 * kHistogramReach);

double standard_deviation(double sum, double squares, std::uint64_t draws) {
  const auto n = static_cast<double>(draws);
  return draws < 2 ? 0.0 : std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1.0)));
}

}  // namespace

Moments Moments::of(const Eigen::Ref<const Eigen::ArrayXXd>& t) {
  Moments moments;
  moments.draws = static_cast<std::uint64_t>(t.rows());
  moments.sum = t.colwise().sum().transpose();
  moments.squares = t.square().colwise().sum().transpose();
  return moments;
}

void Moments::add(const Moments& other) {
  draws += other.draws;
  sum += other.sum;
  squares += other.squares;
}

void Histograms::add(const Eigen::Ref<const Eigen::ArrayXXd>& t) {
  constexpr double kLast = static_cast<double>(kHistogramBins) - 1.0;
  std::uint32_t* counts = counts_.data();
  for (Eigen::Index quantity = 0; quantity < t.cols(); ++quantity, counts += kHistogramBins) {
    const double* const value = t.col(quantity).data();
    for (Eigen::Index draw = 0; draw < t.rows(); ++draw) {
      const double bin = std::min(std::max((value[draw] + kHistogramReach) * kBinsPerUnit, 0.0), kLast);
      ++counts[static_cast<int>(bin)];
    }
  }
}

void Histograms::add(const Histograms& other) {
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
}

HistogramView Histograms::of(std::size_t quantity, std::uint64_t draws) const {
  return {std::span(counts_).subspan(quantity * kHistogramBins, kHistogramBins), -kHistogramReach,
          1.0 / kBinsPerUnit, draws};
}

StudySums::StudySums(std::size_t quantities)
    : total_(quantities),
      counts_(quantities),
      open_(quantities),
      open_counts_(quantities),
      figure_sum_(Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(quantities) * kFigures)),
      figure_squares_(figure_sum_) {}

void StudySums::add(const Moments& moments, const Histograms& counts) {
  total_.add(moments);
  counts_.add(counts);
  open_.add(moments);
  open_counts_.add(counts);
  if (open_.draws >= kSequence) close_sequence();
}

void StudySums::close_sequence() {
  const auto n = static_cast<double>(open_.draws);
  for (std::size_t quantity = 0; quantity < quantities(); ++quantity) {
    const auto index = static_cast<Eigen::Index>(quantity);
    const CoverageInterval interval =
        symmetric_interval(open_counts_.of(quantity, open_.draws), kCoverageProbability);
    const double figures[kFigures] = {open_.sum[index] / n,
                                      standard_deviation(open_.sum[index], open_.squares[index], open_.draws),
                                      interval.low, interval.high};
    for (Eigen::Index k = 0; k < kFigures; ++k) {
      figure_sum_[index * kFigures + k] += figures[k];
      figure_squares_[index * kFigures + k] += figures[k] * figures[k];
    }
  }
  ++sequences_;
  open_ = Moments(quantities());
  open_counts_.clear();
}

double StudySums::mean(std::size_t quantity) const {
  return total_.sum[static_cast<Eigen::Index>(quantity)] / static_cast<double>(total_.draws);
}

double StudySums::deviation(std::size_t quantity) const {
  const auto index = static_cast<Eigen::Index>(quantity);
  return standard_deviation(total_.sum[index], total_.squares[index], total_.draws);
}

double StudySums::standard_error(std::size_t quantity, Figure figure) const {
  if (sequences_ < 2) return std::numeric_limits<double>::infinity();
  const Eigen::Index index =
      static_cast<Eigen::Index>(quantity) * kFigures + static_cast<Eigen::Index>(figure);
  return standard_deviation(figure_sum_[index], figure_squares_[index], sequences_) /
         std::sqrt(static_cast<double>(sequences_));
}

double StudySums::end_error_by_normal_theory(std::size_t quantity) const {
  return kEndScatter * std::max(1.0, deviation(quantity)) / std::sqrt(static_cast<double>(draws()));
}

double StudySums::end_error(std::size_t quantity) const {
  if (sequences_ < 2) return end_error_by_normal_theory(quantity);
  return std::max(standard_error(quantity, Figure::Low), standard_error(quantity, Figure::High));
}

double StudySums::largest_end_error(std::size_t quantity) const {
  constexpr std::uint64_t kManySequences = 10;
  if (sequences_ >= kManySequences) return end_error(quantity);
  return std::max(end_error(quantity), end_error_by_normal_theory(quantity));
}

}  // namespace volcal
