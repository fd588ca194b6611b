#pragma once
/// Rewrites NC programs with tool centre point motion (G43.4 H ... G49, TRAORI ... TRAFOOF) for an identified
/// machine with rotary axes: points and rotary positions become those at which the functional point is where
/// the program means it (tcp_machine.h).
///
/// In that mode X, Y, Z are coordinates of the functional point in a work coordinate system that turns with
/// the table, as the machine lies with its rotary axes at 0; A, B, C are positions of the rotary axes.
/// Between blocks all of them change in proportion. A block becomes several where the straight way between
/// its corrected ends would leave the corrected path by more than the tolerance, which is looked at in many
/// irrational shares of it (sample_shares.h).
///
/// A word is written where the block has it, and where the control stands elsewhere than it is sent to: which
/// is known from the written digits, whatever offset, unit or tool they counted in.
///
/// Followed there: G0, G1, G90, G17 to G21, G40, G54 to G59.3, G64, G80, G93, G94, F, S, T, M. Outside it
/// rapids and what moves nothing are copied; feed motions are refused, since errors of a machine with turned
/// axes are corrected in this mode alone. Everything else is refused with its line and a remedy.

#include <array>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_writer.h"
#include "volcal/identify/program/tcp/tcp_interpreter.h"
#include "volcal/identify/program/tcp/tcp_machine.h"

namespace volcal {

/// Of TcpRewriteOptions::decimals_deg.
inline constexpr int kFewestRotaryDecimals = 3, kMostRotaryDecimals = 8;

struct TcpRewriteOptions {
  double tolerance = 0.5e-6;  ///< of the corrected path, m; of rotary positions a tenth of a metre away
  int decimals_mm = 4;        ///< of coordinates in mm; inches get one more
  int decimals_deg = 5;       ///< of rotary positions
  bool orientation = false;   ///< FOR
  std::array<bool, 3> identified = {true, true, true};  ///< errors of A, B, C
  std::array<double, 3> reference = {0.0, 0.0, 0.0};    ///< where those not identified must stay, rad
  std::optional<MeasuredTravel> measured;  ///< beyond it errors are held; nothing = not looked at
  bool within_readings = false;            ///< refuse motions beyond it
  std::vector<std::string> header;         ///< lines above the program (program_header.h); empty = none
};

/// Of a result, what effects displace the tool's offset by included; `tool`: whose name effects may ask for,
/// empty for none. `result` must live as long.
ErrorsOfOffset tcp_errors_of(const FitResult& result, const std::string& tool, const Conditions& conditions);

/// What a result says of the axes: which of them have errors, where the others must stay, where was measured.
TcpRewriteOptions tcp_options_of(const FitResult& result);

struct TcpSummary {
  std::int64_t lines_read = 0, lines_written = 0;
  std::int64_t motions = 0;         ///< of tool centre point motion
  std::int64_t split_lines = 0;     ///< blocks that became more than one
  std::int64_t copied_rapids = 0;   ///< outside it
  double largest_correction = 0.0;  ///< of the functional point, m
  double largest_turn = 0.0;        ///< of a rotary axis, rad
  std::int64_t near_poles = 0;      ///< nodes at which FOR leaves more than a tenth of the orientation error
  std::int64_t first_near_pole = 0;
  std::int64_t beyond_readings = 0;  ///< nodes beyond the measured positions: errors are held there
  std::int64_t first_beyond = 0;     ///< line of the first of them
  /// Axes that went beyond their travel, taken to turn without end since they carry the workpiece.
  std::set<AxisName> assumed_endless;
};

class TcpRewriter {
 public:
  /// Takes what one line becomes; `at` is the share of its motion that a written line ends at.
  using Sink = std::function<void(std::string_view line, std::span<const NcWrittenLine> written)>;
  TcpRewriter(const Machine& machine, ErrorsOfOffset errors, NcSetup setup, FunctionalPoint functional_point,
              TcpRewriteOptions options, std::string file);

  /// The next line, with its line end. Throws InputError for what cannot be rewritten.
  void rewrite(std::string_view line, const Sink& sink);
  const TcpSummary& summary() const { return summary_; }

 private:
  struct Node {
    double t = 0.0;
    TcpPose sent;
  };

  void move(const TcpStep& step);
  void require_identified(const TcpStep& step) const;
  void split_block(const Node& begin, const Node& end, std::vector<Node>& nodes);
  void split(double t_from, const Node& from, double t_to, const Node& to, int depth,
             std::vector<Node>& nodes);
  bool is_straight(double t_from, const Node& from, double t_to, const Node& to, const Node& middle);
  double distance(const Node& node, const TcpPose& chord) const;
  Node node_at(double t);
  ApproachDirection directions_at(double t) const;
  void require_reachable(const TcpPose& sent);
  void require_path_reachable();
  void write_block(const TcpStep& step, const std::vector<Node>& nodes);
  std::string first_line(const TcpStep& step, const Node& node, double timed_share);
  std::string coordinates(const Node& node, const NcCommands* kept);
  void note_node(const Node& node);
  void write_header(std::string_view line);
  NcPlace place() const { return interpreter_.place(); }

  Machine machine_;
  TcpMachines machines_;
  TcpInterpreter interpreter_;
  TcpRewriteOptions options_;
  const TcpMachine* tcp_ = nullptr;
  TcpSummary summary_;

  TcpPose from_, to_;  ///< of the block in hand, as programmed
  ApproachDirection directions_{};
  double checks_of_block_ = 0.0;  ///< places of the block in hand at which it is compared with its chords
  int steps_ = 0;                 ///< of the block in hand: shortest parts that are not straight
  TcpPose stands_;                ///< where the control stands, by what is written
  bool stands_known_ = false;
  bool header_written_ = false;
  std::vector<NcWrittenLine> written_;
};

}  // namespace volcal
