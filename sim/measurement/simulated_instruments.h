#pragma once
/// What the simulation knows of each instrument: one function and one line of simulated_instruments.cpp.
/// Whatever else of it is asked stands in that line; nothing beside it tells instruments by their names.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

inline constexpr int kMaxReadingChannels = 3;
using Channels = std::array<double, kMaxReadingChannels>;

/// Directions and origins of a setup, from its commanded points.
struct SetupGeometry {
  Eigen::Vector3d first_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d line_w = Eigen::Vector3d::Zero();  ///< unit; zero when all points coincide
  Eigen::Vector3d centroid_w = Eigen::Vector3d::Zero();
};

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

/// A row of the table: an instrument, and what is asked of it.
struct SimulatedInstrument {
  using Read = Reading (*)(const Sighting& sighting);
  /// Nominal length of a reading, m: to the station or the centre of a bar, or along a line.
  using Length = double (*)(const SetupPlan& plan, const SetupGeometry& geometry,
                            const Eigen::Vector3d& nominal_w);

  std::string_view name;
  Read read;
  std::vector<std::vector<std::string_view>> columns;  ///< in files, by column set
  Length length = [](const SetupPlan&, const SetupGeometry&, const Eigen::Vector3d&) { return 0.0; };
  bool is_laser = false;                        ///< its first channel counts wavelengths
  bool has_station = false;                     ///< key `station`; its readings are taken from there
  bool reads_angle = false;                     ///< its only channel is an angle, whose noise has one part
  std::vector<std::string_view> encoders = {};  ///< angle encoders, which read the last channels
  std::optional<std::size_t> contacts = {};     ///< column set of single contacts: tip and normal

  std::size_t channels(std::size_t column_set) const {
    return column_set < columns.size() ? columns[column_set].size() : 1;
  }
  /// Channels that no encoder reads, which come first.
  std::size_t channels_before_encoders(std::size_t column_set) const {
    return channels(column_set) - std::min(channels(column_set), encoders.size());
  }
  /// The encoder that reads a channel, "azimuth"; empty where none does.
  std::string_view encoder(std::size_t channel, std::size_t column_set) const;
};

const std::vector<SimulatedInstrument>& simulated_instruments();
/// Null where it is not simulated.
const SimulatedInstrument* find_simulated(std::string_view name);
/// Throws std::invalid_argument where it is not simulated.
const SimulatedInstrument& simulated_instrument(const SetupPlan& plan);
/// Whether an angle encoder of this name, "azimuth", reads the channel.
bool reads_encoder(const SetupPlan& plan, std::size_t channel, std::string_view encoder);

/// The axes where the tip of a probe has gone on by `along` the normal.
CommandedPoint gone_on(const TruthMachine& machine, const Eigen::Vector3d& nominal_tool,
                       const CommandedPoint& point, double along);

}  // namespace volcal::sim
