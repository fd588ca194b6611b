#include "volcal/identify/planning/plan_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/planning/measured_positions.h"
#include "volcal/identify/planning/path_choice.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr std::size_t kCoarsePositions = 60;  // of a run while stations are looked for
constexpr std::size_t kMeasuredWhole = 0;     // positions of a run that is taken whole
constexpr std::size_t kLeastPool = 400;       // positions of a run to choose from
constexpr std::size_t kPoolPerPosition = 3;
constexpr double kPoolJitter = 0.5;    // of a grid step: the whole travel is met
constexpr double kSpreadShare = 0.25;  // of the positions, evenly over the volume whatever the criterion
constexpr std::uint64_t kCoarseStream = 2000000;
constexpr std::size_t kLeastOfRun = 8;  // positions: fewer hardly pay for their dead path
constexpr int kSitesAcross = 5;
constexpr int kSitesUp = 3;
constexpr double kFirstStep = 0.15;   // of the region
constexpr double kLastStep = 0.01;    // m
constexpr double kStatedStep = 1e-3;  // m: stations are given in whole millimetres
constexpr double kWorthwhile = 1e-4;  // of the variance, for a move
constexpr double kFewerRuns = 2e-3;   // of the variance, that one run less may cost
constexpr double kAsGood = 0.01;      // of the standard uncertainty
constexpr int kTurns = 3;             // of stations and positions

double in_millimetres(double value) { return std::round(value / kStatedStep) * kStatedStep; }

/// One search; every method is one stage.
class PlanSearch {
 public:
  PlanSearch(const PlanSettings& settings, const PlanProblem& problem, const LineOfSight& sight)
      : settings_(settings), problem_(problem), sight_(sight), threads_(thread_count(settings.threads)) {}

  SearchedPlan run() {
    progress("textbook layout", 0.0);
    const PlanLayout textbook = textbook_layout(settings_, sight_);
    found_.textbook = problem_.value(textbook);
    names_ = textbook.station_names;
    choose_tools();
    found_.tools = tools_;
    const std::vector<Eigen::Vector3d> from_lattice =
        refined(lattice_start(), "stations from a lattice", 0.05);
    const std::vector<Eigen::Vector3d> from_corners =
        refined(textbook.stations_w, "stations from corners", 0.3);
    const double lattice = coarse_value(from_lattice), corners = coarse_value(from_corners);
    if (!are_apart(from_lattice) && !are_apart(from_corners)) fail_without_room();
    if (!std::isfinite(std::min(lattice, corners))) fail_unseen(sight_);
    std::vector<Eigen::Vector3d> stations = lattice <= corners ? from_lattice : from_corners;
    const double ratio = std::sqrt(std::max(lattice, corners) / std::min(lattice, corners));
    if (ratio < 1.0 + kAsGood && furthest(from_lattice, from_corners) > 0.1) {
      found_.as_good_w = lattice <= corners ? from_corners : from_lattice;
      found_.as_good_ratio = ratio;
    }
    progress("runs", 0.5);
    drop_runs(stations);
    take_turns(stations);
    found_.station_tolerance = tolerances();
    progress("done", 1.0);
    return std::move(found_);
  }

 private:
  void progress(const std::string& stage, double done) const {
    if (settings_.progress) settings_.progress(stage, done);
  }

  [[noreturn]] void fail_without_room() const {
    const InstrumentWords words = sight_.instrument().words();
    throw InputError({},
                     fmt::format("{} {} have no room {:.0f} mm apart where {}", settings_.budget.stations,
                                 words.places, kPlacesApart / kMetrePerMillimetre, words.region),
                     "give fewer --stations or a larger --region-mm");
  }

  /// Positions of a coarse grid that the stations see; all tools at all stations, or the runs that are left.
  PlanLayout coarse(const std::vector<Eigen::Vector3d>& stations) const {
    return all_runs(stations, kCoarsePositions);
  }

  PlanLayout all_runs(const std::vector<Eigen::Vector3d>& stations, std::size_t positions) const {
    PlanLayout layout;
    layout.stations_w = stations;
    layout.station_names.assign(names_.begin(),
                                names_.begin() + static_cast<std::ptrdiff_t>(stations.size()));
    for (std::size_t station = 0; station < stations.size(); ++station) {
      for (const std::size_t tool : tools_) {
        if (is_dropped(station, tool)) continue;
        for (PlanRun& run : candidate_runs(stations, station, tool, positions, kCoarseStream)) {
          if (run.positions.size() >= kLeastOfRun) layout.runs.push_back(std::move(run));
        }
      }
    }
    return layout;
  }

  std::vector<PlanRun> candidate_runs(const std::vector<Eigen::Vector3d>& stations, std::size_t station,
                                      std::size_t tool, std::size_t positions, std::uint64_t stream) const {
    const std::uint64_t own = stream + station * settings_.machine.tools.size() + tool;
    return sight_.candidate_runs(stations[station], station, tool, {positions, kPoolJitter, own});
  }

  bool is_dropped(std::size_t station, std::size_t tool) const {
    return std::ranges::find(dropped_, std::pair(station, tool)) != dropped_.end();
  }

  /// Of stations that are one place there is no value.
  double coarse_value(const std::vector<Eigen::Vector3d>& stations) const {
    if (!are_apart(stations)) return std::numeric_limits<double>::infinity();
    const PlanLayout layout = coarse(stations);
    if (layout.runs.empty()) return std::numeric_limits<double>::infinity();
    return problem_.value(layout, readings_to_judge(layout));
  }

  /// Where the time carries no reading of all runs, one position of each: runs are dropped later.
  std::size_t readings_to_judge(const PlanLayout& layout) const {
    const std::size_t affordable = affordable_readings(settings_, layout);
    if (sight_.instrument().takes_runs_whole()) return std::min(affordable, layout.readings());
    return affordable > 0 ? affordable : 2 * layout.runs.size();
  }

  /// Of several sets of stations, at once.
  std::vector<double> coarse_values(const std::vector<std::vector<Eigen::Vector3d>>& sets) const {
    std::vector<double> values(sets.size());
    run_parallel(sets.size(), threads_, [&](std::size_t i) { values[i] = coarse_value(sets[i]); });
    return values;
  }

  /// The subset of tools that is best at the textbook's stations, where not all may be used.
  void choose_tools() {
    tools_ = tools_of(settings_);
    if (!settings_.budget.tool_count) return;
    const auto wanted = static_cast<std::size_t>(*settings_.budget.tool_count);
    const std::vector<Eigen::Vector3d> stations = textbook_layout(settings_, sight_).stations_w;
    while (tools_.size() > wanted) {
      const std::vector<std::size_t> all = tools_;
      double best = std::numeric_limits<double>::infinity();
      std::vector<std::size_t> kept;
      for (std::size_t left_out = 0; left_out < all.size(); ++left_out) {
        tools_ = all;
        tools_.erase(tools_.begin() + static_cast<std::ptrdiff_t>(left_out));
        const double value = coarse_value(stations);
        if (!kept.empty() && value >= best) continue;
        best = value;
        kept = tools_;
      }
      tools_ = kept;
    }
  }

  std::vector<Eigen::Vector3d> sites() const {
    const int up = sight_.along_spindle();
    const Eigen::AlignedBox3d& region = sight_.stations_w();
    std::vector<Eigen::Vector3d> all;
    for (int i = 0; i < kSitesAcross; ++i) {
      for (int j = 0; j < kSitesAcross; ++j) {
        for (int k = 0; k < kSitesUp; ++k) {
          Eigen::Vector3d share;
          share[(up + 1) % 3] = static_cast<double>(i) / (kSitesAcross - 1);
          share[(up + 2) % 3] = static_cast<double>(j) / (kSitesAcross - 1);
          share[up] = static_cast<double>(k) / (kSitesUp - 1);
          const Eigen::Vector3d site = region.min() + share.cwiseProduct(region.sizes());
          if (sight_.can_stand(site)) all.push_back(site);
        }
      }
    }
    if (all.empty()) {
      throw InputError(
          {},
          sight_.instrument().turns_rotary_axes()
              ? "spheres can stand nowhere: no tool reaches the region"
              : "stations can stand nowhere: the region lies inside the box that tools and spindle sweep",
          "give a larger --region-mm or a smaller --clearance-mm");
    }
    return all;
  }

  std::vector<Eigen::Vector3d> lattice_start() const {
    const std::vector<Eigen::Vector3d> all = sites();
    const auto count = static_cast<std::size_t>(settings_.budget.stations);
    std::vector<Eigen::Vector3d> stations;
    for (std::size_t added = 0; added < count; ++added) {
      stations.emplace_back();
      exchange_station(all, added, std::numeric_limits<double>::infinity(), stations);
    }
    double value = coarse_value(stations);
    for (std::size_t station = 0; station < count; ++station) {
      value = exchange_station(all, station, value, stations);
    }
    return stations;
  }

  /// Puts one station to the best site; the value reached.
  double exchange_station(const std::vector<Eigen::Vector3d>& all, std::size_t station, double value,
                          std::vector<Eigen::Vector3d>& stations) const {
    std::vector<std::vector<Eigen::Vector3d>> sets(all.size(), stations);
    for (std::size_t i = 0; i < all.size(); ++i) sets[i][station] = all[i];
    const std::vector<double> values = coarse_values(sets);
    const auto best = static_cast<std::size_t>(std::ranges::min_element(values) - values.begin());
    if (values[best] < value || !std::isfinite(value)) {
      stations[station] = all[best];
      return values[best];
    }
    return value;
  }

  /// Stations with one of them a step aside, where it can stand.
  std::vector<std::vector<Eigen::Vector3d>> aside(const std::vector<Eigen::Vector3d>& stations,
                                                  std::size_t station, double step) const {
    const Eigen::AlignedBox3d& region = sight_.stations_w();
    std::vector<std::vector<Eigen::Vector3d>> sets;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        std::vector<Eigen::Vector3d> set = stations;
        set[station][axis] = in_millimetres(set[station][axis] + sign * step);
        set[station] = set[station].cwiseMax(region.min()).cwiseMin(region.max());
        if (sight_.can_stand(set[station])) sets.push_back(std::move(set));
      }
    }
    return sets;
  }

  template <class Value>
  std::vector<Eigen::Vector3d> pattern_search(std::vector<Eigen::Vector3d> stations, double first_step,
                                              const Value& values_of, const std::string& stage, double done,
                                              double share) const {
    double value = values_of(std::vector<std::vector<Eigen::Vector3d>>(1, stations)).front();
    const double all_steps = std::log2(first_step / kLastStep) + 1.0;
    int halvings = 0;
    for (double step = first_step; step > kLastStep; step *= 0.5, ++halvings) {
      progress(stage, done + share * halvings / all_steps);
      for (bool moved = true; moved;) {
        moved = false;
        for (std::size_t station = 0; station < stations.size(); ++station) {
          const std::vector<std::vector<Eigen::Vector3d>> sets = aside(stations, station, step);
          if (sets.empty()) continue;
          const std::vector<double> values = values_of(sets);
          const auto best = static_cast<std::size_t>(std::ranges::min_element(values) - values.begin());
          if (!(values[best] < value * (1.0 - kWorthwhile))) continue;
          value = values[best];
          stations = sets[best];
          moved = true;
        }
      }
    }
    return stations;
  }

  double first_step() const { return kFirstStep * sight_.stations_w().sizes().maxCoeff(); }

  std::vector<Eigen::Vector3d> refined(const std::vector<Eigen::Vector3d>& start, const std::string& stage,
                                       double done) const {
    return pattern_search(
        start, first_step(), [this](const auto& sets) { return coarse_values(sets); }, stage, done, 0.2);
  }

  /// A layout without one run, and the criterion that is left.
  struct Departure {
    std::pair<std::size_t, std::size_t> run;  ///< station and tool
    double value = std::numeric_limits<double>::infinity();
  };

  /// The run that is missed least; every station keeps one. None where nothing can go.
  std::optional<Departure> least_missed(const std::vector<Eigen::Vector3d>& stations) {
    const PlanLayout layout = coarse(stations);
    std::optional<Departure> best;
    for (const PlanRun& run : layout.runs) {
      const auto at_station = [&](const PlanRun& each) { return each.station == run.station; };
      if (std::ranges::count_if(layout.runs, at_station) < 2) continue;
      dropped_.emplace_back(run.station, run.tool);
      const Departure without{dropped_.back(), coarse_value(stations)};
      dropped_.pop_back();
      if (!best || without.value < best->value) best = without;
    }
    return best;
  }

  /// Where time is limited, a run less leaves readings for the others: as many go as the time does not carry,
  /// then those that cost hardly anything.
  void drop_runs(const std::vector<Eigen::Vector3d>& stations) {
    if (!settings_.budget.time || sight_.instrument().takes_runs_whole()) return;
    while (!carries_a_position_of_each(settings_, coarse(stations))) {
      const std::optional<Departure> going = least_missed(stations);
      if (!going) fail_one_run_at_every_station();
      dropped_.push_back(going->run);
    }
    double value = coarse_value(stations);
    while (const std::optional<Departure> going = least_missed(stations)) {
      if (!(going->value < value * (1.0 + kFewerRuns))) return;
      dropped_.push_back(going->run);
      value = going->value;
    }
  }

  /// All positions that can be chosen.
  PlanLayout pool_layout(const std::vector<Eigen::Vector3d>& stations, std::size_t positions) const {
    PlanLayout layout = coarse(stations);
    const std::size_t each =
        std::max(kLeastPool, kPoolPerPosition * positions / std::max<std::size_t>(1, layout.runs.size()));
    for (PlanRun& run : layout.runs) run = candidate_runs(stations, run.station, run.tool, each, 0).front();
    return layout;
  }

  /// Of a pool's positions, those that are best.
  PlanLayout chosen(const PlanLayout& all, std::size_t positions, double done) {
    const PlanProblem::Pool pool = problem_.pool_of(all);
    if (positions > pool.pool.candidates()) positions = pool.pool.candidates();
    ExchangeOptions options;
    options.threads = threads_;
    options.progress = [&](double share) { progress("positions", done + 0.1 * share); };
    options.kept = spread(pool.pool.candidates(), positions);
    const ExchangeResult exchanged =
        exchange_design(pool.pool, pool.base, problem_.criterion(), positions, options);
    found_.pool = pool.pool.candidates();
    found_.converged = exchanged.converged;
    PlanLayout layout = all;
    std::size_t candidate = 0;
    for (PlanRun& run : layout.runs) {
      std::vector<PlanPosition> taken;
      for (const PlanPosition& position : run.positions) {
        if (exchanged.taken[candidate++] > 0) taken.push_back(position);
      }
      run.positions = std::move(taken);
    }
    std::erase_if(layout.runs, [](const PlanRun& run) { return run.positions.empty(); });
    return layout;
  }

  /// Every n-th of the pool, in path order: no piece of an axis goes without readings, so that functions with
  /// automatic knots are determined without what is assumed of their roughness.
  static std::vector<int> spread(std::size_t candidates, std::size_t positions) {
    std::vector<int> kept(candidates, 0);
    const auto count = static_cast<std::size_t>(kSpreadShare * static_cast<double>(positions));
    for (std::size_t k = 0; k < count; ++k) kept[(2 * k + 1) * candidates / (2 * count)] = 1;
    return kept;
  }

  /// Of all runs at these stations, whole ones that are best.
  PlanLayout whole_runs(const std::vector<Eigen::Vector3d>& stations) {
    const PlanLayout all = all_runs(stations, kMeasuredWhole);
    ChosenPaths chosen = choose_paths(settings_, problem_, all, threads_);
    found_.pool = all.positions();
    found_.converged = chosen.converged;
    return std::move(chosen.layout);
  }

  PlanLayout within_time(const PlanLayout& all, std::size_t positions, double done) {
    PlanLayout layout = chosen(all, positions, done);
    for (int i = 0; settings_.budget.time && i < 4; ++i) {
      const double excess = duration(layout, settings_) - *settings_.budget.time;
      if (excess <= 0.0) break;
      const double per_position = 2.0 * (settings_.costs.reading + mean_move(layout));
      const auto fewer = static_cast<std::size_t>(std::ceil(excess / per_position));
      positions = layout.positions() > fewer + 1 ? layout.positions() - fewer : 1;
      layout = chosen(all, positions, done);
    }
    return layout;
  }

  double mean_move(const PlanLayout& layout) const {
    const double moving = duration(layout, settings_) -
                          settings_.costs.station * static_cast<double>(layout.stations_w.size()) -
                          settings_.costs.run * static_cast<double>(layout.runs.size());
    return moving / static_cast<double>(std::max<std::size_t>(1, layout.readings())) -
           settings_.costs.reading;
  }

  /// Positions as chosen, those that are still seen; lost ones are readings lost.
  PlanLayout seen_from(PlanLayout layout, const std::vector<Eigen::Vector3d>& stations) const {
    layout.stations_w = stations;
    for (PlanRun& run : layout.runs) run = sight_.moved(stations[run.station], run);
    std::erase_if(layout.runs, [](const PlanRun& run) { return run.positions.empty(); });
    return layout;
  }

  std::vector<double> values_of(const PlanLayout& layout,
                                const std::vector<std::vector<Eigen::Vector3d>>& sets) const {
    std::vector<double> values(sets.size());
    run_parallel(sets.size(), threads_, [&](std::size_t i) {
      values[i] = are_apart(sets[i]) ? problem_.value(seen_from(layout, sets[i]))
                                     : std::numeric_limits<double>::infinity();
    });
    return values;
  }

  void take_turns(std::vector<Eigen::Vector3d> stations) {
    for (int turn = 0; turn < kTurns; ++turn) {
      const double done = 0.55 + 0.13 * turn;
      const std::size_t positions = affordable_readings(settings_, coarse(stations)) / 2;
      if (positions == 0 && turn > 0) return;  // moved stations see runs that the time does not carry
      const PlanLayout layout = sight_.instrument().takes_runs_whole()
                                    ? whole_runs(stations)
                                    : within_time(pool_layout(stations, positions), positions, done);
      const double value = problem_.value(layout);
      const bool better = turn == 0 || value < found_.value * (1.0 - kWorthwhile);
      if (better) {
        found_.layout = layout;
        found_.value = value;
      }
      if (!better || turn + 1 == kTurns) return;
      stations = pattern_search(
          layout.stations_w, 0.25 * first_step(), [&](const auto& sets) { return values_of(layout, sets); },
          "stations for these positions", done + 0.1, 0.03);
    }
  }

  static double furthest(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to) {
    double largest = 0.0;
    for (const Eigen::Vector3d& each : from) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& other : to) nearest = std::min(nearest, (each - other).norm());
      largest = std::max(largest, nearest);
    }
    return largest;
  }

  std::vector<double> tolerances() const {
    constexpr double kSteps[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5};
    std::vector<double> all;
    const auto& stations = found_.layout.stations_w;
    for (std::size_t station = 0; station < stations.size(); ++station) {
      double within = 0.0;
      for (const double step : kSteps) {
        std::vector<std::vector<Eigen::Vector3d>> sets;
        for (int k = 0; k < 6; ++k) {
          sets.push_back(stations);
          sets.back()[station][k / 2] += k % 2 == 0 ? step : -step;
        }
        const std::vector<double> values = values_of(found_.layout, sets);
        if (std::ranges::max(values) > found_.value * std::pow(1.0 + kAsGood, 2)) break;
        within = step;
      }
      all.push_back(within);
    }
    return all;
  }

  const PlanSettings& settings_;
  const PlanProblem& problem_;
  const LineOfSight& sight_;
  int threads_;
  std::vector<std::string> names_;
  std::vector<std::size_t> tools_;
  std::vector<std::pair<std::size_t, std::size_t>> dropped_;  ///< station and tool
  SearchedPlan found_;
};

}  // namespace

std::size_t affordable_readings(const PlanSettings& settings, const PlanLayout& layout) {
  constexpr double kMoveShare = 0.1;  // of the longest travel, from one position to the next
  std::size_t readings = settings.budget.readings ? static_cast<std::size_t>(*settings.budget.readings)
                                                  : std::numeric_limits<std::size_t>::max();
  if (settings.budget.time) {
    double travel = 0.0;
    for (const Axis& axis : settings.machine.axes) {
      if (!is_rotary(axis.name)) travel = std::max(travel, axis.travel());
    }
    const double left = *settings.budget.time -
                        settings.costs.station * static_cast<double>(layout.stations_w.size()) -
                        settings.costs.run * static_cast<double>(layout.runs.size());
    double move = travel / settings.costs.feed;
    if (plan_instrument_of(settings).turns_rotary_axes())
      move = rotary_stretches(settings.machine).front().length() / settings.costs.turn;
    const double each = settings.costs.reading + kMoveShare * move;
    readings = std::min(readings, static_cast<std::size_t>(std::max(0.0, left / each)));
  }
  return readings / 2 * 2;
}

bool carries_a_position_of_each(const PlanSettings& settings, const PlanLayout& layout) {
  return affordable_readings(settings, layout) / 2 >= layout.runs.size();
}

SearchedPlan search_plan(const PlanSettings& settings, const PlanProblem& problem, const LineOfSight& sight) {
  return PlanSearch(settings, problem, sight).run();
}

}  // namespace volcal
