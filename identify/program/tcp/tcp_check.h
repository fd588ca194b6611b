#pragma once
/// The error of the functional point and of the tool's axis along a program with tool centre point motion and
/// along its rewriting. Both are interpreted from their text, line by line, each by an interpreter of its
/// own: what is not written, or is written wrongly, is seen.
///
/// The error of the original at place t of a block is that of the machine sent to where it says; that of the
/// rewriting is the difference of the pose reached from the pose meant, at the same share of the block. Where
/// the rewriting has no motion for a part of a block, it stands still there. Directions of approach are those
/// of the original for both.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_writer.h"
#include "volcal/identify/program/sample_shares.h"
#include "volcal/identify/program/tcp/tcp_interpreter.h"
#include "volcal/identify/program/tcp/tcp_machine.h"

namespace volcal {

/// Over feed motions, weighted by the path of the functional point and the turns of the rotary axes at a
/// lever of kTcpLever: blocks that only turn count as well.
struct TcpErrors {
  double rms = 0.0, max = 0.0;            ///< of the functional point, m
  double axis_rms = 0.0, axis_max = 0.0;  ///< of the tool's axis, rad
  std::int64_t line_of_max = 0;           ///< of the functional point, in the original program
};

class TcpCheck {
 public:
  /// As TcpRewriter.
  TcpCheck(const Machine& machine, ErrorsOfOffset errors, NcSetup setup, FunctionalPoint functional_point);

  /// A line and what it was rewritten into. Throws InputError where the rewriting cannot be followed.
  void add(std::string_view line, std::span<const NcWrittenLine> written);

  TcpErrors before() const { return figures(before_); }
  TcpErrors after() const { return figures(after_); }
  double length() const { return length_; }  ///< of the path of the functional point in feed motions, m

 private:
  struct Sum {
    double squares = 0.0, axis_squares = 0.0;
    TcpErrors errors;
    void take(const TcpMachine::Left& left, double weight, std::int64_t line);
  };
  TcpErrors figures(const Sum& sum) const;
  void compare(const TcpStep& original, const TcpPose& begin, const TcpPose& end, double t_from, double t_to);

  TcpMachines machines_;
  TcpInterpreter original_, written_;
  ApproachDirection directions_{};
  TcpPose stands_;  ///< of the rewriting
  Sum before_, after_;
  double length_ = 0.0, weight_ = 0.0;
  std::vector<WeightedShare> shares_;
};

}  // namespace volcal
