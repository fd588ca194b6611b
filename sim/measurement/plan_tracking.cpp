#include <algorithm>
#include <map>

#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/measurement/plan_tools.h"
#include "volcal/sim/measurement/simulated_instruments.h"

namespace volcal::sim {
namespace {

double longest_linear_travel(const Machine& machine) {
  double longest = 0.0;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) longest = std::max(longest, axis.travel());
  }
  return longest;
}

/// Around the volume, below its middle, at unequal distances (shares of the travel beyond its ends). Where a
/// linear axis is missing, to both sides of the plane or line in which the others move: lengths from stations
/// in it change with displacements out of it by their squares alone.
std::vector<Tracking::Station> standard_stations(const Machine& machine) {
  const std::vector<Eigen::Vector3d> shares = {
      {-0.25, -0.2, -0.13}, {1.25, -0.3, -0.3}, {1.2, 1.3, -0.25}, {-0.2, 1.25, -0.45}};
  std::vector<Tracking::Station> stations;
  for (const Eigen::Vector3d& share : shares) {
    const CommandedPoint point = at_fraction(machine, share);
    Eigen::Vector3d station_w(point.position[0], point.position[1], point.position[2]);
    for (const AxisName axis : kLinearAxes) {
      const int d = direction_of(axis);
      if (!machine.has_axis(axis)) station_w[d] = (share[d] - 0.5) * longest_linear_travel(machine);
    }
    stations.push_back({"P" + std::to_string(stations.size() + 1), station_w});
  }
  return stations;
}

std::string names_with_station() {
  std::string names;
  for (const SimulatedInstrument& instrument : simulated_instruments()) {
    if (instrument.has_station) names += (names.empty() ? "" : " or ") + std::string(instrument.name);
  }
  return names;
}

/// Two runs per station, so that each tool is seen from at least two stations.
std::vector<Tracking::Run> standard_runs(const Machine& machine,
                                         const std::vector<Tracking::Station>& stations) {
  constexpr std::array<std::array<std::size_t, 2>, 4> kTools = {{{0, 1}, {0, 2}, {1, 2}, {0, 2}}};
  const std::size_t last = std::min<std::size_t>(machine.tools.size(), 3) - 1;
  std::vector<Tracking::Run> runs;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    for (const std::size_t tool : kTools[i % kTools.size()]) {
      runs.push_back({stations[i].name, machine.tools[std::min(tool, last)].name});
    }
  }
  return runs;
}

class TrackingPlanner {
 public:
  TrackingPlanner(const Tracking& settings, const PlanContext& context)
      : settings_(settings), context_(context), nominal_(context.machine) {
    context.tool("");
    if (settings.rotary != RotaryMotion::Home) require_rotary_axes(context);
    stations_ = settings.stations.empty() ? standard_stations(context.machine) : settings.stations;
    runs_ = settings.runs.empty() ? standard_runs(context.machine, stations_) : settings.runs;
    context.require_at_least(settings.revisits, 0, "revisits");
    const std::vector<Tracking::Run> once = runs_;
    for (int i = 0; i < settings.revisits; ++i) runs_.insert(runs_.end(), once.begin(), once.end());
    for (const int count : settings.grid) context.require_at_least(count, 2, "grid");
    if (settings.length_scale_sigma) {
      RandomStream random(context.seed, "length scale " + context.prefix);
      length_scale_ = *settings.length_scale_sigma * random.normal();
    }
  }

  std::vector<SetupPlan> plans() {
    std::vector<SetupPlan> planned;
    for (const Tracking::Run& run : runs_) planned.push_back(plan(run));
    return planned;
  }

 private:
  const Tracking::Station& station_of(const Tracking::Run& run) const {
    const auto found = std::ranges::find(stations_, run.station, &Tracking::Station::name);
    if (found == stations_.end()) {
      context_.fail("there is no station \"" + run.station + "\"", "list it among the stations");
    }
    return *found;
  }

  std::string unique_name(const Tracking::Run& run) {
    const std::string name = context_.prefix + run.station + "_" + run.tool;
    const int uses = ++uses_[name];
    return uses == 1 ? name : name + "_" + std::to_string(uses);
  }

  SetupPlan plan(const Tracking::Run& run) {
    const Tracking::Station& station = station_of(run);
    SetupPlan plan;
    plan.name = unique_name(run);
    plan.instrument = settings_.instrument;
    plan.tool = context_.tool(run.tool);
    plan.seconds_per_reading = settings_.seconds_per_reading;
    plan.noise = settings_.noise;
    RandomStream random(context_.seed, "setup " + plan.name);
    RandomStream elsewhere(context_.seed, "unseen positions of " + plan.name);
    if (run.points.empty()) {
      plan.points = jittered_grid_path(context_.machine, settings_.grid, settings_.jitter, random);
      plan.unseen = jittered_grid_path(context_.machine, settings_.grid, settings_.jitter, elsewhere);
      const RotaryGrid& rotary = settings_.rotary_grid;
      add_rotary_motion(context_.machine, settings_.rotary, rotary, true, random, plan.points);
      add_rotary_motion(context_.machine, settings_.rotary, rotary, true, elsewhere, plan.unseen);
      if (settings_.parallel_moves) {
        RandomStream parallel(context_.seed, "parallel axes of " + plan.name);
        add_parallel_motion(context_.machine, true, parallel, plan.points);
        add_parallel_motion(context_.machine, true, parallel, plan.unseen);
      }
    } else {
      plan.points = run.points;
      plan.unseen = points_between(run.points, elsewhere);
    }
    plan.truth.station = station.position_w;
    plan.truth.length_scale = length_scale_;
    const bool has_frame = !find_simulated(settings_.instrument)->encoders.empty();
    if (!has_frame) {  // its lengths count from a zero
      const CommandedPoint& first = plan.points.front();
      const Eigen::Vector3d start_w = nominal_.nominal_point({first.position, first.direction, 0.0, {}},
                                                             context_.machine.tools[plan.tool].offset);
      plan.truth.dead_path =
          (start_w - station.position_w).norm() + settings_.dead_path_spread * random.normal();
    } else {
      plan.truth.station_rotation = settings_.station_rotation_spread * random.normal_vector();
    }
    set_options(station, random, plan);
    return plan;
  }

  void set_options(const Tracking::Station& station, RandomStream& random, SetupPlan& plan) const {
    const double error = settings_.station_sigma ? *settings_.station_sigma : settings_.station_guess_error;
    const Eigen::Vector3d guess = station.position_w + error * random.normal_vector();
    plan.options.set("station", context_.prefix + station.name);
    plan.options.set("station", stated_position(guess, 0.1));
    if (settings_.station_sigma) plan.options.set("station_sigma", *settings_.station_sigma);
    if (settings_.length_scale_sigma) {
      plan.options.set("scale_sigma", *settings_.length_scale_sigma);
      plan.options.set("scale_group", context_.prefix + "interferometer");
    }
  }

  const Tracking& settings_;
  const PlanContext& context_;
  TruthMachine nominal_;
  std::vector<Tracking::Station> stations_;
  std::vector<Tracking::Run> runs_;
  double length_scale_ = 0.0;
  std::map<std::string, int> uses_;
};

}  // namespace

std::vector<SetupPlan> plan_tracking(const Tracking& settings, const PlanContext& context) {
  const SimulatedInstrument* instrument = find_simulated(settings.instrument);
  if (instrument == nullptr || !instrument->has_station)
    context.fail("\"" + settings.instrument + "\" does not track", "use " + names_with_station());
  return TrackingPlanner(settings, context).plans();
}

}  // namespace volcal::sim
