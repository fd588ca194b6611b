#pragma once
/// What a Monte Carlo study keeps of its draws: for every quantity sums and a histogram of t = (y - y^) / u,
/// u the standard uncertainty by linear propagation. Memory does not grow with the draws: 16 kB a quantity.
/// Counts are integers, so that they do not depend on the order in which draws come; sums are made batch by
/// batch and joined in the order of the batches.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "volcal/identify/montecarlo/coverage_interval.h"

namespace volcal {

inline constexpr double kCoverageProbability = 0.95;
/// Bins over +-kHistogramReach u; the outer ones take what lies beyond. A quantile from bins of 0.004 u is
/// exact to far less than its scatter in 10^6 draws, 0.003 u.
inline constexpr std::size_t kHistogramBins = 4096;
inline constexpr double kHistogramReach = 8.0;

/// Sums of t and t^2 of a share of the draws, per quantity.
struct Moments {
  explicit Moments(std::size_t quantities = 0)
      : sum(Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(quantities))), squares(sum) {}
  std::uint64_t draws = 0;
  Eigen::ArrayXd sum;
  Eigen::ArrayXd squares;

  /// Of columns of t, draws x quantities.
  static Moments of(const Eigen::Ref<const Eigen::ArrayXXd>& t);
  void add(const Moments& other);
};

/// Counts of t, quantities x bins.
class Histograms {
 public:
  explicit Histograms(std::size_t quantities = 0) : counts_(quantities * kHistogramBins, 0) {}
  /// Columns of t, draws x quantities.
  void add(const Eigen::Ref<const Eigen::ArrayXXd>& t);
  void add(const Histograms& other);
  void clear() { counts_.assign(counts_.size(), 0); }
  /// `draws`: how many were added.
  HistogramView of(std::size_t quantity, std::uint64_t draws) const;
  std::span<const std::uint32_t> counts() const { return counts_; }
  std::span<std::uint32_t> counts() { return counts_; }

 private:
  std::vector<std::uint32_t> counts_;
};

/// The four figures whose scatter over sequences of draws says how well they are known (7.9.4 b).
enum class Figure { Mean, Deviation, Low, High };
inline constexpr Eigen::Index kFigures = 4;

/// All draws of a study so far. Draws come in blocks, in their order; every kSequence of them make a sequence
/// whose figures are kept apart.
class StudySums {
 public:
  /// Draws of a sequence: M of 7.9.4 a), at least 100 / (1 - p) and 10^4.
  static constexpr std::uint64_t kSequence = 10000;
  /// sqrt(p (1 - p)) / density of a normal end at p = 0.025
  static constexpr double kEndScatter = 2.67;

  explicit StudySums(std::size_t quantities);
  void add(const Moments& moments, const Histograms& counts);

  std::size_t quantities() const { return static_cast<std::size_t>(total_.sum.size()); }
  std::uint64_t draws() const { return total_.draws; }
  std::uint64_t sequences() const { return sequences_; }
  double mean(std::size_t quantity) const;
  /// Standard deviation.
  double deviation(std::size_t quantity) const;
  HistogramView histogram(std::size_t quantity) const { return counts_.of(quantity, total_.draws); }
  /// Standard deviation of a figure over all draws, from its scatter over the sequences; infinite for fewer
  /// than two.
  double standard_error(std::size_t quantity, Figure figure) const;
  /// The larger of the two ends'; for fewer than two sequences by normal theory, where draws scatter as
  /// linear propagation says at least: a few say little of their own scatter.
  double end_error(std::size_t quantity) const;
  /// The same, and not below normal theory for a few sequences, whose scatter may be small by chance.
  double largest_end_error(std::size_t quantity) const;

  /// The state in plain arrays: what a checkpoint holds.
  template <class Visit>
  void visit_state(Visit&& visit) {
    visit(total_.draws);
    visit(open_.draws);
    visit(sequences_);
    visit(total_.sum);
    visit(total_.squares);
    visit(open_.sum);
    visit(open_.squares);
    visit(figure_sum_);
    visit(figure_squares_);
    visit(counts_.counts());
    visit(open_counts_.counts());
  }

 private:
  void close_sequence();
  double end_error_by_normal_theory(std::size_t quantity) const;

  Moments total_;
  Histograms counts_;
  Moments open_;  ///< of the sequence that is being filled
  Histograms open_counts_;
  std::uint64_t sequences_ = 0;
  Eigen::ArrayXd figure_sum_;  ///< quantities x kFigures
  Eigen::ArrayXd figure_squares_;
};

}  // namespace volcal
