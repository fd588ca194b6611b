#pragma once
/// Runs an NC program with tool centre point motion as a control does: blocks in, motions of the functional
/// point and the rotary axes out. What it shares with programs of X, Y and Z is read by the same code
/// (nc_commands.h, nc_state.h, nc_interpreter.h) and refused in the same words.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "volcal/identify/program/nc_interpreter.h"
#include "volcal/identify/program/program_errors.h"
#include "volcal/identify/program/tcp/tcp_machine.h"

namespace volcal {

/// What one line does.
struct TcpStep {
  NcStep said;           ///< block, commands and G code of the motion; its motions stay empty
  bool outside = false;  ///< a rapid outside tool centre point motion
  bool moves = false;    ///< in it, `from` to `to`
  bool feed = false;     ///< by G1
  bool first = false;    ///< since the mode began: where it comes from is not known, `from` is `to`
  TcpPose from, to;
};

class TcpInterpreter {
 public:
  /// `file` names the program in errors. Throws InputError for a machine without rotary axes.
  TcpInterpreter(const Machine& machine, NcSetup setup, FunctionalPoint functional_point, std::string file);

  /// The next line, with its line end. The step refers to the line and is valid until the next call. Throws
  /// InputError for what cannot be followed.
  const TcpStep& execute(std::string_view line);

  const NcState& state() const { return state_; }
  NcPlace place() const { return {file_, line_}; }
  /// Of the functional point while the mode is active, m from the spindle reference.
  const Eigen::Vector3d& tool_offset() const { return tool_offset_; }
  /// Of the coordinates of the program, in workpiece coordinates, m. Throws InputError where the work offset
  /// is not given.
  Eigen::Vector3d origin() const;

 private:
  bool read(std::string_view line);
  void require_followed() const;
  void require_axes() const;
  void begin_mode(bool by_name);
  void move(bool ends_mode);
  void rapid_outside();
  void set_target();

  Machine machine_;
  NcSetup setup_;
  FunctionalPoint functional_point_;
  std::string file_;
  std::int64_t line_ = 0;
  bool begun_ = false, ended_ = false;
  bool active_ = false;
  Eigen::Vector3d tool_offset_ = Eigen::Vector3d::Zero();
  std::array<bool, 3> point_known_{}, rotary_known_{};
  NcState state_;
  TcpStep step_;
};

}  // namespace volcal
