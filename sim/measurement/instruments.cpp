#include "volcal/sim/measurement/instruments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/noise.h"
#include "volcal/sim/measurement/simulated_instruments.h"

namespace volcal::sim {
namespace {

/// How far each axis has gone since it last turned round. It comes to its first point from far. Where it
/// moves against the direction in which it reaches a point, or turns on the spot, it overruns the point and
/// comes back.
class Turns {
 public:
  const std::array<double, kAxisCount>& advance(const CommandedPoint& point) {
    for (std::size_t k = 0; k < kAxisCount; ++k) {
      if (previous_ == nullptr) {
        travelled_[k] = std::numeric_limits<double>::infinity();
        continue;
      }
      const double move = point.position[k] - previous_->position[k];
      const double forward = point.direction[k] == 0 ? std::abs(move) : point.direction[k] * move;
      const bool turned = forward < 0.0 || point.direction[k] != previous_->direction[k];
      travelled_[k] = !turned ? travelled_[k] + forward : forward > 0.0 ? forward : kOverrun;
    }
    previous_ = &point;
    return travelled_;
  }

 private:
  static constexpr double kOverrun = 1e-3;
  const CommandedPoint* previous_ = nullptr;
  std::array<double, kAxisCount> travelled_{};
};

/// How far each axis goes at most after it has turned round.
std::array<double, kAxisCount> farthest_since_turning(const SetupPlan& plan) {
  std::array<double, kAxisCount> farthest{};
  Turns turns;
  for (const CommandedPoint& point : plan.points) {
    const auto& travelled = turns.advance(point);
    for (std::size_t k = 0; k < kAxisCount; ++k) {
      if (std::isfinite(travelled[k])) farthest[k] = std::max(farthest[k], travelled[k]);
    }
  }
  return farthest;
}

MachineState state_at(const CommandedPoint& point, const SetupPlan& plan,
                      const MeasuringConditions& conditions, double time) {
  const bool settled = conditions.at_reference_temperature;
  return {
      point.position,
      point.direction,
      time,
      settled ? conditions.environment.reference_temperatures() : conditions.environment.temperatures(time),
      plan.tool,
      point.velocity,
      {},
      settled,
      {},
      0.0,
      plan.name,
      plan.options.text("station").value_or("")};
}

SetupGeometry geometry_of(const SetupPlan& plan, const MeasuringConditions& conditions) {
  const Eigen::Vector3d& tool = conditions.machine.machine().tools.at(plan.tool).offset;
  const auto nominal = [&](const CommandedPoint& point) {
    return conditions.machine.nominal_point({point.position, point.direction, 0.0, {}}, tool);
  };
  SetupGeometry geometry;
  geometry.first_w = nominal(plan.points.front());
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const CommandedPoint& point : plan.points) {
    const Eigen::Vector3d path = nominal(point) - geometry.first_w;
    if (path.norm() > farthest.norm()) farthest = path;
    geometry.centroid_w += path / static_cast<double>(plan.points.size());
  }
  geometry.centroid_w += geometry.first_w;
  constexpr double kSamePoint = 1e-9;
  Eigen::Vector3d path = nominal(plan.points.back()) - geometry.first_w;
  if (path.norm() < kSamePoint) path = farthest;
  geometry.line_w = path.norm() > 0.0 ? path.normalized() : path;
  return geometry;
}

/// Columns that describe how a point was reached.
void append_point(const CommandedPoint& point, const MachineState& state, const Machine& machine,
                  bool records_feed, Readings& readings) {
  const bool has_direction = std::ranges::any_of(point.direction, [](std::int8_t d) { return d != 0; });
  for (const Axis& axis : machine.axes) {
    const std::size_t k = index_of(axis.name);
    readings.position[k].push_back(point.position[k]);
    if (has_direction || !readings.direction[k].empty()) readings.direction[k].push_back(point.direction[k]);
  }
  readings.time.push_back(state.time);
  readings.line.push_back(point.line);
  readings.run.push_back(point.run);
  if (records_feed) readings.feed.push_back(state.feed());
  for (const auto& [channel, value] : state.temperature) readings.temperature[channel].push_back(value);
  readings.source_line.push_back(static_cast<std::int64_t>(readings.source_line.size()) + 2);
}

Options noise_options(const SetupPlan& plan) {
  Options noise;
  noise.set("constant", plan.noise.constant);
  const SimulatedInstrument& instrument = simulated_instrument(plan);
  if (instrument.reads_angle) return noise;
  noise.set("per_metre", plan.noise.per_metre);
  if (!instrument.encoders.empty()) noise.set("angle", plan.noise.angle);
  return noise;
}

/// Takes the readings of one setup, one after another.
class Measurer {
 public:
  Measurer(const SetupPlan& plan, const MeasuringConditions& conditions, double first_time)
      : plan_(plan),
        conditions_(conditions),
        first_time_(first_time),
        instrument_(simulated_instrument(plan)),
        geometry_(geometry_of(plan, conditions)) {}

  /// Nominal, to the station or the centre of a bar, or along a line.
  double length(const MachineState& state) const {
    const TruthMachine& truth = conditions_.machine;
    const Eigen::Vector3d nominal_w = truth.nominal_point(state, truth.machine().tools.at(plan_.tool).offset);
    return instrument_.length(plan_, geometry_, nominal_w);
  }

  /// Without the instrument's noise; `repeatability` is the machine's.
  Reading read(const CommandedPoint& point, const MachineState& state,
               const Eigen::Vector3d& repeatability) const {
    const TruthMachine& truth = conditions_.machine;
    const Occasion occasion{plan_, point, state, first_time_};
    Eigen::Vector3d tool = conditions_.tool_offsets.at(plan_.tool);
    InstrumentTruth instrument = plan_.truth;
    if (conditions_.interference) {
      for (const auto& change : conditions_.interference->tool) tool += change(occasion);
      for (const auto& change : conditions_.interference->instrument) change(occasion, instrument);
    }
    const Eigen::Vector3d& nominal_tool = truth.machine().tools.at(plan_.tool).offset;
    Reading reading = instrument_.read({plan_, instrument, geometry_, truth, state, point.line,
                                        truth.point(state, tool) + repeatability,
                                        truth.nominal_point(state, nominal_tool), point, nominal_tool});
    if (!conditions_.interference) return reading;
    const Channels undisturbed = reading.value;
    for (const auto& error : conditions_.interference->reading) {
      for (std::size_t k = 0; k < reading.channels; ++k) {
        reading.value[k] += error(occasion, k, undisturbed[k]);
      }
    }
    return reading;
  }

 private:
  const SetupPlan& plan_;
  const MeasuringConditions& conditions_;
  double first_time_;
  const SimulatedInstrument& instrument_;
  SetupGeometry geometry_;
};

bool reads_contacts(const SetupPlan& plan) { return simulated_instrument(plan).contacts == plan.column_set; }

/// What the file says of one reading: where the axes stood, and the columns.
struct Record {
  CommandedPoint point;
  std::vector<double> columns;
};

Record recorded(const SetupPlan& plan, const TruthMachine& machine, const CommandedPoint& point,
                const Reading& reading) {
  if (!reads_contacts(plan))
    return {point,
            {reading.value.begin(), reading.value.begin() + static_cast<std::ptrdiff_t>(reading.channels)}};
  const Eigen::Vector3d& tool = machine.machine().tools.at(plan.tool).offset;
  const CommandedPoint touching = gone_on(machine, tool, point, reading.value[0]);
  MachineState state;
  state.position = touching.position;
  const Eigen::Vector3d tip_w = machine.nominal_point(state, tool);
  const Eigen::Vector3d& normal_w = point.normal_w;
  return {touching, {tip_w.x(), tip_w.y(), tip_w.z(), normal_w.x(), normal_w.y(), normal_w.z()}};
}

Setup described(const SetupPlan& plan) {
  Setup setup;
  setup.name = plan.name;
  setup.instrument = plan.instrument;
  setup.tool = plan.tool;
  setup.options = plan.options;
  setup.noise = noise_options(plan);
  setup.has_noise = true;
  setup.repeatability = plan.noise.repeatability;
  setup.readings.column_set = plan.column_set;
  return setup;
}

/// Encoders' angles are not moved by the machine's repeatability as lengths are.
double independent_sigma(const SetupPlan& plan, const Reading& reading, std::size_t channel) {
  const SimulatedInstrument& instrument = simulated_instrument(plan);
  const bool is_length = !instrument.reads_angle && instrument.encoder(channel, plan.column_set).empty();
  return std::hypot(reading.sigma[channel], is_length ? plan.noise.repeatability : 0.0);
}

/// Tip and normal are given; the reading is the tip along the normal.
void give_contacts(Readings& readings) {
  readings.given = std::move(readings.value);
  std::vector<double> reach(readings.size(), 0.0);
  for (std::size_t row = 0; row < reach.size(); ++row) {
    for (std::size_t k = 0; k < 3; ++k) reach[row] += readings.given[k][row] * readings.given[k + 3][row];
  }
  readings.value = {std::move(reach)};
}

}  // namespace

std::string column_read(const SetupPlan& plan, std::size_t channel) {
  const SimulatedInstrument* instrument = find_simulated(plan.instrument);
  if (instrument == nullptr || plan.column_set >= instrument->columns.size()) return {};
  const auto& columns = instrument->columns[plan.column_set];
  return channel < columns.size() ? std::string(columns[channel]) : std::string();
}

Setup measure(const SetupPlan& plan, const MeasuringConditions& conditions, double start_time) {
  if (plan.points.empty()) throw std::invalid_argument("setup " + plan.name + " has no points");
  const Measurer measurer(plan, conditions, start_time);
  const CorrelatedNoise correlated(plan, conditions.seed);
  RandomStream random(conditions.seed, "noise of " + plan.name);
  Turns turns;
  const std::array<double, kAxisCount> farthest = farthest_since_turning(plan);
  Setup setup = described(plan);
  double time = start_time;
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    const CommandedPoint& point = plan.points[row];
    MachineState state = state_at(point, plan, conditions, time);
    state.since_reversal = turns.advance(point);
    state.farthest = farthest;
    state.length = measurer.length(state);
    Eigen::Vector3d repeatability = Eigen::Vector3d::Zero();
    if (!conditions.noise_free) repeatability = plan.noise.repeatability * random.normal_vector();
    Reading reading = measurer.read(point, state, repeatability);
    if (!conditions.noise_free) {
      for (std::size_t k = 0; k < reading.channels; ++k) {
        reading.value[k] +=
            reading.sigma[k] * random.normal() + correlated.slow(row, k) +
            correlated.outlier(row, k) * plan.noise.outlier_size * independent_sigma(plan, reading, k);
      }
    }
    const Record record = recorded(plan, conditions.machine, point, reading);
    setup.readings.value.resize(record.columns.size());
    for (std::size_t k = 0; k < record.columns.size(); ++k)
      setup.readings.value[k].push_back(record.columns[k]);
    append_point(record.point, state, conditions.machine.machine(), plan.records_feed, setup.readings);
    time += plan.seconds_per_reading;
  }
  if (reads_contacts(plan)) give_contacts(setup.readings);
  return setup;
}

}  // namespace volcal::sim
