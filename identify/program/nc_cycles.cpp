#include "volcal/identify/program/nc_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/program/nc_interpreter.h"

namespace volcal {
namespace {

constexpr std::size_t kMostMotions = 100000;  ///< of one block
constexpr double kRounding = 1e-9;            ///< m

/// One cycle block; heights are axis positions across the plane, m.
class DrillingCycle {
 public:
  DrillingCycle(int motion, const NcCommands& commands, const NcPlace& place, NcState& state,
                std::vector<NcMotion>& motions)
      : motion_(motion), commands_(commands), place_(place), state_(state), motions_(motions) {}

  void run() {
    read_words();
    const int axis = state_.plane.across;
    double clear = std::max(state_.position[axis], plane_);
    if (clear > plane_ && !state_.retract_to_plane)
      place_.refuse(
          "the cycle begins above R before G98 or G99 is written; controls differ in which they start with",
          "write G98 (back to the height before the cycle) or G99 (to R)");
    if (state_.retract_to_plane.value_or(true)) clear = plane_;
    if (motion_ == 890 && clear > plane_)
      place_.refuse("G89 goes back above R; controls differ in where its feed ends", "write G99 before it");
    if (state_.position[axis] < plane_) rapid_to_height(plane_);
    const Eigen::Vector3d step = sideways_step();
    for (int i = 0; i < repetitions_; ++i) {
      Eigen::Vector3d over = state_.incremental ? Eigen::Vector3d(state_.position + step) : step;
      over[axis] = state_.position[axis];
      rapid(over);
      rapid_to_height(plane_);
      drill();
      retract(clear);
    }
  }

 private:
  void read_words() {
    const double unit = require_unit(state_, place_);
    const auto axis = static_cast<std::size_t>(state_.plane.across);
    const char depth = kNcAxisLetters[axis];
    if (commands_.has(depth)) state_.cycle_depth = commands_.value(depth) * unit;
    if (commands_.has('R')) state_.cycle_plane = commands_.value('R') * unit;
    if (commands_.has('P')) state_.cycle_dwell = commands_.value('P');
    if (commands_.has('Q')) state_.cycle_peck = commands_.value('Q') * unit;
    const std::string name = g_code_name(motion_);
    if (!state_.cycle_depth || !state_.cycle_plane)
      place_.refuse(fmt::format("{} has no {}", name, state_.cycle_depth ? 'R' : depth),
                    "write the depth and the R plane in the first block of the cycle");
    const bool pecks = motion_ == 730 || motion_ == 830;
    if (pecks && !(state_.cycle_peck && *state_.cycle_peck > 0.0))
      place_.refuse(name + " has no positive Q", "write the depth of a peck as Q");
    if (state_.cycle_dwell < 0.0) place_.refuse("the dwell P is negative", "write seconds");
    set_heights(name);
    const double count = commands_.has('L') ? commands_.value('L') : 1.0;
    if (count != std::floor(count) || count < 1.0 || count > kMostCycleMotions)
      place_.refuse(fmt::format("L{:g} is not a number of repetitions", count), "write 1 to 10000");
    repetitions_ = static_cast<int>(count);
  }

  void set_heights(const std::string& name) {
    const int axis = state_.plane.across;
    const double from = state_.incremental ? state_.position[axis] : program_origin(state_, place_)[axis];
    plane_ = from + *state_.cycle_plane;
    bottom_ = (state_.incremental ? plane_ : from) + *state_.cycle_depth;
    if (plane_ < bottom_)
      place_.refuse(name + ": the R plane lies below the bottom of the hole", "write R above the depth");
    const bool pecks = motion_ == 730 || motion_ == 830;
    if (pecks && (plane_ - bottom_) / *state_.cycle_peck > kMostCycleMotions)
      place_.refuse("Q makes more than 10000 pecks", "is it in the right unit?");
  }

  /// Where the holes are (G90) or how far apart (G91), in the plane.
  Eigen::Vector3d sideways_step() const {
    Eigen::Vector3d step = state_.incremental ? Eigen::Vector3d::Zero() : state_.position;
    for (const int i : {state_.plane.first, state_.plane.second}) {
      const char letter = kNcAxisLetters[static_cast<std::size_t>(i)];
      if (!commands_.has(letter)) continue;
      step[i] = commands_.value(letter) * state_.unit;
      if (!state_.incremental) step[i] += program_origin(state_, place_)[i];
    }
    return step;
  }

  void drill() {
    if (motion_ == 730 || motion_ == 830) {
      drill_in_pecks();
    } else {
      feed_to_height(bottom_);
    }
    if (motion_ == 820 || motion_ == 890) dwell();
  }

  void drill_in_pecks() {
    const double peck = *state_.cycle_peck;
    const int pecks = static_cast<int>(std::ceil((plane_ - bottom_ - kRounding) / peck));
    for (int i = 1; i < pecks; ++i) {
      const double depth = plane_ - i * peck;
      feed_to_height(depth);
      if (motion_ == 830) rapid_to_height(plane_);
      rapid_to_height(depth + kPeckClearance);
    }
    feed_to_height(bottom_);
  }

  void retract(double clear) {
    const bool at_feed = motion_ == 850 || motion_ == 890;
    if (at_feed) feed_to_height(plane_);
    rapid_to_height(clear);
  }

  void dwell() {
    NcMotion pause;
    pause.kind = NcMotionKind::Dwell;
    pause.from = pause.to = state_.position;
    pause.duration = state_.cycle_dwell;
    motions_.push_back(pause);
  }

  Eigen::Vector3d at_height(double height) const {
    Eigen::Vector3d point = state_.position;
    point[state_.plane.across] = height;
    return point;
  }
  void rapid_to_height(double height) { rapid(at_height(height)); }
  void feed_to_height(double height) {
    const Eigen::Vector3d to = at_height(height);
    add(NcMotionKind::Feed, to, feed_time(state_, place_, (to - state_.position).norm()));
  }
  void rapid(const Eigen::Vector3d& to) {
    if (to != state_.position) add(NcMotionKind::Rapid, to, std::numeric_limits<double>::quiet_NaN());
  }
  void add(NcMotionKind kind, const Eigen::Vector3d& to, double duration) {
    if (motions_.size() > kMostMotions)
      place_.refuse("the cycle makes more than 100000 motions", "are L and Q as meant?");
    NcMotion motion;
    motion.kind = kind;
    motion.from = state_.position;
    motion.to = to;
    motion.duration = duration;
    motions_.push_back(motion);
    state_.position = to;
  }

  int motion_;
  const NcCommands& commands_;
  const NcPlace& place_;
  NcState& state_;
  std::vector<NcMotion>& motions_;
  double plane_ = 0.0;
  double bottom_ = 0.0;
  int repetitions_ = 1;
};

}  // namespace

bool is_cycle(int motion) { return motion == 730 || (motion >= 810 && motion <= 890); }

void append_cycle(int motion, const NcCommands& commands, const NcPlace& place, NcState& state,
                  std::vector<NcMotion>& motions) {
  if (!commands.has_axis_words())
    place.refuse(g_code_name(motion) + " names no axis", "write where the hole is");
  if (state.feed_mode == NcFeedMode::InverseTime)
    place.refuse(g_code_name(motion) + " stands under G93", "write cycles under G94");
  DrillingCycle(motion, commands, place, state, motions).run();
}

}  // namespace volcal
