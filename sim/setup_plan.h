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
#include "volcal/sim/transforms.h"

namespace volcal::sim {

struct CommandedPoint {
  std::array<double, kAxisCount> position{};        ///< m or rad
  std::array<std::int8_t, kAxisCount> direction{};  ///< of approach, -1, 0 (not recorded), +1
  std::int32_t line = 0;
  std::int32_t run = 0;
};

/// Standard deviations, independent between readings.
struct NoiseLevel {
  double constant = 0.0;       ///< m; rad for angle readings
  double per_metre = 0.0;      ///< m per m of measured length
  double angle = 0.0;          ///< rad, azimuth and elevation of a tracker
  double repeatability = 0.0;  ///< m, of the machine, per component
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
};

struct SetupPlan {
  std::string name;
  std::string instrument;
  std::size_t tool = 0;
  std::vector<CommandedPoint> points;
  std::size_t column_set = 0;  ///< displacement: 1 = deviation from the commanded displacement
  double seconds_per_reading = 4.0;
  NoiseLevel noise;
  Options options;  ///< keys of the instrument's schema, SI
  InstrumentTruth truth;
};

}  // namespace volcal::sim
