#pragma once
/// A machine tool as its owner describes it: structure, axes, datum, tools. Plain data, SI units (m, rad, K).

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/symbols.h"

namespace volcal {

/// One joint of the structural code (ISO 10791-6), e.g. `w X' b Y Z t`, with a quill `w X' b Y Z W t`; order
/// runs from workpiece to tool.
struct Joint {
  AxisName axis = AxisName::X;
  bool workpiece_side = false;  ///< stands between w and b
};

struct Structure {
  std::string code;
  std::vector<Joint> joints;  ///< workpiece to tool; a bracketed spindle such as `(C)` is not a joint

  /// Reads a structural code. Throws InputError naming what is wrong; `place` says where the code stands.
  static Structure parse(const std::string& code, const std::string& file = {}, int line = 0);

  bool has_axis(AxisName axis) const;
  bool is_on_workpiece_side(AxisName axis) const;  ///< false for an axis that is not there
};

/// Thermal expansion of an axis's scale: reading channel and coefficient with the uncertainty its users
/// share.
struct ScaleExpansion {
  double per_kelvin = 0.0;        ///< 1/K
  double per_kelvin_sigma = 0.0;  ///< standard uncertainty, 1/K
  std::string channel;            ///< temperature channel: column T_<channel>_degC
};

/// Positions are m (linear) or rad (rotary), in machine coordinates.
struct Axis {
  AxisName name = AxisName::X;
  double travel_min = 0.0;
  double travel_max = 0.0;
  double home = 0.0;
  /// Linear: point of the carriage, machine coordinates with all axes at 0, at which EX, EY, EZ are stated.
  Eigen::Vector3d reference_point = Eigen::Vector3d::Zero();
  /// Rotary: a point of the nominal axis line, machine coordinates with all axes at 0.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /// Rotary: nobody stated `centre`, and the origin stands for it.
  bool centre_is_assumed = false;
  /// Rotary: whether it turns without end, where the owner says so; see Machine::is_endless().
  std::optional<bool> endless;
  std::optional<ScaleExpansion> expansion;

  double travel() const { return travel_max - travel_min; }
  /// Rotary: every direction is within the travel.
  bool travels_a_turn() const;
};

struct Tool {
  std::string name;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< functional point from the spindle reference, m
  double offset_sigma = 0.0;                         ///< per component, m; 0 = exact
};

/// Primary axis gives the direction, secondary the plane of the machine frame (ISO/TR 16907, 7.3). Both are
/// X, Y or Z: U, V, W never give the frame.
struct Datum {
  AxisName primary = AxisName::X;
  AxisName secondary = AxisName::Y;

  AxisName third() const;
  /// The three squareness symbols in the order (secondary to primary, third about primary, third about
  /// secondary): primary X, secondary Y gives EC0Y, EA0Z, EB0Z.
  std::array<LocationSymbol, 3> squareness() const;
};

struct Machine {
  std::string name;
  std::string file;  ///< where it was read from; empty when made in memory
  Structure structure;
  Datum datum;
  std::vector<Axis> axes;  ///< in the structure's order
  std::vector<Tool> tools;

  const Axis& axis(AxisName wanted) const;  ///< throws std::out_of_range
  bool has_axis(AxisName wanted) const;
  std::vector<AxisName> main_linear_axes() const;  ///< of X Y Z those of the machine, in this order
  std::vector<AxisName> parallel_axes() const;     ///< of U V W those of the machine, in this order
  std::vector<AxisName> linear_axes() const;       ///< the main ones, then the parallel ones
  std::vector<AxisName> rotary_axes() const;       ///< in the structure's order
  /// Whether an axis turns without end, beyond the ends of its travel: as its owner says; where nothing is
  /// said, a rotary axis that travels a turn and carries the workpiece. The tool's side has cables.
  bool is_endless(AxisName axis) const;
  std::optional<std::size_t> tool_index(const std::string& wanted) const;
  /// The tools; of a machine without any the spindle reference, as one tool without a name.
  std::vector<Tool> functional_tools() const;
};

}  // namespace volcal
