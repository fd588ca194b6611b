#pragma once
/// The tool-point error of a machine along a program and along its rewriting. Both are interpreted from their
/// text, line by line, each by an interpreter of its own.
///
/// The functional point of the original at place t of its path is p(t) + e(p(t)) instead of p(t); that of the
/// rewriting q(t) + e(q(t)). Directions of approach are those of the programmed (original) motion for both: a
/// correction moves an axis less than its lost motion. Figures are over feed motions, weighted by length, at
/// irrational shares of every written line (sample_shares.h). Where the rewriting has no motion for a part of
/// the path, it stands still there.

#include <span>
#include <string_view>

#include "volcal/identify/program/nc_rewriter.h"
#include "volcal/identify/program/sample_shares.h"

namespace volcal {

struct PathErrors {
  double rms = 0.0;                                        ///< sqrt(mean |e|^2) by length, m
  double max = 0.0;                                        ///< m
  std::int64_t line_of_max = 0;                            ///< of the original program
  Eigen::Vector3d place_of_max = Eigen::Vector3d::Zero();  ///< machine coordinates, m
  double feed_time = 0.0;                                  ///< s; dwells included, rapids not
};

class NcCheck {
 public:
  NcCheck(ProgramErrors errors, NcSetup setup, FunctionalPoint functional_point);

  /// A line and what it was rewritten into.
  void add(std::string_view line, std::span<const NcWrittenLine> written);

  PathErrors before() const { return figures(before_); }
  PathErrors after() const { return figures(after_); }
  double length() const { return length_; }  ///< of feed motions, m

 private:
  struct Sum {
    double squares = 0.0;
    PathErrors errors;
    void take(const Eigen::Vector3d& error, double weight, std::int64_t line, const Eigen::Vector3d& place);
  };
  PathErrors figures(const Sum& sum) const;
  void use_functional_point();
  void compare(const NcMotion& original, const NcMotion& written, double t_from, double t_to);
  void turn_at(const NcMotion& original, double t);
  void stand(const NcMotion& original, const Eigen::Vector3d& at, double t_from, double t_to);
  void pass(const NcMotion& motion, const std::array<bool, 3>& known_before);

  ProgramErrors errors_;
  FunctionalPoint functional_point_;
  NcInterpreter original_;
  NcInterpreter written_;
  DisplacementField field_;
  std::optional<Eigen::Vector3d> field_point_;  ///< that field_ is for
  ApproachDirection directions_{};
  Sum before_;
  Sum after_;
  double length_ = 0.0;
  std::vector<WeightedShare> shares_;
};

}  // namespace volcal
