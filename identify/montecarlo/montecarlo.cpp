#include "volcal/identify/montecarlo/montecarlo.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/montecarlo/draw_projection.h"
#include "volcal/identify/montecarlo/idle_pool.h"
#include "volcal/identify/montecarlo/path_solvers.h"
#include "volcal/identify/montecarlo/state_bytes.h"
#include "volcal/identify/numeric/content_hash.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr double kMostForecast = 1e15;  // draws: nobody makes more

/// Draws between two looks at the sums, and of them those that one thread makes at a time.
struct BlockSize {
  std::uint64_t block;
  std::uint64_t batch;
};

/// A block is a whole part of StudySums::kSequence, so that a study can end with it.
BlockSize block_size(DrawPath path) {
  if (path == DrawPath::Linear) return {10000, 250};
  if (path == DrawPath::Chord) return {1250, std::uint64_t{4} * DrawGradients::kDraws};
  return {100, 2};
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void add(const Eigen::Ref<const Eigen::MatrixXd>& values, ContentHash& hash) {
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    for (Eigen::Index row = 0; row < values.rows(); ++row) hash.add(values(row, column));
  }
}

}  // namespace

DrawPath draw_path(const std::string& word) {
  for (const DrawPath path : {DrawPath::Automatic, DrawPath::Linear, DrawPath::Chord, DrawPath::Refit}) {
    if (to_string(path) == word) return path;
  }
  throw InputError({}, "path \"" + word + "\" is not known", "choose one of auto, linear, chord, refit");
}

FunctionRoughness function_roughness(const std::string& word) {
  if (word == "drawn") return FunctionRoughness::Drawn;
  if (word == "fixed") return FunctionRoughness::Fixed;
  throw InputError({}, "functions \"" + word + "\" is not known", "choose \"drawn\" or \"fixed\"");
}

std::string_view to_string(DrawPath path) {
  switch (path) {
    case DrawPath::Automatic:
      return "auto";
    case DrawPath::Linear:
      return "linear";
    case DrawPath::Chord:
      return "chord";
    case DrawPath::Refit:
      return "refit";
  }
  return "";
}

std::string_view to_string(LinearVerdict verdict) {
  switch (verdict) {
    case LinearVerdict::Validated:
      return "validated";
    case LinearVerdict::Undecided:
      return "undecided";
    case LinearVerdict::NotValidated:
      return "not validated";
  }
  return "";
}

/// The conditions that a study's values hold for, and what is to be said of them.
struct StatedOfStudy {
  std::vector<StatedCondition> conditions;
  std::vector<Finding> findings;
};

namespace {

StatedOfStudy stated_of_study(const FitResult& result, const MonteCarloOptions& options) {
  const Conditions conditions = options.conditions ? *options.conditions : default_conditions(result);
  StatedOfStudy stated{acting_conditions(result, conditions), conditions_in_vain(result, conditions)};
  std::ranges::move(conditions_beyond_readings(result, conditions), std::back_inserter(stated.findings));
  return stated;
}

}  // namespace

class MonteCarloStudy::Work {
 public:
  Work(const Campaign& campaign, const FitResult& result, MonteCarloOptions options)
      : options_(std::move(options)),
        threads_(thread_count(options_.threads)),
        repeated_(campaign, result, options_.sources),
        set_(quantities_of(result, options_.grid_per_axis, options_.conditions)),
        projection_(repeated_, set_),
        solvers_(repeated_),
        contradicted_(contradictions(result)),
        stated_(stated_of_study(result, options_)),
        sums_(set_.items.size()),
        tolerance_(projection_.quantities()) {
    for (Eigen::Index i = 0; i < tolerance_.size(); ++i)
      tolerance_[i] = tolerance_of(static_cast<std::size_t>(i), projection_.unit()[i]);
    check_paths();
    path_ = options_.path == DrawPath::Automatic ? supported_path() : options_.path;
    require_same_numbers();
  }

  void run_block() {
    BlockShare block = draw_share();
    if (options_.team != nullptr)
      block = joined(options_.team->gather(bytes_of(block)), block.moments.size());
    for (std::size_t batch = 1; batch < block.moments.size(); ++batch)
      block.moments[0].add(block.moments[batch]);
    sums_.add(block.moments[0], *block.counts);
    tally_.add(block.tally);
    block.counts->clear();
    histograms_.give_back(std::move(block.counts));
  }

  bool settled() const {
    for (std::size_t i = 0; i < set_.items.size(); ++i) {
      if (!(scatter(i) < tolerance_of_draws(i))) return false;
    }
    return true;
  }

  bool done() const {
    if (options_.draws > 0) return sums_.draws() >= options_.draws;
    if (sums_.draws() >= options_.most_draws) return true;
    return sums_.draws() % StudySums::kSequence == 0 && sums_.sequences() >= 2 && settled();
  }

  std::uint64_t expected_draws() const {
    return options_.draws > 0 ? options_.draws : std::min(options_.most_draws, draws_to_settle());
  }

  /// By the scatter so far, of the first by normal theory; as many as that takes.
  std::uint64_t draws_to_settle() const {
    if (sums_.sequences() < 2) return to_settle_by_normal_theory();
    double worst = 0.0;
    for (std::size_t i = 0; i < set_.items.size(); ++i)
      worst = std::max(worst, scatter(i) / tolerance_of_draws(i));
    return whole_sequences(static_cast<double>(sums_.draws()) * std::max(1.0, worst * worst));
  }

  MonteCarloResult result() const {
    MonteCarloResult result;
    result.path = path_;
    result.functions = options_.sources.functions;
    for (const Disturbance& each : options_.sources.disturbances) result.disturbances.push_back(each.words);
    result.draws = sums_.draws();
    result.seed = options_.seed;
    result.digits = options_.digits;
    result.adaptive = options_.draws == 0;
    result.settled = sums_.sequences() >= 2 && settled();
    result.would_settle = result.adaptive ? draws_to_settle() : 0;
    result.most_draws = result.adaptive ? options_.most_draws : 0;
    result.check = check_;
    result.steps = tally_.steps;
    result.refitted = tally_.refitted;
    result.not_converged = tally_.not_converged;
    result.to_come = tally_.to_come;
    for (std::size_t i = 0; i < set_.items.size(); ++i) result.quantities.push_back(quantity_result(i));
    result.budget = uncertainty_budget(repeated_, set_);
    result.conditions = stated_.conditions;
    result.condition_findings = stated_.findings;
    result.contradicted = contradicted_;
    return result;
  }

  std::uint64_t fingerprint() const {
    ContentHash hash;
    add(repeated_.identified(), hash);
    add(repeated_.predicted(), hash);
    add(repeated_.gain(), hash);
    add(projection_.linear_factor(), hash);
    add(repeated_.response(), hash);
    add(projection_.unit().matrix(), hash);
    hash.add(options_.seed);
    hash.add(static_cast<std::uint64_t>(path_));
    hash.add(static_cast<std::uint64_t>(options_.sources.functions));
    if (options_.conditions) add(set_.rows, hash);
    return hash.value();
  }

  std::string save() {
    StateWriter writer;
    visit(writer);
    return writer.take();
  }

  void restore(const std::string& state) {
    StateReader reader(state);
    visit(reader);
    if (!reader.at_end()) throw std::invalid_argument("the state is longer than the study's");
  }

  DrawPath path() const { return path_; }
  std::uint64_t draws() const { return sums_.draws(); }

 private:
  template <class Visit>
  void visit(Visit& visit) {
    sums_.visit_state(visit);
    visit(tally_.steps);
    visit(tally_.refitted);
    visit(tally_.not_converged);
    visit(tally_.to_come);
  }

  /// Of the batches of a block, those of one rank or of all; moments of others are empty.
  struct BlockShare {
    std::vector<Moments> moments;  ///< by batch
    std::unique_ptr<Histograms> counts;
    SolverTally tally;

    /// Batches of `rank` in plain arrays.
    template <class Visit>
    void visit(std::size_t rank, std::size_t ranks, Visit& each) {
      for (std::size_t batch = rank; batch < moments.size(); batch += ranks) {
        each(moments[batch].draws);
        each(moments[batch].sum);
        each(moments[batch].squares);
      }
      each(counts->counts());
      each(tally.steps);
      each(tally.refitted);
      each(tally.not_converged);
      each(tally.to_come);
    }
  };

  std::size_t rank() const { return options_.team == nullptr ? 0 : options_.team->rank(); }
  std::size_t ranks() const { return options_.team == nullptr ? 1 : options_.team->size(); }
  std::unique_ptr<Histograms> empty_histograms() {
    return histograms_.take([this] { return std::make_unique<Histograms>(set_.items.size()); });
  }

  /// This rank's batches of the next block.
  BlockShare draw_share() {
    const BlockSize size = block_size(path_);
    const std::uint64_t of_batch = size.batch;
    std::uint64_t count = size.block - sums_.draws() % size.block;
    count = std::min(count, (options_.draws > 0 ? options_.draws : options_.most_draws) - sums_.draws());
    const auto batches = static_cast<std::size_t>((count + of_batch - 1) / of_batch);
    BlockShare share{std::vector<Moments>(batches, Moments(set_.items.size())), nullptr, {}};
    std::mutex counting;
    const std::uint64_t first = sums_.draws();
    const std::size_t own = batches > rank() ? (batches - rank() + ranks() - 1) / ranks() : 0;
    run_parallel(own, threads_, [&](std::size_t k) {
      const std::size_t batch = rank() + k * ranks();
      const std::uint64_t from = batch * of_batch;
      SolverTally tally;
      const Eigen::MatrixXd t =
          draw_batch(first + from, static_cast<Eigen::Index>(std::min(of_batch, count - from)), tally);
      share.moments[batch] = Moments::of(t.array());
      auto counts = empty_histograms();
      counts->add(t.array());
      histograms_.give_back(std::move(counts));
      const std::lock_guard lock(counting);
      share.tally.add(tally);
    });
    share.counts = empty_histograms();
    for (const auto& counts : histograms_.idle()) {
      share.counts->add(*counts);
      counts->clear();
    }
    return share;
  }

  std::string bytes_of(BlockShare& share) const {
    StateWriter writer;
    share.visit(rank(), ranks(), writer);
    return writer.take();
  }

  BlockShare joined(const std::vector<std::string>& shares, std::size_t batches) {
    BlockShare block{std::vector<Moments>(batches, Moments(set_.items.size())), empty_histograms(), {}};
    BlockShare one{block.moments, std::make_unique<Histograms>(set_.items.size()), {}};
    for (std::size_t from = 0; from < shares.size(); ++from) {
      StateReader reader(shares[from]);
      one.visit(from, shares.size(), reader);
      for (std::size_t batch = from; batch < batches; batch += shares.size())
        block.moments[batch] = one.moments[batch];
      block.counts->add(*one.counts);
      block.tally.add(one.tally);
    }
    return block;
  }

  /// Ranks on unlike processors would draw from unlike machines.
  void require_same_numbers() const {
    if (options_.team == nullptr) return;
    const std::string own = std::to_string(fingerprint());
    const std::vector<std::string> all = options_.team->gather(own);
    const auto other = std::ranges::find_if(all, [&](const std::string& each) { return each != all[0]; });
    if (other == all.end()) return;
    throw InputError({},
                     "rank " + std::to_string(other - all.begin()) + " computes other numbers than rank 0",
                     "start all ranks with the same program and files, on processors of one kind");
  }

  Eigen::MatrixXd draw_batch(std::uint64_t first, Eigen::Index count, SolverTally& tally) {
    if (path_ == DrawPath::Linear) return projection_.of_linear_draws(options_.seed, first, count);
    const std::vector<CampaignDraw> draws = draws_from(first, count);
    Eigen::MatrixXd deviations =
        path_ == DrawPath::Chord ? solvers_.by_chord(draws, tally) : solvers_.by_refit(draws, tally);
    return projection_.of(with_roughness(std::move(deviations), draws));
  }

  std::vector<CampaignDraw> draws_from(std::uint64_t first, Eigen::Index count) const {
    return repeated_.draws(options_.seed, first, count);
  }

  static Eigen::MatrixXd with_roughness(Eigen::MatrixXd deviations, const std::vector<CampaignDraw>& draws) {
    for (std::size_t k = 0; k < draws.size(); ++k)
      deviations.col(static_cast<Eigen::Index>(k)) += draws[k].roughness;
    return deviations;
  }

  /// The first draws of the study by all three paths.
  void check_paths() {
    const int count = options_.refits;
    if (count <= 0) return;
    const std::vector<CampaignDraw> draws = draws_from(0, count);
    SolverTally chord_tally, refit_tally;
    auto start = std::chrono::steady_clock::now();
    const Eigen::MatrixXd linear = repeated_.linear_estimates(draws);
    check_.linear.seconds = seconds_since(start) / count;
    start = std::chrono::steady_clock::now();
    const Eigen::MatrixXd chord = solvers_.by_chord(draws, chord_tally);
    check_.chord.seconds = seconds_since(start) / count;
    Eigen::MatrixXd refits(repeated_.parameters(), count);
    std::vector<SolverTally> tallies(static_cast<std::size_t>(count));
    run_parallel(static_cast<std::size_t>(count), threads_, [&](std::size_t k) {
      refits.col(static_cast<Eigen::Index>(k)) = solvers_.by_refit({draws[k]}, tallies[k]);
    });
    for (const SolverTally& tally : tallies) refit_tally.add(tally);
    check_.not_converged = static_cast<int>(refit_tally.not_converged);
    const Eigen::MatrixXd t = projection_.of(refits);
    compare(projection_.of(linear) - t, check_.linear);
    compare(projection_.of(chord) - t, check_.chord);
  }

  void compare(const Eigen::MatrixXd& difference, PathCheck& check) const {
    check.draws = static_cast<int>(difference.rows());
    for (Eigen::Index i = 0; i < difference.cols(); ++i) {
      const Quantity& quantity = set_.items[static_cast<std::size_t>(i)];
      const double largest = difference.col(i).cwiseAbs().maxCoeff() * projection_.unit()[i];
      if (quantity.unit == "um" || quantity.unit == "mm")
        check.largest_length = std::max(check.largest_length, largest);
      if (quantity.unit == "urad") check.largest_angle = std::max(check.largest_angle, largest);
      const double share = largest / tolerance_of_paths(static_cast<std::size_t>(i));
      if (!(share <= check.largest_share)) {
        check.largest_share = share;
        check.where = quantity.words();
      }
    }
  }

  DrawPath supported_path() const {
    if (options_.refits <= 0) return DrawPath::Chord;
    if (check_.linear.largest_share <= kShareOfTolerance) return DrawPath::Linear;
    return check_.chord.largest_share <= kShareOfTolerance ? DrawPath::Chord : DrawPath::Refit;
  }

  /// 2 s of the least settled figure, SI.
  double scatter(std::size_t i) const {
    double worst = 0.0;
    for (const Figure figure : {Figure::Mean, Figure::Deviation, Figure::Low, Figure::High})
      worst = std::max(worst, sums_.standard_error(i, figure));
    return 2.0 * worst * projection_.unit()[static_cast<Eigen::Index>(i)];
  }

  static bool is_length_or_angle(const Quantity& quantity) {
    return quantity.unit == "um" || quantity.unit == "mm" || quantity.unit == "urad";
  }

  /// Delta of a standard uncertainty, SI.
  double tolerance_of(std::size_t i, double u) const {
    const Quantity& quantity = set_.items[i];
    const double by_digits =
        numerical_tolerance(u / quantity.si_per_unit, options_.digits) * quantity.si_per_unit;
    return is_length_or_angle(quantity) ? std::max(by_digits, kPracticalTolerance) : by_digits;
  }

  /// By a share of which a path may differ from refits.
  double tolerance_of_paths(std::size_t i) const {
    const double of_draws = tolerance_[static_cast<Eigen::Index>(i)];
    return is_length_or_angle(set_.items[i]) ? std::max(of_draws, kPracticalTolerance / kShareOfTolerance)
                                             : of_draws;
  }

  static constexpr std::uint64_t kFewestDraws = 2 * StudySums::kSequence;

  static std::uint64_t whole_sequences(double draws) {
    const auto sequences = static_cast<std::uint64_t>(
        std::ceil(std::min(draws, kMostForecast) / static_cast<double>(StudySums::kSequence)));
    return std::max(kFewestDraws, sequences * StudySums::kSequence);
  }

  std::uint64_t to_settle_by_normal_theory() const {
    double worst = 0.0;
    for (Eigen::Index i = 0; i < tolerance_.size(); ++i)
      worst = std::max(worst, 2.0 * StudySums::kEndScatter * projection_.unit()[i] / tolerance_[i]);
    return whole_sequences(worst * worst);
  }

  double tolerance_of_draws(std::size_t i) const {
    const double u = sums_.deviation(i) * projection_.unit()[static_cast<Eigen::Index>(i)];
    return u > 0.0 ? tolerance_of(i, u) : tolerance_[static_cast<Eigen::Index>(i)];
  }

  CoverageInterval from_t(const CoverageInterval& t, std::size_t i) const {
    const double unit = projection_.unit()[static_cast<Eigen::Index>(i)];
    return {set_.items[i].estimate + unit * t.low, set_.items[i].estimate + unit * t.high};
  }

  /// Draws that no path solved could hide any difference.
  LinearVerdict verdict(const QuantityResult& value, double surely_different) const {
    if (sums_.draws() < kFewestForEnds) return LinearVerdict::Undecided;
    if (tally_.not_converged == 0 && value.difference <= value.tolerance) return LinearVerdict::Validated;
    return value.difference <= value.tolerance + surely_different ? LinearVerdict::Undecided
                                                                  : LinearVerdict::NotValidated;
  }

  QuantityResult quantity_result(std::size_t i) const {
    const auto index = static_cast<Eigen::Index>(i);
    const double unit = projection_.unit()[index];
    QuantityResult result;
    result.quantity = set_.items[i];
    result.u_linear = projection_.u_linear()[index];
    result.bias_linear = projection_.bias_linear()[index];
    result.u = sums_.draws() < 2 ? std::nan("") : sums_.deviation(i) * unit;
    result.bias = sums_.mean(i) * unit;
    result.bias_error = result.u / std::sqrt(static_cast<double>(sums_.draws()));
    const double reach = normal_quantile(0.5 + 0.5 * kCoverageProbability) * result.u_linear;
    const double centre = result.quantity.estimate + result.bias_linear;
    result.linear = {centre - reach, centre + reach};
    result.symmetric = from_t(symmetric_interval(sums_.histogram(i), kCoverageProbability), i);
    result.shortest = from_t(shortest_interval(sums_.histogram(i), kCoverageProbability), i);
    result.tolerance = tolerance_of_draws(i);
    result.difference = std::max(std::abs(result.linear.low - result.symmetric.low),
                                 std::abs(result.linear.high - result.symmetric.high));
    result.end_error = unit * sums_.end_error(i);
    result.scatter = scatter(i);
    result.verdict = verdict(result, kScatter * unit * sums_.largest_end_error(i));
    return result;
  }

  MonteCarloOptions options_;
  int threads_;
  RepeatedCampaign repeated_;
  QuantitySet set_;
  DrawProjection projection_;
  PathSolvers solvers_;
  std::vector<Finding> contradicted_;
  StatedOfStudy stated_;
  StudySums sums_;
  Eigen::ArrayXd tolerance_;  ///< by linear propagation, SI
  RefitCheck check_;
  DrawPath path_ = DrawPath::Linear;
  SolverTally tally_;
  IdlePool<Histograms> histograms_;
};

MonteCarloStudy::MonteCarloStudy(const Campaign& campaign, const FitResult& result, MonteCarloOptions options)
    : work_(std::make_unique<Work>(campaign, result, std::move(options))) {}
MonteCarloStudy::~MonteCarloStudy() = default;

DrawPath MonteCarloStudy::path() const { return work_->path(); }
std::uint64_t MonteCarloStudy::draws() const { return work_->draws(); }
std::uint64_t MonteCarloStudy::expected_draws() const { return work_->expected_draws(); }
bool MonteCarloStudy::done() const { return work_->done(); }
void MonteCarloStudy::run_block() { work_->run_block(); }
MonteCarloResult MonteCarloStudy::result() const { return work_->result(); }
std::uint64_t MonteCarloStudy::fingerprint() const { return work_->fingerprint(); }
std::string MonteCarloStudy::save() const { return work_->save(); }
void MonteCarloStudy::restore(const std::string& state) { work_->restore(state); }

}  // namespace volcal
