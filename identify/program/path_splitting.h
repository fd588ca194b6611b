#pragma once
/// Splits corrected paths into straight segments that keep a tolerance.
///
/// Between two nodes the control moves on a straight line, while the corrected path is curved by e'': the
/// distance is at most h^2 |e''| / 8. e'' is taken from five values of the field on every interval on which
/// it is a polynomial (ProgramErrors::pieces), where a quartic gives it exactly; its largest norm is bounded
/// by 1.25 times that at both ends and the middle (Lebesgue constant of three points). Where the field is off
/// the quartic and off a straight line at irrational shares of an interval, the interval is halved. A quarter
/// of the tolerance goes to nodes so close together that the bound holds between them, half to leaving nodes
/// out again where a longer segment passes all of them, and a quarter to where a segment begins (NcRewriter).

#include <stdexcept>
#include <vector>

#include "volcal/identify/program/program_errors.h"

namespace volcal {

struct PathNode {
  double t = 0.0;                                     ///< 0..1 along the programmed path
  Eigen::Vector3d command = Eigen::Vector3d::Zero();  ///< axis positions, m
};

/// A line takes more segments than a program should have.
class PathTooLong : public std::runtime_error {
 public:
  PathTooLong();
  static const char* remedy();
};
/// Of one line of a program.
inline constexpr std::size_t kMostSegments = 100000;

class PathSplitter {
 public:
  /// `tolerance`: largest distance of the straight segments from the corrected path, m.
  PathSplitter(const ProgramErrors& errors, const Eigen::Vector3d& tool_offset, double tolerance);

  CommandSolver& solver() { return solver_; }

  /// Appends the nodes of a line but its first, for motions in one set of directions; t from `t_from` to
  /// `t_to`. Throws PathTooLong.
  void split(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const ApproachDirection& directions,
             double t_from, double t_to, std::vector<PathNode>& nodes);

  /// Largest change of the error per m of motion, sampled over the travel and doubled.
  double steepness() const { return steepness_; }

 private:
  void set_steepness(const Machine& machine);
  double steepness_along(int axis, Eigen::Vector3d point, const std::vector<double>& ends) const;
  void cut_at_pieces(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  void add_interval(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    const ApproachDirection& directions, double t_begin, double t_end);
  enum class Shape { Quartic, Straight, Other };
  Shape shape_of(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const ApproachDirection& directions,
                 double t_begin, double t_end, const std::array<Eigen::Vector3d, 5>& values);
  void keep_needed(double t_from, double t_to, std::vector<PathNode>& nodes) const;
  std::size_t furthest(std::size_t anchor) const;

  CommandSolver solver_;
  std::array<std::vector<double>, 3> pieces_;
  double tolerance_;
  double steepness_ = 0.0;
  std::vector<double> cuts_;     ///< of the line in hand
  std::vector<PathNode> close_;  ///< nodes that keep a quarter of the tolerance
};

/// Parameters at which chords of an arc keep `tolerance` (m) and its axes turn round; first 0, last 1.
std::vector<double> chord_ends(const NcArc& arc, double tolerance);

}  // namespace volcal
