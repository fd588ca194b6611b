#pragma once
/// A machine whose errors are known: any functions of position and state, assembled by exact homogeneous
/// transforms. Workpiece coordinates `w`, machine coordinates at all axes zero; m, rad, degC, s.
///
///     p_w = D_1 D_2 ... D_n tool
///     linear, tool side        D = T(q u) T(r) E T(-r)
///     linear, workpiece side   D = T(r) E T(-r) T(q u)
///     rotary, tool side        D = T(c + dc) R_o E Rot(q') T(-c)
///     rotary, workpiece side   D = T(c) Rot(q') E R_o^-1 T(-(c + dc))
///
/// E = [Rz(EC) Ry(EB) Rx(EA) | (EX, EY, EZ)], 3-2-1 and exact (Bhattacharyya et al., eq. 6-8); u is the
/// nominal direction turned by squareness; q' = q + zero-position error; R_o is the 3-2-1 rotation of the two
/// tilts. Every error is actual minus nominal, tool relative to workpiece (ISO/TR 16907:2015, 3.14 and 7.1);
/// a location error of a rotary axis is that of its physical axis line in the machine frame.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/symbols.h"

namespace volcal::sim {

/// What the machine is commanded and what surrounds it at one reading.
struct MachineState {
  std::array<double, kAxisCount> position{};        ///< commanded, m or rad
  std::array<std::int8_t, kAxisCount> direction{};  ///< of approach: -1, 0 (neither), +1
  double time = 0.0;                                ///< s, campaign clock
  std::map<std::string, double> temperature;        ///< degC by channel
  std::size_t tool = 0;                             ///< index into Machine::tools
  std::array<double, kAxisCount> velocity{};        ///< while the reading is taken, m/s or rad/s
  std::array<double, kAxisCount> since_reversal{};  ///< travelled since the axis last turned round, m or rad
  bool settled = false;                             ///< has been at 20 degC for ever: nothing lags behind
  std::array<double, kAxisCount> farthest{};        ///< largest since_reversal of the setup that is finite
  double length = 0.0;                              ///< nominal, that the instrument measures, m
  std::string setup = {};                           ///< that reads
  std::string station = {};                         ///< at which it stands; may be empty

  double feed() const;  ///< along the path of the linear axes, m/s
};

using ErrorFunction = std::function<double(double position)>;         ///< m or rad
using StateError = std::function<double(const MachineState& state)>;  ///< m or rad
/// What a control adds to the commands.
struct CommandMoves {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< of X, Y, Z, m
  Eigen::Vector3d rotary = Eigen::Vector3d::Zero();  ///< of A, B, C, rad

  CommandMoves() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): most controls move linear axes alone
  CommandMoves(Eigen::Vector3d of_linear, Eigen::Vector3d of_rotary = Eigen::Vector3d::Zero())
      : linear(std::move(of_linear)), rotary(std::move(of_rotary)) {}
  CommandMoves& operator+=(const CommandMoves& other) {
    linear += other.linear;
    rotary += other.rotary;
    return *this;
  }
};
using CommandCorrection = std::function<CommandMoves(const MachineState& state)>;

inline constexpr double kReferenceTemperature = 20.0;  ///< degC, ISO 1

/// The angles that turn a linear axis' direction of travel: of X, Y, Z the squareness errors of the datum, of
/// U, V, W both angles across it.
std::vector<LocationSymbol> linear_locations(const Machine& machine, AxisName axis);

class TruthMachine {
 public:
  /// A perfect machine. Throws std::invalid_argument when an axis of the structure is not described.
  explicit TruthMachine(Machine machine);

  const Machine& machine() const { return machine_; }

  void set_error(ErrorSymbol symbol, ErrorFunction function);
  /// Squareness (a symbol of the machine's datum), angle of U, V or W, or location error of a rotary axis,
  /// its own rotation being the zero position. Throws std::invalid_argument for any other symbol.
  void set_location(LocationSymbol symbol, double value);
  /// Adds +-reversal/2 by direction of approach of the moving axis; nothing where it is unknown.
  void set_reversal(ErrorSymbol symbol, double reversal);
  /// Positioning grows by per_kelvin (T - 20 degC) (q - home), all over the travel. Evaluating it without the
  /// channel throws std::invalid_argument.
  void set_scale_expansion(AxisName axis, double per_kelvin, const std::string& channel);
  /// Beyond these positions functions and state errors, expansions of scales apart, keep their last value.
  /// `round`: the nearest of these positions on the circle.
  void hold_beyond(AxisName axis, double first, double last, bool round);
  /// Anything else that an error motion depends on.
  void add_state_error(ErrorSymbol symbol, StateError error);
  /// A location error that changes; symbols as in set_location(). It adds to location().
  void add_location_change(LocationSymbol symbol, StateError change);

  /// The control corrects its commands from now on: axes go to position + correction, where they have the
  /// errors of that place. What is nominal stays the programmed position.
  void set_correction(CommandCorrection correction);

  /// The error function alone, without reversal, expansion and state errors.
  double function_value(ErrorSymbol symbol, double position) const;
  double location(LocationSymbol symbol) const;
  /// With its changes.
  double location(LocationSymbol symbol, const MachineState& state) const;
  /// Full reversal; 0 where none is set.
  double reversal(ErrorSymbol symbol) const;
  /// All contributions at a state.
  double error(ErrorSymbol symbol, const MachineState& state) const;

  /// Tool in workpiece coordinates; `tool_offset` is the functional point from the spindle reference.
  Eigen::Matrix4d pose(const MachineState& state, const Eigen::Vector3d& tool_offset) const;
  Eigen::Matrix4d nominal_pose(const MachineState& state, const Eigen::Vector3d& tool_offset) const;
  Eigen::Vector3d point(const MachineState& state, const Eigen::Vector3d& tool_offset) const;
  Eigen::Vector3d nominal_point(const MachineState& state, const Eigen::Vector3d& tool_offset) const;
  /// Actual minus nominal functional point.
  Eigen::Vector3d point_error(const MachineState& state, const Eigen::Vector3d& tool_offset) const;

  /// Nominal axes, by columns, in workpiece coordinates: of the tool,
  Eigen::Matrix3d nominal_tool_axes(const MachineState& state) const;
  /// of the bed (machine).
  Eigen::Matrix3d nominal_bed_axes(const MachineState& state) const;

  /// Rotation vector, actual relative to nominal orientation: tool in workpiece coordinates,
  Eigen::Vector3d relative_rotation(const MachineState& state) const;
  /// tool in bed coordinates,
  Eigen::Vector3d tool_rotation(const MachineState& state) const;
  /// table (workpiece) in bed coordinates.
  Eigen::Vector3d table_rotation(const MachineState& state) const;

 private:
  enum class Side { Workpiece, Tool, Both };
  /// Of an axis, m or rad.
  struct MeasuredPart {
    double first = 0.0, last = 0.0;
    bool round = false;
    double nearest(double position) const;
  };
  MachineState corrected(const MachineState& state) const;
  MachineState held(const MachineState& state) const;
  /// `at`: the state within what was measured.
  double error(ErrorSymbol symbol, const MachineState& at, const MachineState& state) const;
  Eigen::Matrix4d joint_transform(const Joint& joint, const MachineState& state) const;
  Eigen::Matrix4d nominal_joint_transform(const Joint& joint, const MachineState& state) const;
  Eigen::Matrix4d chain(Side side, bool nominal, const MachineState& programmed) const;
  Eigen::Vector3d direction_of_travel(AxisName axis, const MachineState& state) const;
  void require_location(LocationSymbol symbol) const;

  Machine machine_;
  std::map<ErrorSymbol, ErrorFunction> functions_;
  std::map<ErrorSymbol, double> reversals_;
  std::map<ErrorSymbol, std::vector<StateError>> state_errors_;
  std::map<ErrorSymbol, std::vector<StateError>> expansions_;
  std::map<AxisName, MeasuredPart> measured_;
  std::map<LocationSymbol, double> locations_;
  std::map<LocationSymbol, std::vector<StateError>> location_changes_;
  CommandCorrection correction_;
};

}  // namespace volcal::sim
