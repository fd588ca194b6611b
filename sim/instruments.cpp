#include "volcal/sim/instruments.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/sim/random.h"
#include "volcal/sim/transforms.h"

namespace volcal::sim {
namespace {

constexpr int kMaxChannels = 3;

/// Directions and origins of a setup, from its commanded points.
struct SetupGeometry {
  Eigen::Vector3d first_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d line_w = Eigen::Vector3d::Zero();  ///< unit; zero when all points coincide
  Eigen::Vector3d centroid_w = Eigen::Vector3d::Zero();
};

/// One reading about to be taken.
struct Sighting {
  const SetupPlan& plan;
  const SetupGeometry& geometry;
  const TruthMachine& machine;
  const MachineState& state;
  std::int32_t line;
  Eigen::Vector3d point_w;
  Eigen::Vector3d nominal_w;
  RandomStream& random;

  double noise(double length) const {
    const NoiseLevel& level = plan.noise;
    return std::hypot(level.constant, level.per_metre * length) * random.normal();
  }
  double offset() const {
    const auto found = plan.truth.line_offset.find(line);
    return found == plan.truth.line_offset.end() ? plan.truth.offset : found->second;
  }
  Eigen::Vector3d direction(const char* key) const {
    const auto given = plan.options.vector(key);
    return given ? given->normalized() : geometry.line_w;
  }
};

using Channels = std::array<double, kMaxChannels>;

int read_tracer(const Sighting& sighting, Channels& value) {
  const InstrumentTruth& truth = sighting.plan.truth;
  const double distance = (sighting.point_w - truth.station).norm();
  value[0] = distance * (1.0 + truth.length_scale) - truth.dead_path + sighting.noise(distance);
  return 1;
}

int read_tracker(const Sighting& sighting, Channels& value) {
  const InstrumentTruth& truth = sighting.plan.truth;
  const Eigen::Matrix3d rotation = rotation_321(truth.station_rotation).topLeftCorner<3, 3>();
  const Eigen::Vector3d v = rotation.transpose() * (sighting.point_w - truth.station);
  value[0] = v.norm() * (1.0 + truth.length_scale) + sighting.noise(v.norm());
  value[1] = std::atan2(v.y(), v.x()) + sighting.plan.noise.angle * sighting.random.normal();
  value[2] =
      std::atan2(v.z(), std::hypot(v.x(), v.y())) + sighting.plan.noise.angle * sighting.random.normal();
  return 3;
}

int read_ball_bar(const Sighting& sighting, Channels& value) {
  const InstrumentTruth& truth = sighting.plan.truth;
  const double distance = (sighting.point_w - truth.centre).norm();
  value[0] = distance + truth.length_error + sighting.noise(distance);
  return 1;
}

int read_displacement(const Sighting& sighting, Channels& value) {
  const Eigen::Vector3d beam = sighting.direction("direction");
  const double along = beam.dot(sighting.point_w - sighting.geometry.first_w);
  const double commanded = beam.dot(sighting.nominal_w - sighting.geometry.first_w);
  value[0] = along * (1.0 + sighting.plan.truth.length_scale) + sighting.offset() + sighting.noise(commanded);
  if (sighting.plan.column_set == 1) value[0] -= commanded;
  return 1;
}

int read_straightness(const Sighting& sighting, Channels& value) {
  const Eigen::Vector3d across = sighting.direction("direction");
  const Eigen::Vector3d& along = sighting.geometry.line_w;
  const double distance = along.dot(sighting.nominal_w - sighting.geometry.first_w);
  const double reference = across.dot(sighting.plan.truth.artefact_rotation.cross(along)) * distance;
  value[0] = across.dot(sighting.point_w - sighting.geometry.first_w) - reference + sighting.offset() +
             sighting.noise(distance);
  return 1;
}

int read_angle(const Sighting& sighting, Channels& value) {
  const std::string body = sighting.plan.options.text("body").value_or("relative");
  const Eigen::Vector3d rotation = body == "table"  ? sighting.machine.table_rotation(sighting.state)
                                   : body == "tool" ? sighting.machine.tool_rotation(sighting.state)
                                                    : sighting.machine.relative_rotation(sighting.state);
  value[0] = rotation.dot(sighting.direction("axis")) + sighting.offset() + sighting.noise(0.0);
  return 1;
}

int read_volumetric_points(const Sighting& sighting, Channels& value) {
  const RigidMotion& alignment = sighting.plan.truth.alignment;
  const Eigen::Vector3d error = sighting.point_w - sighting.nominal_w + alignment.translation +
                                alignment.rotation.cross(sighting.nominal_w);
  const double arm = (sighting.nominal_w - sighting.geometry.centroid_w).norm();
  for (int k = 0; k < 3; ++k) value[static_cast<std::size_t>(k)] = error[k] + sighting.noise(arm);
  return 3;
}

using ReadFunction = int (*)(const Sighting&, Channels&);
struct SimulatedInstrument {
  std::string_view name;
  ReadFunction read;  ///< fills the channels and returns their number
};

constexpr std::array<SimulatedInstrument, 7> kInstruments = {{
    {"laser-tracer", read_tracer},
    {"laser-tracker", read_tracker},
    {"ball-bar", read_ball_bar},
    {"displacement", read_displacement},
    {"straightness", read_straightness},
    {"angle", read_angle},
    {"volumetric-points", read_volumetric_points},
}};

ReadFunction find_instrument(const std::string& name) {
  const auto found = std::ranges::find(kInstruments, name, &SimulatedInstrument::name);
  if (found == kInstruments.end()) throw std::invalid_argument("instrument " + name + " is not simulated");
  return found->read;
}

MachineState state_at(const CommandedPoint& point, const MeasuringConditions& conditions, double time) {
  return {point.position, point.direction, time,
          conditions.at_reference_temperature ? conditions.environment.reference_temperatures()
                                              : conditions.environment.temperatures(time)};
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
                  Readings& readings) {
  const bool has_direction = std::ranges::any_of(point.direction, [](std::int8_t d) { return d != 0; });
  for (const Axis& axis : machine.axes) {
    const std::size_t k = index_of(axis.name);
    readings.position[k].push_back(point.position[k]);
    if (has_direction || !readings.direction[k].empty()) readings.direction[k].push_back(point.direction[k]);
  }
  readings.time.push_back(state.time);
  readings.line.push_back(point.line);
  readings.run.push_back(point.run);
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

}  // namespace

Setup measure(const SetupPlan& plan, const MeasuringConditions& conditions, double start_time) {
  if (plan.points.empty()) throw std::invalid_argument("setup " + plan.name + " has no points");
  const ReadFunction read = find_instrument(plan.instrument);
  const TruthMachine& truth = conditions.machine;
  const SetupGeometry geometry = geometry_of(plan, conditions);
  const Eigen::Vector3d& nominal_tool = truth.machine().tools.at(plan.tool).offset;
  RandomStream random(conditions.seed, "noise of " + plan.name);

  Setup setup;
  setup.name = plan.name;
  setup.instrument = plan.instrument;
  setup.tool = plan.tool;
  setup.options = plan.options;
  setup.noise = noise_options(plan);
  setup.has_noise = true;
  setup.repeatability = plan.noise.repeatability;
  setup.readings.column_set = plan.column_set;
  double time = start_time;
  for (const CommandedPoint& point : plan.points) {
    const MachineState state = state_at(point, conditions, time);
    const Eigen::Vector3d point_w = truth.point(state, conditions.tool_offsets.at(plan.tool)) +
                                    plan.noise.repeatability * random.normal_vector();
    const Sighting sighting{
        plan, geometry, truth, state, point.line, point_w, truth.nominal_point(state, nominal_tool), random};
    Channels value{};
    const auto channels = static_cast<std::size_t>(read(sighting, value));
    setup.readings.value.resize(channels);
    for (std::size_t k = 0; k < channels; ++k) setup.readings.value[k].push_back(value[k]);
    append_point(point, state, truth.machine(), setup.readings);
    time += plan.seconds_per_reading;
  }
  return setup;
}

}  // namespace volcal::sim
