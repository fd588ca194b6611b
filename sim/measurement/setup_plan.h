#pragma once
/// One setup before it is measured: commanded positions, what the campaign file will say of it, and the true
/// values of what the campaign file does not know. m, rad, s; workpiece coordinates.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "volcal/model/description/schema.h"
#include "volcal/model/description/symbols.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {

struct CommandedPoint {
  std::array<double, kAxisCount> position{};        ///< m or rad
  std::array<std::int8_t, kAxisCount> direction{};  ///< of approach, -1, 0 (not recorded), +1
  std::int32_t line = 0;
  std::int32_t run = 0;
  std::array<double, kAxisCount> velocity{};  ///< while the reading is taken, m/s or rad/s; 0 = stands
  /// Of a single contact: outward normal of the sphere, workpiece coordinates.
  Eigen::Vector3d normal_w = Eigen::Vector3d::Zero();
};

/// What stands between a reading and the truth. The campaign file states the first four alone, which are
/// independent between readings; the others have random streams of their own, so that one can be added
/// without changing the rest. Correlated drift and line offsets act on lengths (`angle` readings: on the
/// angle) and are independent between the components of a reading.
struct NoiseLevel {
  double constant = 0.0;       ///< m; rad for angle readings
  double per_metre = 0.0;      ///< m per m of measured length
  double angle = 0.0;          ///< rad, azimuth and elevation of a tracker
  double repeatability = 0.0;  ///< m, of the machine, per component
  double drift = 0.0;  ///< m; rad for angle readings: standard deviation of an Ornstein-Uhlenbeck process
  double drift_time = 600.0;   ///< s, in which its correlation falls to 1/e; each setup has its own
  double line = 0.0;           ///< m; rad for angle readings: offset that the readings of one line share
  double outlier_share = 0.0;  ///< of the readings that are wrong altogether
  double outlier_size = 8.0;   ///< by how much, as a multiple of the independent standard deviation
};

/// True values of an instrument's nuisance quantities; those that an instrument does not have are ignored.
struct InstrumentTruth {
  Eigen::Vector3d station = Eigen::Vector3d::Zero();
  Eigen::Vector3d station_rotation = Eigen::Vector3d::Zero();  ///< 3-2-1 angles, station frame to workpiece
  double dead_path = 0.0;
  double length_scale = 0.0;  ///< relative error of every length
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double length_error = 0.0;
  double offset = 0.0;                         ///< m, or rad for angles
  std::map<std::int32_t, double> line_offset;  ///< replaces `offset` for its lines
  Eigen::Vector3d artefact_rotation = Eigen::Vector3d::Zero();
  RigidMotion alignment;
  Eigen::Matrix4d floor = Eigen::Matrix4d::Identity();  ///< machine's coordinates to those of the floor
  double beam_angle = 0.0;                              ///< of a displacement's beam against its path, rad
  /// r-test: added to the readings, in their frame; probed-sphere: the centre.
  Eigen::Vector3d sphere = Eigen::Vector3d::Zero();
  double contact_radius = 0.0;  ///< sphere centre to tip at a contact
};

struct SetupPlan {
  std::string name;
  std::string instrument;
  std::size_t tool = 0;
  std::vector<CommandedPoint> points;
  /// displacement: 1 = deviation from the commanded displacement; probed-sphere: 1 = single contacts
  std::size_t column_set = 0;
  double seconds_per_reading = 4.0;
  NoiseLevel noise;
  Options options;  ///< keys of the instrument's schema, SI
  InstrumentTruth truth;
  bool records_feed = false;
  bool with_setup_before = false;  ///< read at the same times, by further channels of one instrument
  /// Poses that were asked for and lie beyond the travel of these linear axes.
  std::size_t poses_left_out = 0;
  std::string left_out_by;
  std::vector<CommandedPoint> unseen;  ///< other positions, point by point at the same time; may be empty
};

}  // namespace volcal::sim
