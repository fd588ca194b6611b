#include "volcal/identify/program/nc_interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "volcal/identify/program/nc_cycles.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr int kRapid = 0, kFeed = 10, kClockwise = 20, kCounterClockwise = 30, kCancel = 800;
constexpr int kMostTurns = 1000;

bool is_arc(int motion) { return motion == kClockwise || motion == kCounterClockwise; }

bool has_centre_words(const NcCommands& commands) {
  return commands.has('I') || commands.has('J') || commands.has('K');
}

/// The axis words belong to G10, G52, G92 or G43.1.
bool sets_offset(const NcCommands& commands) {
  return commands.non_modal == 100 || commands.non_modal == 520 || commands.non_modal == 920 ||
         commands.tool_length == 431;
}

/// Letters that the codes of a block use.
std::string letters_used(const NcStep& step, const NcState& state) {
  const NcCommands& commands = step.commands;
  std::string letters = "NFST";
  if (step.motion != kNoCode || sets_offset(commands)) letters += "XYZABC";
  if (is_arc(step.motion)) {
    letters += "RP";
    letters += kNcCentreLetters[static_cast<std::size_t>(state.plane.first)];
    letters += kNcCentreLetters[static_cast<std::size_t>(state.plane.second)];
  }
  if (is_cycle(step.motion)) letters += "RPQL";
  if (commands.non_modal == 40) letters += "P";
  if (commands.non_modal == 100) letters += "LPR";
  if (commands.tool_length == 430 || commands.tool_length == 434) letters += "H";
  if (commands.path_control == 640) letters += "PQ";
  if (commands.outputs) letters += "PQEL";
  return letters;
}

/// Nothing is changed.
int wanted_motion(const NcCommands& commands, const NcPlace& place, const NcState& state) {
  const bool axes = commands.has_axis_words();
  const bool arc =
      is_arc(commands.motion == kNoCode ? state.motion : commands.motion) && has_centre_words(commands);
  if (sets_offset(commands) && (axes || arc)) {
    if (arc || (commands.motion != kNoCode && commands.motion != kCancel))
      place.refuse("a motion and an offset want the same coordinates", "write them in two blocks");
    return kNoCode;
  }
  if (commands.motion == kCancel && axes)
    place.refuse("coordinates in the block of G80", "write them in a block after it");
  if (commands.non_modal == 40 && axes)
    place.refuse("coordinates in the block of G4; controls differ in what they mean",
                 "write them in two blocks");
  if (axes || arc) return commands.motion == kNoCode ? state.motion : commands.motion;
  if (is_arc(commands.motion) || is_cycle(commands.motion))
    place.refuse(g_code_name(commands.motion) + " has no coordinates", "write where it goes");
  return kNoCode;
}

}  // namespace

bool is_deleted(const NcBlock& block, const NcSetup& setup, const NcPlace& place) {
  if (!block.deletable) return false;
  if (!setup.block_delete)
    place.refuse("the block is skipped or run by the control's block-delete switch",
                 "say how it stands: --block-delete on (skip) or off (run)");
  return *setup.block_delete;
}

int follow_motion_code(const NcCommands& commands, const NcPlace& place, NcState& state) {
  const int motion = wanted_motion(commands, place, state);
  const bool moves = motion != kNoCode;
  if (commands.has_axis_words() && !moves && !sets_offset(commands))
    place.refuse("coordinates stand without G0, G1, G2, G3 or a cycle", "write the G code of the motion");
  if (commands.motion != kNoCode) {
    if (commands.motion != state.motion) {
      state.cycle_depth = state.cycle_plane = state.cycle_peck = std::nullopt;
      state.cycle_dwell = 0.0;
    }
    state.motion = commands.motion == kCancel ? kNoCode : commands.motion;
  }
  if (commands.machine_axes && !(moves && motion <= kFeed))
    place.refuse("G53 stands without a motion by G0 or G1", "write G53 G0 and the coordinates");
  return motion;
}

void refuse_unused_words(const NcStep& step, const NcState& state, const NcPlace& place) {
  const std::string used = letters_used(step, state);
  for (const NcWord& word : step.block.words) {
    if (word.letter != 'G' && word.letter != 'M' && used.find(word.letter) == std::string::npos)
      place.refuse(fmt::format("{} belongs to no code of the block", word.letter), "take it out");
  }
}

double feed_time(const NcState& state, const NcPlace& place, double length) {
  if (state.feed <= 0.0)
    place.refuse("no feed is in force", "write F after the unit and the feed mode are set");
  if (state.feed_mode == NcFeedMode::InverseTime) return kSecondsPerMinute / state.feed;
  const double per_minute =
      state.feed_mode == NcFeedMode::PerTurn ? state.feed * state.spindle_speed : state.feed;
  if (per_minute <= 0.0) return std::numeric_limits<double>::quiet_NaN();
  return length / (per_minute * state.unit) * kSecondsPerMinute;
}

NcInterpreter::NcInterpreter(NcSetup setup, std::string file)
    : setup_(std::move(setup)), file_(std::move(file)), state_(initial_state(setup_)) {}

/// Lines that do nothing: blank, %, behind the end, or deleted.
bool NcInterpreter::skips() {
  const NcBlock& block = step_.block;
  if (block.percent) {
    ended_ = begun_;
    begun_ = true;
    return true;
  }
  return block.blank() || is_deleted(block, setup_, place());
}

const NcStep& NcInterpreter::execute(std::string_view line) {
  ++line_;
  step_.motions.clear();
  step_.motion = kNoCode;
  step_.machine_axes = false;
  step_.executed = false;
  if (ended_) {
    step_.block = NcBlock{};
    step_.block.text = line;
    step_.commands = NcCommands{};
    return step_;
  }
  parse_block(line, place(), step_.block);
  if (skips()) {
    step_.commands = NcCommands{};
    return step_;
  }
  step_.executed = true;
  step_.commands = commands_of(step_.block, place());
  apply_settings(step_.commands, setup_, place(), state_);
  move();
  refuse_unused_words(step_, state_, place());
  ended_ = step_.commands.program_end;
  return step_;
}

void NcInterpreter::move() {
  step_.motion = follow_motion_code(step_.commands, place(), state_);
  if (step_.motion == kNoCode) return;
  step_.machine_axes = step_.commands.machine_axes;
  if (step_.motion <= kFeed) {
    rapid_or_feed(step_.motion);
  } else if (is_arc(step_.motion)) {
    arc_motion(step_.motion == kClockwise);
  } else {
    require_known("cycle");
    append_cycle(step_.motion, step_.commands, place(), state_, step_.motions);
  }
}

/// End point of the block; marks its axes as known.
Eigen::Vector3d NcInterpreter::target() {
  const double unit = require_unit(state_, place());
  const bool incremental = state_.incremental && !step_.machine_axes;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (!step_.machine_axes) origin = program_origin(state_, place());
  Eigen::Vector3d to = state_.position;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!step_.commands.has(kNcAxisLetters[i])) continue;
    const auto k = static_cast<Eigen::Index>(i);
    const double value = step_.commands.value(kNcAxisLetters[i]) * unit;
    if (incremental && !state_.known[i])
      place().refuse(fmt::format("{} moves by an increment before its position is known", kNcAxisLetters[i]),
                     "move it under G90 first, or give --start");
    to[k] = incremental ? to[k] + value : origin[k] + value;
  }
  return to;
}

void NcInterpreter::require_known(const char* what) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!state_.known[i])
      place().refuse(fmt::format("the {} begins before the position of {} is known", what, kNcAxisLetters[i]),
                     "move every axis by G0 under G90 first, or give --start");
  }
}

void NcInterpreter::rapid_or_feed(int motion) {
  NcMotion step;
  step.from = state_.position;
  step.to = target();
  if (motion == kFeed) {
    step.kind = NcMotionKind::Feed;
    require_known("feed motion");
    add_feed(step);
  } else {
    step_.motions.push_back(step);
  }
  for (std::size_t i = 0; i < 3; ++i)
    state_.known[i] = state_.known[i] || step_.commands.has(kNcAxisLetters[i]);
  state_.position = step.to;
}

void NcInterpreter::add_feed(NcMotion motion) {
  if (state_.feed_mode == NcFeedMode::InverseTime && !step_.commands.has('F'))
    place().refuse("the block has no F, which every feed motion under G93 needs",
                   "write F, one over minutes");
  motion.duration = feed_time(state_, place(), motion.length());
  step_.motions.push_back(motion);
}

NcArc NcInterpreter::arc_of_block(const NcArcWords& words) const {
  const NcCommands& commands = step_.commands;
  const char first = kNcCentreLetters[static_cast<std::size_t>(words.plane.first)];
  const char second = kNcCentreLetters[static_cast<std::size_t>(words.plane.second)];
  const bool centre_given = commands.has(first) || commands.has(second);
  if (commands.has('R')) {
    if (centre_given) place().refuse("the arc has both R and a centre", "write one of the two");
    if (words.turns > 1) place().refuse("an arc with R has turns P", "write its centre");
    return arc_of_radius(words, commands.value('R') * state_.unit);
  }
  if (!centre_given)
    place().refuse(fmt::format("the arc has neither R nor {} {}", first, second),
                   "write its radius or its centre");
  Eigen::Vector2d centre(commands.value_or_zero(first), commands.value_or_zero(second));
  centre *= state_.unit;
  Eigen::Vector3d from = words.start;
  if (state_.absolute_centre) {
    if (!commands.has(first) || !commands.has(second))
      place().refuse(fmt::format("under G90.1 an arc needs both {} and {}", first, second), "write both");
    from = program_origin(state_, place());
  }
  return arc_about(words, centre + Eigen::Vector2d(from[words.plane.first], from[words.plane.second]));
}

void NcInterpreter::arc_motion(bool clockwise) {
  require_known("arc");
  NcMotion motion;
  motion.kind = NcMotionKind::Arc;
  motion.from = state_.position;
  motion.to = target();
  const double turns = step_.commands.has('P') ? step_.commands.value('P') : 1.0;
  if (turns != std::floor(turns) || turns < 1.0 || turns > kMostTurns)
    place().refuse(fmt::format("P{:g} is not a number of turns", turns), "write 1 to 1000");
  try {
    motion.arc = arc_of_block({state_.plane, motion.from, motion.to, clockwise, static_cast<int>(turns)});
  } catch (const std::invalid_argument& error) {
    place().refuse(error.what(), "correct its end point, its centre or its radius");
  }
  add_feed(motion);
  state_.position = motion.to;
}

}  // namespace volcal
