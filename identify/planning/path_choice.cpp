#include "volcal/identify/planning/path_choice.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::size_t kPromising = 6;  // runs inside and outside, of which pairs are tried
constexpr int kMostExchanges = 100;
constexpr double kWorthAnExchange = 1e-4;  // of the criterion, for an exchange

class PathChoice {
 public:
  PathChoice(const PlanSettings& settings, const PlanProblem& problem, const PlanLayout& all, int threads)
      : settings_(settings),
        criterion_(problem.criterion()),
        all_(all),
        threads_(threads),
        pool_(problem.pool_of(all)),
        taken_(all.runs.size(), true) {
    use_single_threaded_blas();
    std::size_t candidate = 0;
    first_row_.push_back(0);
    for (const PlanRun& run : all.runs) {
      candidate += run.positions.size();
      first_row_.push_back(pool_.pool.first[candidate]);
    }
    information_ = pool_.base;
    for (std::size_t path = 0; path < taken_.size(); ++path) add(path, 1.0, information_);
  }

  ChosenPaths run() {
    while (!fits_budget(layout_of(taken_), settings_)) leave_one_out();
    ChosenPaths chosen;
    for (int i = 0; i < kMostExchanges && !chosen.converged; ++i) chosen.converged = !improve();
    chosen.layout = layout_of(taken_);
    return chosen;
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  PlanLayout layout_of(const std::vector<bool>& taken) const {
    PlanLayout layout = all_;
    layout.runs.clear();
    for (std::size_t path = 0; path < taken.size(); ++path) {
      if (taken[path]) layout.runs.push_back(all_.runs[path]);
    }
    return layout;
  }

  void add(std::size_t path, double factor, Eigen::MatrixXd& information) const {
    add_gram_upper(pool_.pool.rows.middleRows(first_row_[path], first_row_[path + 1] - first_row_[path]),
                   factor, information);
  }

  /// A change: runs that come and go.
  struct Exchange {
    std::optional<std::size_t> comes;
    std::optional<std::size_t> goes;
    double value = kNever;
  };

  std::vector<bool> after(const Exchange& exchange) const {
    std::vector<bool> taken = taken_;
    if (exchange.comes) taken[*exchange.comes] = true;
    if (exchange.goes) taken[*exchange.goes] = false;
    return taken;
  }

  bool leaves_every_station_a_run(const std::vector<bool>& taken) const {
    std::vector<bool> used(all_.stations_w.size(), false);
    for (std::size_t path = 0; path < taken.size(); ++path) {
      if (taken[path]) used[all_.runs[path].station] = true;
    }
    return std::ranges::all_of(all_.runs, [&](const PlanRun& run) { return used[run.station]; });
  }

  void evaluate(std::vector<Exchange>& exchanges) const {
    run_parallel(exchanges.size(), threads_, [&](std::size_t i) {
      Eigen::MatrixXd information = information_;
      if (exchanges[i].comes) add(*exchanges[i].comes, 1.0, information);
      if (exchanges[i].goes) add(*exchanges[i].goes, -1.0, information);
      exchanges[i].value = criterion_.value(information).value_or(kNever);
    });
    std::ranges::stable_sort(exchanges, {}, &Exchange::value);
  }

  std::vector<Exchange> departures() const {
    std::vector<Exchange> all;
    for (std::size_t path = 0; path < taken_.size(); ++path) {
      const Exchange leaving{std::nullopt, path};
      if (taken_[path] && leaves_every_station_a_run(after(leaving))) all.push_back(leaving);
    }
    evaluate(all);
    return all;
  }

  std::vector<Exchange> arrivals() const {
    std::vector<Exchange> all;
    for (std::size_t path = 0; path < taken_.size(); ++path) {
      if (!taken_[path]) all.push_back({path, std::nullopt});
    }
    evaluate(all);
    return all;
  }

  void take(const Exchange& exchange) {
    if (exchange.comes) add(*exchange.comes, 1.0, information_);
    if (exchange.goes) add(*exchange.goes, -1.0, information_);
    taken_ = after(exchange);
  }

  void leave_one_out() {
    const std::vector<Exchange> leaving = departures();
    if (leaving.empty()) {
      throw InputError({}, "readings or time do not suffice for one path at every place",
                       "give more --readings or --time, or fewer --stations");
    }
    take(leaving.front());
  }

  /// A run more where one fits, else the best of the promising pairs; false when nothing helps.
  bool improve() {
    std::vector<Exchange> coming = arrivals(), going = departures(), tried;
    for (const Exchange& each : coming) {
      if (!fits_budget(layout_of(after(each)), settings_)) continue;
      take(each);
      return true;
    }
    for (std::size_t i = 0; i < std::min(kPromising, going.size()); ++i) {
      for (std::size_t k = 0; k < std::min(kPromising, coming.size()); ++k) {
        const Exchange pair{coming[k].comes, going[i].goes};
        if (fits_budget(layout_of(after(pair)), settings_)) tried.push_back(pair);
      }
    }
    evaluate(tried);
    const double now = criterion_.value(information_).value_or(kNever);
    if (tried.empty() || !(tried.front().value < now * (1.0 - kWorthAnExchange))) return false;
    take(tried.front());
    return true;
  }

  const PlanSettings& settings_;
  const DesignCriterion& criterion_;
  const PlanLayout& all_;
  int threads_;
  PlanProblem::Pool pool_;
  std::vector<Eigen::Index> first_row_;  ///< of every run in the pool
  std::vector<bool> taken_;
  Eigen::MatrixXd information_;
};

}  // namespace

bool fits_budget(const PlanLayout& layout, const PlanSettings& settings) {
  if (settings.budget.readings && layout.readings() > static_cast<std::size_t>(*settings.budget.readings))
    return false;
  return !settings.budget.time || duration(layout, settings) <= *settings.budget.time;
}

ChosenPaths choose_paths(const PlanSettings& settings, const PlanProblem& problem, const PlanLayout& all,
                         int threads) {
  return PathChoice(settings, problem, all, threads).run();
}

}  // namespace volcal
