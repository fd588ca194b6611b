#include "volcal/sim/measurement/simulated_instruments.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/measurements.h"
#include "volcal/sim/measurement/rotary_poses.h"

namespace volcal::sim {
namespace {

constexpr std::size_t kContactColumns = 1;  ///< column set of tip and normal

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

Reading read_probed_sphere(const Sighting& sighting) {
  if (sighting.plan.column_set == kContactColumns) return read_contact(sighting);
  const Eigen::Vector3d centre = sighting.instrument.sphere - (sighting.point_w - sighting.nominal_w);
  const double sigma = sighting.sigma(0.0);
  return {{centre.x(), centre.y(), centre.z()}, {sigma, sigma, sigma}, 3};
}

double to_station(const SetupPlan& plan, const SetupGeometry&, const Eigen::Vector3d& nominal_w) {
  return (nominal_w - plan.truth.station).norm();
}

double to_centre(const SetupPlan& plan, const SetupGeometry&, const Eigen::Vector3d& nominal_w) {
  return (nominal_w - plan.truth.centre).norm();
}

double to_centroid(const SetupPlan&, const SetupGeometry& geometry, const Eigen::Vector3d& nominal_w) {
  return (nominal_w - geometry.centroid_w).norm();
}

double along_line(const SetupPlan&, const SetupGeometry& geometry, const Eigen::Vector3d& nominal_w) {
  return std::abs(geometry.line_w.dot(nominal_w - geometry.first_w));
}

double along_beam(const SetupPlan& plan, const SetupGeometry& geometry, const Eigen::Vector3d& nominal_w) {
  const Eigen::Vector3d beam = plan.options.vector("direction").value_or(geometry.line_w).normalized();
  return std::abs(beam.dot(nominal_w - geometry.first_w));
}

}  // namespace

// One line per instrument.
const std::vector<SimulatedInstrument>& simulated_instruments() {
  static const std::vector<SimulatedInstrument> kInstruments = {
      {.name = kLaserTracer,
       .read = read_tracer,
       .columns = {{"length_mm"}},
       .length = to_station,
       .is_laser = true,
       .has_station = true},
      {.name = kLaserTracker,
       .read = read_tracker,
       .columns = {{"length_mm", "azimuth_deg", "elevation_deg"}},
       .length = to_station,
       .is_laser = true,
       .has_station = true,
       .encoders = {"azimuth", "elevation"}},
      {.name = kBallBar, .read = read_ball_bar, .columns = {{"length_mm"}}, .length = to_centre},
      {.name = kDisplacementReader,
       .read = read_displacement,
       .columns = {{"displacement_mm"}, {"deviation_um"}},
       .length = along_beam,
       .is_laser = true},
      {.name = kStraightnessReader,
       .read = read_straightness,
       .columns = {{"deviation_um"}},
       .length = along_line},
      {.name = kAngleReader, .read = read_angle, .columns = {{"angle_urad"}}, .reads_angle = true},
      {.name = kVolumetricPoints,
       .read = read_volumetric_points,
       .columns = {{"ex_um", "ey_um", "ez_um"}},
       .length = to_centroid},
      {.name = kRTest, .read = read_r_test, .columns = {{"dx_um", "dy_um", "dz_um"}}},
      {.name = kProbedSphere,
       .read = read_probed_sphere,
       .columns = {{"cx_mm", "cy_mm", "cz_mm"}, {"reach_mm"}},
       .contacts = kContactColumns},
  };
  return kInstruments;
}

const SimulatedInstrument* find_simulated(std::string_view name) {
  const auto& all = simulated_instruments();
  const auto found = std::ranges::find(all, name, &SimulatedInstrument::name);
  return found == all.end() ? nullptr : &*found;
}

const SimulatedInstrument& simulated_instrument(const SetupPlan& plan) {
  if (const SimulatedInstrument* instrument = find_simulated(plan.instrument)) return *instrument;
  throw std::invalid_argument("instrument " + plan.instrument + " is not simulated");
}

std::string_view SimulatedInstrument::encoder(std::size_t channel, std::size_t column_set) const {
  const std::size_t first = channels_before_encoders(column_set);
  if (channel < first || channel - first >= encoders.size()) return {};
  return encoders[channel - first];
}

bool reads_encoder(const SetupPlan& plan, std::size_t channel, std::string_view encoder) {
  return simulated_instrument(plan).encoder(channel, plan.column_set) == encoder;
}

CommandedPoint gone_on(const TruthMachine& machine, const Eigen::Vector3d& nominal_tool,
                       const CommandedPoint& point, double along) {
  return Follower(machine, nominal_tool).moved(point, along * point.normal_w);
}

}  // namespace volcal::sim
