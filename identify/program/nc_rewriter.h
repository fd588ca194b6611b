#pragma once
/// Rewrites an NC program so that an identified machine's tool goes where the program means it to: every
/// coordinate p becomes p' = p - e(p'), lines are split and arcs become chords so that the corrected path is
/// kept within a tolerance (path_splitting.h). The error e depends on the machine coordinates, on the
/// functional point (FunctionalPoint) and on the directions of the programmed motion; an axis that the
/// program does not move keeps its last direction, and has none before its first motion.
///
/// Lines that move nothing are copied byte for byte. Of lines that move, coordinates are replaced and added;
/// what a line is split into follows it. Rapids get corrected end points. Where an axis turns round and the
/// correction jumps, by more than a quarter of the tolerance, the jump is a line of its own.

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_writer.h"
#include "volcal/identify/program/path_splitting.h"

namespace volcal {

/// Of coordinates in mm.
inline constexpr int kFewestDecimals = 4, kMostDecimals = 7;

struct NcRewriteOptions {
  double tolerance = 0.5e-6;             ///< of the corrected path, m
  double arc_tolerance = 0.5e-6;         ///< of chords in place of arcs, m
  int decimals_mm = 4;                   ///< of coordinates in mm; inches get one more
  bool within_readings = false;          ///< refuse motions beyond the measured positions
  std::vector<std::string> header = {};  ///< lines above the program (program_header.h); empty = none
};

/// Throws InputError for decimals or tolerances out of range.
void check_rewrite_options(const NcRewriteOptions& options);

struct NcRewriteSummary {
  std::int64_t lines_read = 0;
  std::int64_t lines_written = 0;
  std::int64_t motions = 0;  ///< rapids, lines and arcs of the program
  std::int64_t arcs = 0;
  std::int64_t split_lines = 0;  ///< lines that became more than one
  std::int64_t clamped = 0;      ///< rapids whose corrected end would leave the travel: they end at its limit
  std::int64_t beyond_readings = 0;  ///< motions that leave the measured positions: errors are held there
  std::int64_t first_beyond = 0;     ///< line of the first of them
  double largest_correction = 0.0;   ///< m
  std::vector<Eigen::Vector3d> functional_points;  ///< that the program used, m from the spindle reference
};

class NcRewriter {
 public:
  /// Takes what one line becomes.
  using Sink = std::function<void(std::string_view line, std::span<const NcWrittenLine> written)>;

  /// Throws InputError as check_rewrite_options() does.
  NcRewriter(ProgramErrors errors, NcSetup setup, FunctionalPoint functional_point, NcRewriteOptions options,
             std::string file);

  /// The next line, with its line end. Throws InputError for what cannot be rewritten.
  void rewrite(std::string_view line, const Sink& sink);

  const NcRewriteSummary& summary() const { return summary_; }

 private:
  void use_functional_point();
  void note_place(const NcMotion& motion);
  void write_header(std::string_view line);
  void correct_motions(const NcStep& step, const std::array<bool, 3>& known_before);
  void correct_rapid(const NcMotion& motion, double at, const std::array<bool, 3>& known_before);
  void correct_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double at, double t_from,
                    double t_to);
  void correct_arc(const NcArc& arc, double at);
  void add_target(NcMotionKind kind, const Eigen::Vector3d& position, const Eigen::Vector3d& command,
                  double at);
  void require_inside(const Eigen::Vector3d& position, const char* what) const;
  Eigen::Vector3d solve(const Eigen::Vector3d& position);

  /// The command at the end of the last line, which is where the next one mostly begins.
  struct LastCommand {
    const PathSplitter* splitter = nullptr;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    ApproachDirection directions{};
    Eigen::Vector3d command = Eigen::Vector3d::Zero();
  };

  ProgramErrors errors_;
  NcInterpreter interpreter_;
  FunctionalPoint functional_point_;
  NcRewriteOptions options_;
  NcWriter writer_;
  NcRewriteSummary summary_;
  std::vector<std::unique_ptr<PathSplitter>> splitters_;  ///< by summary_.functional_points
  PathSplitter* splitter_ = nullptr;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();  ///< travel
  Eigen::Vector3d high_ = Eigen::Vector3d::Zero();
  ApproachDirection directions_{};
  Eigen::Vector3d commanded_ = Eigen::Vector3d::Zero();  ///< end of the last target, before rounding
  LastCommand last_;
  bool header_written_ = false;
  std::vector<NcTarget> targets_;
  std::vector<PathNode> nodes_;
  std::vector<NcWrittenLine> written_;
};

}  // namespace volcal
