#include "volcal/identify/program/tcp/tcp_interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "volcal/identify/program/tcp/tcp_words.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr int kTcpRapid = 0, kTcpFeed = 10;

/// G codes that are followed, in tenths.
constexpr std::array kTcpCodes = {0,   10,  40,  170, 180, 190, 200, 210, 400, 430, 434, 490, 530, 540, 550,
                                  560, 570, 580, 590, 591, 592, 593, 610, 640, 800, 900, 930, 940, 980};
/// Those of them that are followed outside the mode alone.
constexpr std::array kOutsideTcp = {430, 434, 530};

bool is_code_of(const auto& codes, int code) { return std::ranges::find(codes, code) != codes.end(); }

}  // namespace

TcpInterpreter::TcpInterpreter(const Machine& machine, NcSetup setup, FunctionalPoint functional_point,
                               std::string file)
    : machine_(machine),
      setup_(std::move(setup)),
      functional_point_(std::move(functional_point)),
      file_(std::move(file)),
      state_(initial_state(setup_)) {
  const bool rotary =
      std::ranges::any_of(machine.axes, [](const Axis& axis) { return is_rotary(axis.name); });
  if (!rotary)
    throw InputError({file_, 0}, "the program has tool centre point motion and the machine no rotary axis",
                     "give the result of the machine that the program is for");
}

Eigen::Vector3d TcpInterpreter::origin() const {
  return program_origin(state_, place()) + functional_point_.lengths_from;
}

/// Into the block; false where the line does nothing.
bool TcpInterpreter::read(std::string_view line) {
  NcBlock& block = step_.said.block;
  if (ended_) {
    block = NcBlock{};
    block.text = line;
    return false;
  }
  parse_block(line, place(), block);
  if (block.percent) {
    ended_ = begun_;
    begun_ = true;
    return false;
  }
  return !block.blank() && !is_deleted(block, setup_, place());
}

void TcpInterpreter::require_followed() const {
  for (const NcWord& word : step_.said.block.words) {
    const int code = word.code();
    if (word.letter != 'G') continue;
    if (is_code_of(kTcpCodes, code) && !(active_ && is_code_of(kOutsideTcp, code))) continue;
    if (active_ && code == kTcpOn)
      place().refuse("tool centre point motion is active already", "end it by G49 first");
    place().refuse(fmt::format("G{:g} is not followed {} tool centre point motion", word.value,
                               active_ ? "in" : "in a program with"),
                   "write G0 and G1 under G90, lines alone; arcs and cycles as short lines");
  }
}

void TcpInterpreter::require_axes() const {
  for (const char letter : kTcpLetters) {
    const auto axis = axis_from_letter(letter);
    if (step_.said.commands.has(letter) && !(axis && machine_.has_axis(*axis)))
      place().refuse(fmt::format("the machine has no axis {}", letter),
                     "give the result of the machine that the program is for");
  }
}

const TcpStep& TcpInterpreter::execute(std::string_view line) {
  ++line_;
  NcStep& said = step_.said;
  said.commands = NcCommands{};
  said.motion = kNoCode;
  said.executed = said.machine_axes = false;
  step_.outside = step_.moves = step_.feed = step_.first = false;
  const TcpName name = ended_ ? TcpName::None : tcp_name(line, place());
  if (name != TcpName::None) {
    said.block = NcBlock{};
    said.block.text = line;
    if (name == TcpName::On) begin_mode(true);
    active_ = name == TcpName::On;
    return step_;
  }
  if (!read(line)) return step_;
  said.executed = true;
  require_followed();
  said.commands = commands_of(said.block, place(), NcAxes::WithRotary);
  require_axes();
  NcCommands settings = said.commands;
  settings.tool_length = kNoCode;  // lengths count in the functional point
  apply_settings(settings, setup_, place(), state_);
  if (said.commands.tool_length == kTcpOn) begin_mode(false);
  move(said.commands.tool_length == kTcpOff);
  refuse_unused_words(said, state_, place());
  if (said.commands.tool_length == kTcpOff) active_ = false;
  ended_ = said.commands.program_end;
  return step_;
}

void TcpInterpreter::begin_mode(bool by_name) {
  if (active_) place().refuse("tool centre point motion is active already", "end it by TRAFOOF first");
  tool_offset_ = functional_point_.without_length;
  if (!by_name)
    tool_offset_ = functional_point_.lengths_from -
                   Eigen::Vector3d(0.0, 0.0, given_tool_length(step_.said.commands, setup_, place()));
  active_ = true;
  point_known_.fill(false);
}

void TcpInterpreter::move(bool ends_mode) {
  NcStep& said = step_.said;
  said.motion = follow_motion_code(said.commands, place(), state_);
  if (said.motion == kNoCode) return;
  if (active_ && ends_mode)
    place().refuse("coordinates in the block of G49", "write them in a block after it");
  said.machine_axes = said.commands.machine_axes;
  if (!active_) return rapid_outside();
  step_.moves = true;
  step_.feed = said.motion == kTcpFeed;
  set_target();
  if (!step_.feed) return;
  if (state_.feed_mode == NcFeedMode::InverseTime && !said.commands.has('F'))
    place().refuse("the block has no F, which every feed motion under G93 needs",
                   "write F, one over minutes");
  feed_time(state_, place(), (step_.to.point_w - step_.from.point_w).norm());
}

/// Outside the mode the axes go where they are sent; the rotary ones are kept in mind.
void TcpInterpreter::rapid_outside() {
  if (step_.said.motion != kTcpRapid)
    place().refuse("a feed motion stands outside tool centre point motion",
                   "write it behind G43.4 H or TRAORI; a program of X, Y and Z with the rotary axes at 0 is "
                   "compensated by itself");
  for (const AxisName axis : kAllAxes) {
    if (!is_rotary(axis) || !step_.said.commands.has(letter_of(axis))) continue;
    step_.to.rotary[direction_of(axis)] = step_.said.commands.value(letter_of(axis)) * kRadianPerDegree;
    rotary_known_[static_cast<std::size_t>(direction_of(axis))] = true;
  }
  step_.outside = true;
}

void TcpInterpreter::set_target() {
  const double unit = require_unit(state_, place());
  const NcCommands& commands = step_.said.commands;
  step_.from = step_.to;
  const Eigen::Vector3d zero = origin();
  const auto was_known = point_known_;
  for (const AxisName axis : kAllAxes) {
    if (!machine_.has_axis(axis)) continue;
    const char letter = letter_of(axis);
    const int k = direction_of(axis);
    bool& known = (is_rotary(axis) ? rotary_known_ : point_known_)[static_cast<std::size_t>(k)];
    if (commands.has(letter)) {
      known = true;
      if (is_rotary(axis)) {
        step_.to.rotary[k] = commands.value(letter) * kRadianPerDegree;
      } else {
        step_.to.point_w[k] = zero[k] + commands.value(letter) * unit;
      }
    }
    if (!known)
      place().refuse(fmt::format("the position of {} is not known here", letter),
                     "move every axis by G0 first; X, Y and Z after tool centre point motion has begun");
  }
  step_.first = was_known != point_known_;
  if (!step_.first) return;
  if (step_.feed)
    place().refuse("a feed motion begins before the positions of X, Y and Z are known",
                   "go to them by G0 behind G43.4 or TRAORI first");
  step_.from = step_.to;
}

}  // namespace volcal
