#include "volcal/sim/measurement/instruments.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/measurements.h"
#include "volcal/sim/measurement/noise.h"
#include "volcal/sim/measurement/rotary_poses.h"

namespace volcal::sim {
namespace {

constexpr int kMaxChannels = 3;
constexpr std::size_t kContactColumns = 1;  ///< column set of tip and normal

/// Directions and origins of a setup, from its commanded points.
struct SetupGeometry {
  Eigen::Vector3d first_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d line_w = Eigen::Vector3d::Zero();  ///< unit; zero when all points coincide
  Eigen::Vector3d centroid_w = Eigen::Vector3d::Zero();
};

using Channels = std::array<double, kMaxChannels>;

/// One reading without noise, and the standard deviation of its independent noise.
struct Reading {
  Channels value{};
  Channels sigma{};
  std::size_t channels = 1;
};

/// What a reading is taken of.
struct Sighting {
  const SetupPlan& plan;
  const InstrumentTruth& instrument;
  const SetupGeometry& geometry;
  const TruthMachine& machine;
  const MachineState& state;
  std::int32_t line;
  Eigen::Vector3d point_w;
  Eigen::Vector3d nominal_w;
  const CommandedPoint& commanded;
  Eigen::Vector3d nominal_tool;  ///< offset

  double sigma(double length) const { return std::hypot(plan.noise.constant, plan.noise.per_metre * length); }
  double offset() const {
    const auto found = instrument.line_offset.find(line);
    return found == instrument.line_offset.end() ? instrument.offset : found->second;
  }
  Eigen::Vector3d direction(const char* key) const {
    const auto given = plan.options.vector(key);
    return given ? given->normalized() : geometry.line_w;
  }
  Eigen::Vector3d from_station() const {
    const Eigen::Matrix4d& floor = instrument.floor;
    return floor.topLeftCorner<3, 3>() * point_w + floor.topRightCorner<3, 1>() - instrument.station;
  }
};

Reading read_tracer(const Sighting& sighting) {
  const InstrumentTruth& truth = sighting.instrument;
  const double distance = sighting.from_station().norm();
  return {{distance * (1.0 + truth.length_scale) - truth.dead_path}, {sighting.sigma(distance)}};
}

Reading read_tracker(const Sighting& sighting) {
  const InstrumentTruth& truth = sighting.instrument;
  const Eigen::Matrix3d rotation = rotation_321(truth.station_rotation).topLeftCorner<3, 3>();
  const Eigen::Vector3d v = rotation.transpose() * sighting.from_station();
  const double angle = sighting.plan.noise.angle;
  return {{v.norm() * (1.0 + truth.length_scale), std::atan2(v.y(), v.x()),
           std::atan2(v.z(), std::hypot(v.x(), v.y()))},
          {sighting.sigma(v.norm()), angle, angle},
          3};
}

Reading read_ball_bar(const Sighting& sighting) {
  const InstrumentTruth& truth = sighting.instrument;
  const double distance = (sighting.point_w - truth.centre).norm();
  return {{distance + truth.length_error}, {sighting.sigma(distance)}};
}

/// Coordinate direction most nearly across a beam, made exactly so.
Eigen::Vector3d across(const Eigen::Vector3d& beam) {
  Eigen::Index least = 0;
  beam.cwiseAbs().minCoeff(&least);
  return (Eigen::Vector3d::Unit(least) - beam[least] * beam).normalized();
}

Reading read_displacement(const Sighting& sighting) {
  const Eigen::Vector3d beam = sighting.direction("direction");
  const double angle = sighting.instrument.beam_angle;
  const Eigen::Vector3d actual_beam =
      angle == 0.0 ? beam : Eigen::Vector3d(std::cos(angle) * beam + std::sin(angle) * across(beam));
  const double along = actual_beam.dot(sighting.point_w - sighting.geometry.first_w);
  const double commanded = beam.dot(sighting.nominal_w - sighting.geometry.first_w);
  const double shown = along * (1.0 + sighting.instrument.length_scale) + sighting.offset();
  return {{sighting.plan.column_set == 1 ? shown - commanded : shown}, {sighting.sigma(commanded)}};
}

Reading read_straightness(const Sighting& sighting) {
  const Eigen::Vector3d direction = sighting.direction("direction");
  const Eigen::Vector3d& along = sighting.geometry.line_w;
  const double distance = along.dot(sighting.nominal_w - sighting.geometry.first_w);
  const double reference = direction.dot(sighting.instrument.artefact_rotation.cross(along)) * distance;
  return {{direction.dot(sighting.point_w - sighting.geometry.first_w) - reference + sighting.offset()},
          {sighting.sigma(distance)}};
}

Reading read_angle(const Sighting& sighting) {
  const std::string body = sighting.plan.options.text("body").value_or("relative");
  Eigen::Vector3d rotation = body == "table"  ? sighting.machine.table_rotation(sighting.state)
                             : body == "tool" ? sighting.machine.tool_rotation(sighting.state)
                                              : sighting.machine.relative_rotation(sighting.state);
  if (body != "relative") rotation += rotation_vector(sighting.instrument.floor.topLeftCorner<3, 3>());
  return {{rotation.dot(sighting.direction("axis")) + sighting.offset()}, {sighting.sigma(0.0)}};
}

Reading read_volumetric_points(const Sighting& sighting) {
  const RigidMotion& alignment = sighting.instrument.alignment;
  const Eigen::Vector3d error = sighting.point_w - sighting.nominal_w + alignment.translation +
                                alignment.rotation.cross(sighting.nominal_w);
  const double sigma = sighting.sigma((sighting.nominal_w - sighting.geometry.centroid_w).norm());
  return {{error.x(), error.y(), error.z()}, {sigma, sigma, sigma}, 3};
}

Reading read_r_test(const Sighting& sighting) {
  const std::string frame = sighting.plan.options.text("frame").value_or("workpiece");
  const Eigen::Matrix3d axes_w = axes_of_frame(sighting.machine, sighting.state, frame);
  const Eigen::Vector3d shown =
      axes_w.transpose() * (sighting.point_w - sighting.nominal_w) + sighting.instrument.sphere;
  const double sigma = sighting.sigma(0.0);
  return {{shown.x(), shown.y(), shown.z()}, {sigma, sigma, sigma}, 3};
}

/// The axes where the tip has gone on by `along` the normal.
CommandedPoint gone_on(const TruthMachine& machine, const Eigen::Vector3d& nominal_tool,
                       const CommandedPoint& point, double along) {
  return Follower(machine, nominal_tool).moved(point, along * point.normal_w);
}

/// How far along its normal the tip goes on from the commanded point until it touches.
Reading read_contact(const Sighting& sighting) {
  constexpr int kSteps = 4;  // each leaves a share of 1e-4 or so: errors change little over the way
  const InstrumentTruth& truth = sighting.instrument;
  const Eigen::Vector3d& normal_w = sighting.commanded.normal_w;
  const Eigen::Vector3d error_here =
      sighting.machine.point_error(sighting.state, sighting.nominal_tool);  // without tool and repeatability
  const Eigen::Vector3d other_w = sighting.point_w - sighting.nominal_w - error_here;
  double along = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    MachineState state = sighting.state;
    state.position = gone_on(sighting.machine, sighting.nominal_tool, sighting.commanded, along).position;
    const Eigen::Vector3d error_w = sighting.machine.point_error(state, sighting.nominal_tool) + other_w;
    along = normal_w.dot(truth.sphere - sighting.nominal_w - error_w) + truth.contact_radius;
  }
  return {{along}, {sighting.sigma(0.0)}};
}

bool reads_contacts(const SetupPlan& plan) {
  return plan.instrument == kProbedSphere && plan.column_set == kContactColumns;
}

Reading read_probed_sphere(const Sighting& sighting) {
  if (reads_contacts(sighting.plan)) return read_contact(sighting);
  const Eigen::Vector3d centre = sighting.instrument.sphere - (sighting.point_w - sighting.nominal_w);
  const double sigma = sighting.sigma(0.0);
  return {{centre.x(), centre.y(), centre.z()}, {sigma, sigma, sigma}, 3};
}

using ReadFunction = Reading (*)(const Sighting&);
struct SimulatedInstrument {
  std::string_view name;
  ReadFunction read;
  std::vector<std::vector<std::string_view>> columns;  ///< in files, by column set
};

const std::vector<SimulatedInstrument>& simulated_instruments() {
  static const std::vector<SimulatedInstrument> kInstruments = {
      {"laser-tracer", read_tracer, {{"length_mm"}}},
      {"laser-tracker", read_tracker, {{"length_mm", "azimuth_deg", "elevation_deg"}}},
      {"ball-bar", read_ball_bar, {{"length_mm"}}},
      {"displacement", read_displacement, {{"displacement_mm"}, {"deviation_um"}}},
      {"straightness", read_straightness, {{"deviation_um"}}},
      {"angle", read_angle, {{"angle_urad"}}},
      {"volumetric-points", read_volumetric_points, {{"ex_um", "ey_um", "ez_um"}}},
      {kRTest, read_r_test, {{"dx_um", "dy_um", "dz_um"}}},
      {kProbedSphere, read_probed_sphere, {{"cx_mm", "cy_mm", "cz_mm"}, {"reach_mm"}}},
  };
  return kInstruments;
}

ReadFunction find_instrument(const std::string& name) {
  for (const SimulatedInstrument& instrument : simulated_instruments()) {
    if (instrument.name == name) return instrument.read;
  }
  throw std::invalid_argument("instrument " + name + " is not simulated");
}

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

bool is_at_station(const SetupPlan& plan) {
  return plan.instrument == "laser-tracer" || plan.instrument == "laser-tracker";
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
  if (plan.instrument == "angle") return noise;
  noise.set("per_metre", plan.noise.per_metre);
  if (plan.instrument == "laser-tracker") noise.set("angle", plan.noise.angle);
  return noise;
}

/// Takes the readings of one setup, one after another.
class Measurer {
 public:
  Measurer(const SetupPlan& plan, const MeasuringConditions& conditions, double first_time)
      : plan_(plan),
        conditions_(conditions),
        first_time_(first_time),
        read_(find_instrument(plan.instrument)),
        geometry_(geometry_of(plan, conditions)) {}

  /// Nominal, to the station or the centre of a bar, or along a line.
  double length(const MachineState& state) const {
    const TruthMachine& truth = conditions_.machine;
    const Eigen::Vector3d nominal_w = truth.nominal_point(state, truth.machine().tools.at(plan_.tool).offset);
    if (is_at_station(plan_)) return (nominal_w - plan_.truth.station).norm();
    if (plan_.instrument == "ball-bar") return (nominal_w - plan_.truth.centre).norm();
    if (plan_.instrument == "volumetric-points") return (nominal_w - geometry_.centroid_w).norm();
    if (plan_.instrument == "straightness")
      return std::abs(geometry_.line_w.dot(nominal_w - geometry_.first_w));
    if (plan_.instrument != "displacement") return 0.0;
    const Eigen::Vector3d beam = plan_.options.vector("direction").value_or(geometry_.line_w).normalized();
    return std::abs(beam.dot(nominal_w - geometry_.first_w));
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
    Reading reading = read_({plan_, instrument, geometry_, truth, state, point.line,
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
  ReadFunction read_;
  SetupGeometry geometry_;
};

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

/// Tracker's angles are not moved by the machine's repeatability as lengths are.
double independent_sigma(const SetupPlan& plan, const Reading& reading, std::size_t channel) {
  const bool is_length = plan.instrument != "angle" && (plan.instrument != "laser-tracker" || channel == 0);
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
  for (const SimulatedInstrument& instrument : simulated_instruments()) {
    if (instrument.name != plan.instrument || plan.column_set >= instrument.columns.size()) continue;
    const auto& columns = instrument.columns[plan.column_set];
    if (channel < columns.size()) return std::string(columns[channel]);
  }
  return {};
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
