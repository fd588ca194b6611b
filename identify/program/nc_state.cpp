#include "volcal/identify/program/nc_state.h"

#include <fmt/format.h>

#include <cmath>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr int kWorkCodes[kWorkOffsets] = {540, 550, 560, 570, 580, 590, 591, 592, 593};

void apply_feed_mode(const NcCommands& commands, NcState& state) {
  if (commands.feed_mode == kNoCode) return;
  const NcFeedMode mode = commands.feed_mode == 930   ? NcFeedMode::InverseTime
                          : commands.feed_mode == 940 ? NcFeedMode::PerMinute
                                                      : NcFeedMode::PerTurn;
  if (mode != state.feed_mode) state.feed = 0.0;
  state.feed_mode = mode;
}

void apply_numbers(const NcCommands& commands, const NcPlace& place, NcState& state) {
  if (commands.has('F')) {
    if (commands.value('F') < 0.0) place.refuse("the feed is negative", "write a positive F");
    state.feed = commands.value('F');
  }
  if (commands.has('S')) state.spindle_speed = commands.value('S');
}

void apply_units(const NcCommands& commands, const NcPlace& place, NcState& state) {
  if (commands.units == kNoCode) return;
  const double unit = commands.units == 200 ? kMetrePerInch : kMetrePerMillimetre;
  if (unit == state.unit) return;
  if (commands.has('F'))
    place.refuse("F stands in the block that changes the unit of length", "write F in a block after it");
  if (state.unit != 0.0) state.feed = 0.0;
  state.unit = unit;
}

void apply_tool_length(const NcCommands& commands, const NcSetup& setup, const NcPlace& place,
                       NcState& state) {
  if (commands.tool_length == kNoCode) return;
  state.length_active = commands.tool_length != 490;
  if (commands.tool_length == 490) {
    state.length.setZero();
  } else if (commands.tool_length == 430) {
    state.length = {0.0, 0.0, given_tool_length(commands, setup, place)};
  } else {
    for (int i = 0; i < 3; ++i) {
      const char letter = kNcAxisLetters[static_cast<std::size_t>(i)];
      if (commands.has(letter)) state.length[i] = commands.value(letter) * require_unit(state, place);
    }
  }
}

void apply_work_offset(const NcCommands& commands, NcState& state) {
  for (std::size_t i = 0; i < kWorkOffsets; ++i) {
    if (kWorkCodes[i] == commands.work_offset) state.work = i;
  }
}

void apply_modes(const NcCommands& commands, NcState& state) {
  if (commands.plane != kNoCode) state.plane = NcPlane::of_code(commands.plane);
  if (commands.distance != kNoCode) state.incremental = commands.distance == 910;
  if (commands.arc_distance != kNoCode) state.absolute_centre = commands.arc_distance == 901;
  if (commands.retract != kNoCode) state.retract_to_plane = commands.retract == 990;
}

/// G10 L2 Pn X Y Z: a work offset.
void set_work_offset(const NcCommands& commands, const NcPlace& place, NcState& state) {
  if (commands.value_or_zero('L') != 2.0 || commands.has('R'))
    place.refuse("of G10 only L2 without R is followed",
                 "set tools and other offsets on the control, and give them here");
  if (state.incremental)
    place.refuse("G10 L2 stands under G91; controls differ in what it then does", "write it under G90");
  const double number = commands.value_or_zero('P');
  if (number != std::floor(number) || number < 0.0 || number > static_cast<double>(kWorkOffsets))
    place.refuse(fmt::format("G10 L2 P{:g} is not a work offset", number),
                 "write P1 for G54 up to P9 for G59.3");
  const std::size_t index = number == 0.0 ? state.work : static_cast<std::size_t>(number) - 1;
  auto& offset = state.work_offsets[index];
  const bool all = commands.has('X') && commands.has('Y') && commands.has('Z');
  if (!offset && !all)
    place.refuse(
        fmt::format("G10 sets a part of {}, whose other axes are not given", work_offset_name(index)),
        fmt::format("add --work-offset {}=X...,Y...,Z... in mm", work_offset_name(index)));
  if (!offset) offset = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const char letter = kNcAxisLetters[static_cast<std::size_t>(i)];
    if (commands.has(letter)) (*offset)[i] = commands.value(letter) * require_unit(state, place);
  }
}

/// G52 and G92 share a register in some controls and not in others.
void require_one_local_code(int code, const NcPlace& place, NcState& state) {
  if (state.local_code != kNoCode && state.local_code != code)
    place.refuse("G52 and G92 stand in one program; controls differ in whether they add up",
                 "use one of the two");
  state.local_code = code;
}

void set_local_offset(const NcCommands& commands, const NcPlace& place, NcState& state) {
  require_one_local_code(commands.non_modal, place, state);
  if (!commands.has_axis_words())
    place.refuse(g_code_name(commands.non_modal) + " names no axis", "write X, Y or Z behind it");
  const Eigen::Vector3d origin = program_origin(state, place) - state.local;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!commands.has(kNcAxisLetters[i])) continue;
    const auto k = static_cast<Eigen::Index>(i);
    const double value = commands.value(kNcAxisLetters[i]) * require_unit(state, place);
    if (commands.non_modal == 920 && !state.known[i])
      place.refuse(fmt::format("G92 {} stands before the position of {} is known", kNcAxisLetters[i],
                               kNcAxisLetters[i]),
                   "move the axis under G90 first, or give --start");
    state.local[k] = commands.non_modal == 520 ? value : state.position[k] - origin[k] - value;
  }
  if (commands.non_modal == 920) state.stored_local = state.local;
}

void apply_non_modal(const NcCommands& commands, const NcPlace& place, NcState& state) {
  switch (commands.non_modal) {
    case 100:
      set_work_offset(commands, place, state);
      break;
    case 520:
    case 920:
      set_local_offset(commands, place, state);
      break;
    case 921:
      require_one_local_code(920, place, state);
      state.local.setZero();
      state.stored_local = state.local;
      break;
    case 922:
      require_one_local_code(920, place, state);
      state.local.setZero();
      break;
    case 923:
      if (!state.stored_local) place.refuse("G92.3 restores what no G92 has stored", "write G92 before it");
      state.local = *state.stored_local;
      break;
    default:
      break;
  }
}

}  // namespace

std::string work_offset_name(std::size_t index) { return g_code_name(kWorkCodes[index]); }

std::optional<std::size_t> work_offset_index(const std::string& name) {
  for (std::size_t i = 0; i < kWorkOffsets; ++i) {
    if (work_offset_name(i) == name) return i;
  }
  return std::nullopt;
}

NcState initial_state(const NcSetup& setup) {
  NcState state;
  state.unit = setup.length_unit;
  state.work_offsets = setup.work_offsets;
  state.position = setup.home;
  if (setup.start) {
    state.position = *setup.start;
    state.known.fill(true);
  }
  return state;
}

Eigen::Vector3d program_origin(const NcState& state, const NcPlace& place) {
  const auto& work = state.work_offsets[state.work];
  if (!work)
    place.refuse(
        fmt::format("the program moves in {}, whose offset is not given", work_offset_name(state.work)),
        fmt::format("add --work-offset {}=X...,Y...,Z... in mm", work_offset_name(state.work)));
  return *work + state.local + state.length;
}

double given_tool_length(const NcCommands& commands, const NcSetup& setup, const NcPlace& place) {
  const std::string code = g_code_name(commands.tool_length);
  if (!commands.has('H'))
    place.refuse(code + " stands without H; controls differ in which tool's length they then take",
                 "write " + code + " H and the number of the tool");
  const double number = commands.value('H');
  const auto found = setup.tool_lengths.find(static_cast<int>(number));
  if (number != std::floor(number) || found == setup.tool_lengths.end())
    place.refuse(fmt::format("the length of tool H{:g} is not given", number),
                 fmt::format("add --tool-length H{:g}=LENGTH in mm", number));
  return found->second;
}

double require_unit(const NcState& state, const NcPlace& place) {
  if (state.unit == 0.0)
    place.refuse("the unit of length is not known here",
                 "write G21 or G20 before it, or give --units mm or inch");
  return state.unit;
}

void apply_settings(const NcCommands& commands, const NcSetup& setup, const NcPlace& place, NcState& state) {
  apply_feed_mode(commands, state);
  apply_numbers(commands, place, state);
  if (!commands.has_settings()) return;
  apply_units(commands, place, state);
  apply_modes(commands, state);
  apply_tool_length(commands, setup, place, state);
  apply_work_offset(commands, state);
  apply_non_modal(commands, place, state);
}

}  // namespace volcal
