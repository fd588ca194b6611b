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
/// Followed there: G0, G1, G90, G17 to G21, G40, G54 to G59.3, G64, G80, G93, G94, F, S, T, M. Outside it
/// rapids and what moves nothing are copied; feed motions are refused, since errors of a machine with turned
/// axes are corrected in this mode alone. Everything else is refused with its line and a remedy.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_rewriter.h"
#include "volcal/identify/program/sample_shares.h"
#include "volcal/identify/program/tcp_machine.h"
#include "volcal/identify/program/tcp_words.h"

namespace volcal {

/// Of TcpRewriteOptions::decimals_deg.
inline constexpr int kFewestRotaryDecimals = 3, kMostRotaryDecimals = 8;

struct TcpRewriteOptions {
  double tolerance = 0.5e-6;  ///< of the corrected path, m; of rotary positions a tenth of a metre away
  int decimals_mm = 4;        ///< of coordinates in mm; inches get one more
  int decimals_deg = 5;       ///< of rotary positions
  bool orientation = false;   ///< FOR
  bool check = false;         ///< fill the figures of errors along the path
  std::array<bool, 3> identified = {true, true, true};  ///< errors of A, B, C
  std::array<double, 3> reference = {0.0, 0.0, 0.0};    ///< where those not identified must stay, rad
  std::optional<MeasuredTravel> measured;  ///< beyond it errors are held; nothing = not looked at
  bool within_readings = false;            ///< refuse motions beyond it
  std::vector<std::string> header;         ///< lines above the program (program_header.h); empty = none
};

/// What a result says of the axes: which of them have errors, where the others must stay, where was measured.
TcpRewriteOptions tcp_options_of(const FitResult& result);

/// Weighted by length of the path of the functional point.
struct TcpErrors {
  double rms = 0.0, max = 0.0;            ///< of the functional point, m
  double axis_rms = 0.0, axis_max = 0.0;  ///< of the tool's axis, rad
  std::int64_t line_of_max = 0;           ///< of the functional point
};

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
  double length = 0.0;      ///< of feed motions, m
  TcpErrors before, after;  ///< where a check is asked for
};

class TcpRewriter {
 public:
  using Sink = std::function<void(std::string_view line, std::span<const std::string> written)>;
  /// Errors of every axis; the same for every tool.
  TcpRewriter(const Machine& machine, JointErrorSource errors, NcSetup setup,
              FunctionalPoint functional_point, TcpRewriteOptions options, std::string file);

  /// The next line, with its line end. Throws InputError for what cannot be rewritten.
  void rewrite(std::string_view line, const Sink& sink);
  /// With figures of the check.
  TcpSummary summary() const;

 private:
  struct Node {
    double t = 0.0;
    TcpPose sent;
  };

  void follow_settings(const TcpWords& words, const NcBlock& block);
  void begin_mode(const TcpWords& words);
  void move(const TcpWords& words, const NcBlock& block);
  void rapid_outside(const TcpWords& words);
  void set_target(const TcpWords& words);
  void split_block(const Node& begin, const Node& end, std::vector<Node>& nodes);
  void split(double t_from, const Node& from, double t_to, const Node& to, int depth,
             std::vector<Node>& nodes);
  bool is_straight(double t_from, const Node& from, double t_to, const Node& to, const Node& middle);
  double distance(const Node& node, const TcpPose& chord) const;
  Node node_at(double t);
  ApproachDirection directions_at(double t);
  void require_reachable(const TcpPose& sent);
  void write_block(const TcpWords& words, const NcBlock& block, const std::vector<Node>& nodes);
  std::string coordinates(const Node& node);
  void note_errors(const std::vector<Node>& nodes);
  void note_node(const Node& node);
  TcpPose rounded(const TcpPose& pose) const;
  Eigen::Vector3d origin() const;
  bool is_tcp_axis(char letter) const;
  NcPlace place() const { return {file_, summary_.lines_read + 1}; }

  Machine machine_;
  JointErrorSource errors_;
  NcSetup setup_;
  FunctionalPoint functional_point_;
  TcpRewriteOptions options_;
  std::string file_;
  std::map<std::string, std::unique_ptr<TcpMachine>> machines_;  ///< by tool offset
  TcpMachine* tcp_ = nullptr;                                    ///< while the mode is active
  TcpSummary summary_;
  double square_before_ = 0.0, square_after_ = 0.0, axis_before_ = 0.0, axis_after_ = 0.0;

  bool ended_ = false, percent_seen_ = false, header_written_ = false;
  int motion_ = kNoCode;  ///< 0 or 10
  double unit_ = 0.0;
  std::size_t work_ = 0;
  bool inverse_time_ = false;
  std::array<bool, 3> point_known_{}, rotary_known_{};
  TcpPose from_, to_;  ///< of the block in hand, as programmed
  ApproachDirection last_directions_{}, directions_{};
  double checks_of_block_ = 0.0;  ///< places of the block in hand at which it is compared with its chords
  int steps_ = 0;                 ///< of the block in hand: shortest parts that are not straight
  std::vector<WeightedShare> shares_;
  TcpPose sent_;  ///< at the end of the last block, as it is written
  bool sent_known_ = false;
  std::array<std::string, 6> written_words_;  ///< X Y Z A B C as they stand last in the written program
  std::vector<std::string> written_;
};

}  // namespace volcal
