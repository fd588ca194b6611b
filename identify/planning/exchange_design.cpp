#include "volcal/identify/planning/exchange_design.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

constexpr double kLeastGain = 1e-6;      // of the criterion, below which rounds of single pairs end
constexpr double kSurelyBetter = 1e-12;  // of the criterion: more than rounding
constexpr Eigen::Index kBlockRows = 512;
constexpr Eigen::Index kSmallProblem = 32;  // parameters: every pair is cheap
constexpr std::size_t kPairsOfSmallProblem = 64;
constexpr std::size_t kPairs = 3;
constexpr std::size_t kFirstShare = 4;  // of the design is exchanged at once at first

class Exchange {
 public:
  Exchange(const DesignPool& pool, const Eigen::MatrixXd& base, const DesignCriterion& criterion,
           std::size_t count, const ExchangeOptions& options)
      : pool_(pool), base_(base), criterion_(criterion), options_(options) {
    use_single_threaded_blas();
    check(count);
    result_.taken = even_start(count);
  }

  ExchangeResult run() {
    information_ = information_of(result_.taken);
    renew();
    std::size_t batch = std::max<std::size_t>(1, total() / kFirstShare);
    for (int round = 0; round < options_.most_rounds && !result_.converged; ++round) {
      if (options_.progress) options_.progress(static_cast<double>(round) / options_.most_rounds);
      const double before = result_.value;
      if (batch > 1) {
        if (!exchange(batch)) batch /= 2;
      } else {
        const bool exchanged = exchange(1) || exchange_best_pair();
        result_.converged = !exchanged || before - result_.value < kLeastGain * before;
      }
    }
    return std::move(result_);
  }

 private:
  void check(std::size_t count) const {
    if (pool_.rows.cols() != base_.cols() || pool_.first.empty() || pool_.first.back() != pool_.rows.rows()) {
      throw std::invalid_argument("exchange_design: sizes do not agree");
    }
    if (count > pool_.candidates() * static_cast<std::size_t>(pool_.capacity)) {
      throw std::invalid_argument("exchange_design: the pool has too few candidates");
    }
    if (!options_.kept.empty() && options_.kept.size() != pool_.candidates()) {
      throw std::invalid_argument("exchange_design: what is kept is not of this pool");
    }
  }

  int kept(std::size_t candidate) const { return options_.kept.empty() ? 0 : options_.kept[candidate]; }

  std::vector<int> even_start(std::size_t count) const {
    const std::size_t size = pool_.candidates();
    std::vector<int> taken = options_.kept.empty() ? std::vector<int>(size, 0) : options_.kept;
    const auto already = static_cast<std::size_t>(std::accumulate(taken.begin(), taken.end(), 0));
    const std::size_t more = count - std::min(count, already);
    for (std::size_t k = 0; k < more; ++k) {
      std::size_t at = (2 * k + 1) * size / (2 * more) % size;
      while (taken[at] >= pool_.capacity) at = (at + 1) % size;
      ++taken[at];
    }
    return taken;
  }

  std::size_t total() const {
    return static_cast<std::size_t>(std::accumulate(result_.taken.begin(), result_.taken.end(), 0));
  }

  Eigen::Index width(std::size_t candidate) const {
    return pool_.first[candidate + 1] - pool_.first[candidate];
  }

  /// Of candidates, each with a factor; in their order.
  Eigen::MatrixXd weighted_rows(const std::vector<std::pair<std::size_t, double>>& candidates) const {
    Eigen::Index rows = 0;
    for (const auto& [candidate, factor] : candidates) rows += width(candidate);
    Eigen::MatrixXd all(rows, pool_.rows.cols());
    Eigen::Index at = 0;
    for (const auto& [candidate, factor] : candidates) {
      all.middleRows(at, width(candidate)) =
          std::sqrt(factor) * pool_.rows.middleRows(pool_.first[candidate], width(candidate));
      at += width(candidate);
    }
    return all;
  }

  Eigen::MatrixXd information_of(const std::vector<int>& taken) const {
    std::vector<std::pair<std::size_t, double>> candidates;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      if (taken[i] > 0) candidates.emplace_back(i, taken[i]);
    }
    Eigen::MatrixXd information = base_;
    add_gram_upper(weighted_rows(candidates), 1.0, information);
    return information;
  }

  void renew() {
    auto state = criterion_.state(information_);
    if (!state) throw std::invalid_argument("exchange_design: what is known does not make up for the design");
    state_ = std::move(*state);
    result_.value = state_.value;
  }

  /// Per candidate: rate of gain g = |R^T j|^2 and leverage h = j^T C j, summed over its observations.
  void find_rates() {
    const Eigen::Index count = pool_.rows.rows();
    Eigen::VectorXd gain(count), leverage(count);
    const Eigen::Index blocks = (count + kBlockRows - 1) / kBlockRows;
    run_parallel(static_cast<std::size_t>(blocks), options_.threads, [&](std::size_t block) {
      const Eigen::Index first = static_cast<Eigen::Index>(block) * kBlockRows;
      const Eigen::Index rows = std::min(kBlockRows, count - first);
      const auto own = pool_.rows.middleRows(first, rows);
      gain.segment(first, rows) = product(own, state_.root).rowwise().squaredNorm();
      leverage.segment(first, rows) = product(own, state_.covariance).cwiseProduct(own).rowwise().sum();
    });
    gain_.assign(pool_.candidates(), 0.0);
    loss_.assign(pool_.candidates(), 0.0);
    for (std::size_t i = 0; i < pool_.candidates(); ++i) {
      for (Eigen::Index k = pool_.first[i]; k < pool_.first[i + 1]; ++k) {
        gain_[i] += gain[k] / (1.0 + leverage[k]);
        loss_[i] += gain[k] / std::max(1e-9, 1.0 - leverage[k]);
      }
    }
  }

  /// Candidates that can leave, those that help least first, and that can come, those that help most first.
  void rank_candidates() {
    find_rates();
    inside_.clear();
    outside_.clear();
    for (std::size_t i = 0; i < pool_.candidates(); ++i) {
      if (result_.taken[i] > kept(i)) inside_.push_back(i);
      if (result_.taken[i] < pool_.capacity) outside_.push_back(i);
    }
    std::ranges::stable_sort(inside_, {}, [&](std::size_t i) { return loss_[i]; });
    std::ranges::stable_sort(outside_, std::ranges::greater{}, [&](std::size_t i) { return gain_[i]; });
  }

  using Candidates = std::vector<std::pair<std::size_t, double>>;

  std::optional<double> value_after(const Candidates& leaving, const Candidates& coming) const {
    Eigen::MatrixXd trial = information_;
    add_gram_upper(weighted_rows(coming), 1.0, trial);
    add_gram_upper(weighted_rows(leaving), -1.0, trial);
    const auto value = criterion_.value(trial);
    if (!value || !(*value < result_.value * (1.0 - kSurelyBetter))) return std::nullopt;
    return value;
  }

  void take(const Candidates& leaving, const Candidates& coming) {
    for (std::size_t k = 0; k < leaving.size(); ++k) {
      --result_.taken[leaving[k].first];
      ++result_.taken[coming[k].first];
    }
    result_.exchanges += static_cast<int>(leaving.size());
    information_ = information_of(result_.taken);
    renew();
  }

  /// Exchanges up to `batch` pairs by their rates; false when that does not help, and nothing has changed.
  bool exchange(std::size_t batch) {
    rank_candidates();
    Candidates leaving, coming;
    for (std::size_t k = 0; k < std::min({batch, inside_.size(), outside_.size()}); ++k) {
      if (inside_[k] == outside_[k] || gain_[outside_[k]] <= loss_[inside_[k]]) break;
      leaving.emplace_back(inside_[k], 1.0);
      coming.emplace_back(outside_[k], 1.0);
    }
    if (leaving.empty() || !value_after(leaving, coming)) return false;
    take(leaving, coming);
    return true;
  }

  /// The best of the most promising pairs, each by its own value; false when none helps.
  bool exchange_best_pair() {
    rank_candidates();
    const std::size_t most = information_.rows() <= kSmallProblem ? kPairsOfSmallProblem : kPairs;
    double best = std::numeric_limits<double>::infinity();
    Candidates leaving, coming;
    for (std::size_t i = 0; i < std::min(most, inside_.size()); ++i) {
      for (std::size_t k = 0; k < std::min(most, outside_.size()); ++k) {
        if (inside_[i] == outside_[k]) continue;
        const auto value = value_after({{inside_[i], 1.0}}, {{outside_[k], 1.0}});
        if (!value || *value >= best) continue;
        best = *value;
        leaving = {{inside_[i], 1.0}};
        coming = {{outside_[k], 1.0}};
      }
    }
    if (leaving.empty()) return false;
    take(leaving, coming);
    return true;
  }

  const DesignPool& pool_;
  const Eigen::MatrixXd& base_;
  const DesignCriterion& criterion_;
  const ExchangeOptions& options_;
  ExchangeResult result_;
  Eigen::MatrixXd information_;
  DesignCriterion::State state_;
  std::vector<std::size_t> inside_;
  std::vector<std::size_t> outside_;
  std::vector<double> gain_;
  std::vector<double> loss_;
};

}  // namespace

ExchangeResult exchange_design(const DesignPool& pool, const Eigen::MatrixXd& base,
                               const DesignCriterion& criterion, std::size_t count,
                               const ExchangeOptions& options) {
  return Exchange(pool, base, criterion, count, options).run();
}

}  // namespace volcal
