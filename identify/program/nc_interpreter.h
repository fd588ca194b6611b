#pragma once
/// Runs an NC program as a control does: blocks in, motions of the axes out. One block at a time, constant
/// memory; what the program may say is in docs/guides/compensate-a-program.md.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_state.h"

namespace volcal {

/// What one line does.
struct NcStep {
  NcBlock block;
  NcCommands commands;
  bool executed = false;      ///< not: behind the program's end, or skipped by the block-delete switch
  int motion = kNoCode;       ///< G code that its coordinates belong to
  bool machine_axes = false;  ///< G53 with motion
  std::vector<NcMotion> motions;
};

class NcInterpreter {
 public:
  /// `file` names the program in errors.
  NcInterpreter(NcSetup setup, std::string file);

  /// The next line, with its line end. The step refers to the line and is valid until the next call. Throws
  /// InputError for what cannot be followed.
  const NcStep& execute(std::string_view line);

  const NcState& state() const { return state_; }
  const NcSetup& setup() const { return setup_; }
  NcPlace place() const { return {file_, line_}; }
  bool ended() const { return ended_; }

 private:
  bool skips();
  void move();
  Eigen::Vector3d target();
  void rapid_or_feed(int motion);
  void arc_motion(bool clockwise);
  NcArc arc_of_block(const NcArcWords& words) const;
  void add_feed(NcMotion motion);
  void require_known(const char* what) const;

  NcSetup setup_;
  std::string file_;
  std::int64_t line_ = 0;
  bool begun_ = false;  ///< a % was seen
  bool ended_ = false;
  NcState state_;
  NcStep step_;
};

/// Whether the control's switch skips a block that begins with `/`. Throws InputError where it is not known
/// how the switch stands.
bool is_deleted(const NcBlock& block, const NcSetup& setup, const NcPlace& place);

/// The G code of group 1 that the coordinates of a block belong to, kNoCode where nothing moves; the state
/// keeps it for the blocks that follow. Throws InputError for coordinates that belong to none, or to two.
int follow_motion_code(const NcCommands& commands, const NcPlace& place, NcState& state);

/// Throws InputError for words that belong to no code of the block.
void refuse_unused_words(const NcStep& step, const NcState& state, const NcPlace& place);

/// Time of a feed motion of this length by the state's F, s; NaN where feed per turn has no spindle speed.
/// Throws InputError when no feed is in force.
double feed_time(const NcState& state, const NcPlace& place, double length);

}  // namespace volcal
