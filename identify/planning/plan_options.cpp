#include "volcal/identify/planning/plan_options.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/planning/measured_positions.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kSideways = 0.1;     // m
constexpr double kLonger = 0.1;       // m
constexpr double kSameLength = 0.02;  // m
constexpr double kSameSpot = 1e-3;    // m or so: tools that stand alike
constexpr int kUsualReadings = 240;
constexpr double kOptionJitter = 0.3;
constexpr std::uint64_t kOptionStream = 3000000;
constexpr std::size_t kLeastSeen = 8;
constexpr double kFinerPool = 6.0;
constexpr int kOptionSites = 5;
constexpr std::size_t kMostOptions = 12;
constexpr double kShareOfSites = 0.5;  // of the search's time

FindingValue in_mm(const Eigen::Vector3d& place) {
  std::vector<FindingNumber> numbers;
  for (const double each : place) numbers.push_back({each, "mm", kMetrePerMillimetre});
  return numbers;
}

/// As long as the longest, and to the side of the spindle.
Tool sideways_tool(const Machine& machine, const Eigen::Vector3d& spindle_w) {
  Tool tool =
      *std::ranges::max_element(machine.tools, {}, [](const Tool& each) { return each.offset.norm(); });
  int along = 0;
  spindle_w.cwiseAbs().maxCoeff(&along);
  tool.offset[(along + 1) % 3] += kSideways;
  tool.offset_sigma = 0.0;
  tool.name = "sideways";
  while (machine.tool_index(tool.name)) tool.name += "_";
  return tool;
}

/// Where rotary axes turn, two lengths tell a tilt of a head from a displacement: a longer tool where all are
/// alike.
std::optional<Tool> longer_tool(const Machine& machine, const Eigen::Vector3d& spindle_w) {
  const auto length = [&](const Tool& each) { return -each.offset.dot(spindle_w); };
  const auto [shortest, longest] = std::ranges::minmax_element(machine.tools, {}, length);
  if (length(*longest) - length(*shortest) > kSameLength) return std::nullopt;
  Tool tool = *longest;
  tool.offset -= kLonger * spindle_w;
  tool.offset_sigma = 0.0;
  tool.name = "longer";
  while (machine.tool_index(tool.name)) tool.name += "_";
  return tool;
}

/// Everything that could be added, judged one by one.
class OptionSearch {
 public:
  OptionSearch(PlanSettings settings, const ExpectedCampaign& now)
      : settings_(std::move(settings)), now_(now) {
    progress_ = std::exchange(settings_.progress, nullptr);
    own_machine_ = settings_.machine;
    own_hypothetical_ = settings_.hypothetical_tools;
    positions_ = static_cast<std::size_t>(settings_.budget.readings.value_or(kUsualReadings)) / 2;
    existing_ = *settings_.existing;
    if (!now.invisible().empty()) {
      imagine_tools();
      existing_.machine = settings_.machine;
    }
    settings_.existing = &existing_;
    settings_.budget.stations = 1;
    settings_.budget.tools.clear();
    for (std::size_t tool = 0; tool < settings_.machine.tools.size(); ++tool)
      settings_.budget.tools.push_back(tool);
  }

  SetupOptions run() {
    const LineOfSight sight(settings_);
    const PlanProblem problem(settings_);
    std::vector<PlanLayout> layouts = at_known_places(sight);
    for (PlanLayout& layout : at_new_places(sight, problem)) layouts.push_back(std::move(layout));
    std::vector<Judged> judged(layouts.size());
    std::atomic<std::size_t> finished{0};
    run_parallel(layouts.size(), thread_count(settings_.threads), [&](std::size_t i) {
      judged[i] = judge(layouts[i], problem);
      tell(kShareOfSites + (1.0 - kShareOfSites) * share_of(++finished, layouts.size()));
    });
    std::ranges::stable_sort(judged, {}, [](const Judged& each) {
      return std::pair(each.option.still_invisible.size(), each.order);
    });
    return summary(judged);
  }

 private:
  /// From any thread.
  void tell(double done) const {
    if (progress_) progress_("options", done);
  }

  static double share_of(std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(1, whole));
  }

  void imagine_tools() {
    const LineOfSight sight(settings_);
    const Eigen::Vector3d spindle_w = sight.spindle_w();
    std::vector<Tool> imagined = {sideways_tool(settings_.machine, spindle_w)};
    if (sight.instrument().turns_rotary_axes()) {
      if (const auto longer = longer_tool(settings_.machine, spindle_w)) imagined.push_back(*longer);
    }
    for (const Tool& tool : imagined) {
      settings_.machine.tools.push_back(tool);
      ++settings_.hypothetical_tools;
    }
  }

  struct Judged {
    PlanOption option;
    PlanLayout layout;
    double order = 0.0;  ///< the uncertainty that the table shows, or the criterion of another target
  };

  PlanLayout layout_of(const NamedPlace& place, std::size_t tool, const LineOfSight& sight) const {
    PlanLayout layout;
    layout.stations_w = {place.place_w};
    layout.station_names = {place.name};
    if (sight.instrument().takes_runs_whole()) {
      add_whole_runs(tool, sight, layout);
    } else {
      add_even_run(tool, sight, layout);
    }
    return layout;
  }

  /// Those that are not measured yet, as many as the readings allow, one at least.
  void add_whole_runs(std::size_t tool, const LineOfSight& sight, PlanLayout& layout) const {
    for (PlanRun& run : sight.candidate_runs(layout.stations_w.front(), 0, tool, {})) {
      const std::string name = run_name(layout, run, settings_.machine);
      const bool measured = std::ranges::find(existing_.setups, name, &Setup::name) != existing_.setups.end();
      const bool fits = layout.runs.empty() || layout.positions() + run.positions.size() <= positions_;
      if (!measured && fits) layout.runs.push_back(std::move(run));
    }
  }

  void add_even_run(std::size_t tool, const LineOfSight& sight, PlanLayout& layout) const {
    PlanRun run{0, tool, {}};
    for (std::size_t asked = positions_; asked <= 4 * positions_ + 64; asked += 1 + asked / 8) {
      run.positions = sight
                          .candidate_runs(layout.stations_w.front(), 0, tool,
                                          {asked, kOptionJitter, kOptionStream + tool})
                          .front()
                          .positions;
      std::ranges::sort(run.positions, {}, [](const PlanPosition& each) {
        return std::tuple(each.cell[2], each.cell[1], each.cell[0]);
      });
      if (run.positions.size() < positions_) continue;
      std::vector<PlanPosition> even;
      for (std::size_t k = 0; k < positions_; ++k)
        even.push_back(run.positions[(2 * k + 1) * run.positions.size() / (2 * positions_)]);
      run.positions = std::move(even);
      break;
    }
    if (run.positions.size() >= kLeastSeen) layout.runs.push_back(std::move(run));
  }

  std::optional<NamedPlace> place_of(const Setup& setup) const {
    if (setup.instrument != plan_instrument_of(settings_).instrument()) return std::nullopt;
    return plan_instrument_of(settings_).place_of(setup, settings_.machine);
  }

  std::vector<NamedPlace> known_places() const {
    std::vector<NamedPlace> places;
    for (const Setup& setup : existing_.setups) {
      const auto place = place_of(setup);
      if (!place) continue;
      if (std::ranges::find(places, place->name, &NamedPlace::name) == places.end()) places.push_back(*place);
    }
    return places;
  }

  bool is_measured(const std::string& station, std::size_t tool) const {
    return std::ranges::any_of(existing_.setups, [&](const Setup& setup) {
      const auto place = place_of(setup);
      return place && place->name == station &&
             (settings_.machine.tools[setup.tool].offset - settings_.machine.tools[tool].offset).norm() <
                 kSameSpot;
    });
  }

  std::vector<PlanLayout> at_known_places(const LineOfSight& sight) const {
    std::vector<PlanLayout> layouts;
    for (const NamedPlace& place : known_places()) {
      for (std::size_t tool = 0; tool < settings_.machine.tools.size(); ++tool) {
        if (!sight.instrument().takes_runs_whole() && is_measured(place.name, tool)) continue;
        PlanLayout layout = layout_of(place, tool, sight);
        if (!layout.runs.empty()) layouts.push_back(std::move(layout));
      }
    }
    return layouts;
  }

  std::string new_name() const {
    std::set<std::string> used;
    for (const Setup& setup : existing_.setups) {
      used.insert(setup.name);
      used.insert(setup.options.text("station").value_or(""));
      if (const auto place = place_of(setup)) used.insert(place->name);
    }
    int number = 1;
    while (used.contains("P" + std::to_string(number))) ++number;
    return "P" + std::to_string(number);
  }

  /// Every tool at the site that is best for it, away from places that are known.
  std::vector<PlanLayout> at_new_places(const LineOfSight& sight, const PlanProblem& problem) const {
    std::vector<Eigen::Vector3d> sites, known;
    for (const NamedPlace& place : known_places()) known.push_back(place.place_w);
    const Eigen::AlignedBox3d& region = sight.stations_w();
    for (int i = 0; i < kOptionSites * kOptionSites * kOptionSites; ++i) {
      const int x = i % kOptionSites, y = i / kOptionSites % kOptionSites,
                z = i / (kOptionSites * kOptionSites);
      const Eigen::Vector3d cell(x, y, z);
      const Eigen::Vector3d site = region.min() + (cell / (kOptionSites - 1)).cwiseProduct(region.sizes());
      if (sight.can_stand(site) && !is_one_of(site, known)) sites.push_back(site);
    }
    std::vector<PlanLayout> layouts;
    for (std::size_t tool = 0; tool < settings_.machine.tools.size(); ++tool) {
      std::vector<PlanLayout> all(sites.size());
      std::vector<double> values(sites.size(), std::numeric_limits<double>::infinity());
      run_parallel(sites.size(), thread_count(settings_.threads), [&](std::size_t i) {
        all[i] = layout_of({new_name(), sites[i]}, tool, sight);
        if (!all[i].runs.empty()) values[i] = problem.value(all[i]);
      });
      tell(kShareOfSites * share_of(tool + 1, settings_.machine.tools.size()));
      if (values.empty()) continue;
      const auto best = static_cast<std::size_t>(std::ranges::min_element(values) - values.begin());
      if (std::isfinite(values[best])) layouts.push_back(std::move(all[best]));
    }
    return layouts;
  }

  Judged judge(const PlanLayout& layout, const PlanProblem& problem) const {
    PlanSettings settings = settings_;
    settings.threads = 1;
    const ExpectedCampaign with = expected_campaign("option", campaign_of(layout, settings), settings, false);
    Judged judged;
    judged.layout = layout;
    judged.order = settings.target == PlanTarget::Volumetric ? with.volumetric.rms : problem.value(layout);
    PlanOption& option = judged.option;
    const PlanRun& run = layout.runs.front();
    const Tool& tool = settings.machine.tools[run.tool];
    option.new_tool = run.tool >= own_machine_.tools.size();
    const std::vector<NamedPlace> known = known_places();
    option.new_station =
        std::ranges::find(known, layout.station_names.front(), &NamedPlace::name) == known.end();
    option.what = {FindingCode::PlanSetupMore,
                   {{"tool", tool.name},
                    {"place", layout.station_names.front()},
                    {"kind_of_place", plan_instrument_of(settings_).words().place}}};
    if (option.new_tool) option.what.data["offset_of_new_tool"] = in_mm(tool.offset);
    if (option.new_station) option.what.data["new_place"] = in_mm(layout.stations_w.front());
    option.readings = layout.readings();
    option.volumetric_rms = with.volumetric.rms;
    const std::vector<MachineError> unseen = with.invisible();
    for (const MachineError& error : now_.invisible()) {
      const bool still = std::ranges::find(unseen, error) != unseen.end();
      (still ? option.still_invisible : option.made_visible).push_back(error);
    }
    return judged;
  }

  SetupOptions summary(const std::vector<Judged>& judged) const {
    SetupOptions out;
    out.machine = own_machine_;
    out.hypothetical_tools = own_hypothetical_;
    if (judged.empty()) return out;
    for (const Judged& each : judged) {
      if (out.options.size() < kMostOptions) out.options.push_back(each.option);
    }
    out.best = judged.front().layout;
    if (judged.front().option.new_tool) {
      out.machine = settings_.machine;
      out.hypothetical_tools = settings_.hypothetical_tools;
    }
    return out;
  }

  PlanSettings settings_;
  std::function<void(const std::string& stage, double done)> progress_;
  const ExpectedCampaign& now_;
  Machine own_machine_;
  std::size_t own_hypothetical_ = 0;
  Campaign existing_;
  std::size_t positions_ = 0;
};

}  // namespace

SetupOptions setup_options(const PlanSettings& settings, const ExpectedCampaign& now) {
  return OptionSearch(settings, now).run();
}

PlanLayout with_chosen_positions(const PlanSettings& settings, const PlanLayout& layout) {
  if (plan_instrument_of(settings).takes_runs_whole()) return layout;
  PlanSettings own = settings;
  own.budget.stations = 1;
  own.budget.tools.clear();
  own.progress = nullptr;
  for (const PlanRun& run : layout.runs) own.budget.tools.push_back(run.tool);
  Campaign existing = *settings.existing;
  existing.machine = settings.machine;
  own.existing = &existing;
  const LineOfSight sight(own);
  const PlanProblem problem(own);
  PlanLayout fine = layout;
  for (PlanRun& run : fine.runs) {
    const auto asked = static_cast<std::size_t>(kFinerPool * static_cast<double>(run.positions.size()));
    run = sight
              .candidate_runs(fine.stations_w[run.station], run.station, run.tool,
                              {asked, kOptionJitter, run.tool})
              .front();
  }
  const PlanProblem::Pool pool = problem.pool_of(fine);
  ExchangeOptions options;
  options.threads = thread_count(settings.threads);
  const std::size_t count = std::min(layout.positions(), pool.pool.candidates());
  const ExchangeResult exchanged = exchange_design(pool.pool, pool.base, problem.criterion(), count, options);
  std::size_t candidate = 0;
  for (PlanRun& run : fine.runs) {
    std::vector<PlanPosition> taken;
    for (const PlanPosition& position : run.positions) {
      if (exchanged.taken[candidate++] > 0) taken.push_back(position);
    }
    run.positions = std::move(taken);
  }
  return fine;
}

void append(const PlanLayout& more, PlanLayout& layout) {
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < more.stations_w.size(); ++i) {
    const auto known = std::ranges::find(layout.station_names, more.station_names[i]);
    place.push_back(static_cast<std::size_t>(known - layout.station_names.begin()));
    if (known != layout.station_names.end()) continue;
    layout.station_names.push_back(more.station_names[i]);
    layout.stations_w.push_back(more.stations_w[i]);
  }
  for (PlanRun run : more.runs) {
    run.station = place[run.station];
    layout.runs.push_back(std::move(run));
  }
}

}  // namespace volcal
