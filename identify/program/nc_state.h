#pragma once
/// Modal state of a control while it runs an NC program, after RS-274 (NISTIR 6556, clauses 3.5 to 3.8;
/// offsets as LinuxCNC 2.9). Positions are those of the axes X, Y and Z in machine coordinates, m:
///
///     axis position = program coordinate + work offset + local offset (G52, G92) + tool length offset
///
/// Changing an offset moves no axis.

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>

#include "volcal/identify/program/nc_commands.h"
#include "volcal/identify/program/nc_motion.h"

namespace volcal {

inline constexpr std::size_t kWorkOffsets = 9;  ///< G54 to G59, G59.1 to G59.3

/// "G54" ... "G59.3".
std::string work_offset_name(std::size_t index);
std::optional<std::size_t> work_offset_index(const std::string& name);

/// What the control knows and the program does not say. Lengths in m.
struct NcSetup {
  std::array<std::optional<Eigen::Vector3d>, kWorkOffsets> work_offsets;
  std::map<int, double> tool_lengths;    ///< by H number
  std::optional<Eigen::Vector3d> start;  ///< axis positions before the first block; nothing = not known
  Eigen::Vector3d home = Eigen::Vector3d::Zero();  ///< stands for positions that are not known
  double length_unit = 0.0;                        ///< in force before G20 or G21, m; 0 = not known
  std::optional<bool> block_delete;                ///< the control's switch: true skips blocks with `/`
};

enum class NcFeedMode { InverseTime, PerMinute, PerTurn };

struct NcState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the axes; of one not known, any
  std::array<bool, 3> known{};                         ///< the axis's position is known

  int motion = kNoCode;  ///< last G code of group 1; kNoCode before the first and after G80
  NcPlane plane;
  bool incremental = false;      ///< G91
  bool absolute_centre = false;  ///< G90.1
  double unit = 0.0;             ///< m per unit of length; 0 = not known
  NcFeedMode feed_mode = NcFeedMode::PerMinute;
  double feed = 0.0;                     ///< F as written; 0 = none in this mode and unit
  double spindle_speed = 0.0;            ///< 1/min; 0 = none
  std::optional<bool> retract_to_plane;  ///< G99; G98 is false; nothing = not said
  std::optional<double> cycle_depth;     ///< sticky Z of cycles, program coordinate or increment, m
  std::optional<double> cycle_plane;     ///< sticky R
  double cycle_dwell = 0.0;              ///< sticky P, s
  std::optional<double> cycle_peck;      ///< sticky Q, m

  std::size_t work = 0;  ///< index of the work offset
  std::array<std::optional<Eigen::Vector3d>, kWorkOffsets> work_offsets;
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< G52 or G92 in force
  std::optional<Eigen::Vector3d> stored_local;      ///< for G92.3
  int local_code = kNoCode;                         ///< 520 or 920, whichever the program uses
  bool length_active = false;                       ///< G43, G43.1
  Eigen::Vector3d length = Eigen::Vector3d::Zero();
};

NcState initial_state(const NcSetup& setup);

/// Axis position of the origin of program coordinates. Throws InputError when the work offset is not given.
Eigen::Vector3d program_origin(const NcState& state, const NcPlace& place);

/// Executes everything of a block but motion, cycles and dwell, in the order of RS-274. Throws InputError for
/// what cannot be followed.
void apply_settings(const NcCommands& commands, const NcSetup& setup, const NcPlace& place, NcState& state);

/// Of the block's H, m. Throws InputError where it has none or its length is not given.
double given_tool_length(const NcCommands& commands, const NcSetup& setup, const NcPlace& place);

/// Unit of length, m. Throws InputError while it is not known.
double require_unit(const NcState& state, const NcPlace& place);

}  // namespace volcal
