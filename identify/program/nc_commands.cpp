#include "volcal/identify/program/nc_commands.h"

#include <fmt/format.h>

#include <cstddef>

namespace volcal {
namespace {

struct RefusedCodes {
  int first;  ///< tenths, both included
  int last;
  const char* what;
  const char* remedy;
};

constexpr std::array kRefusedG = std::to_array<RefusedCodes>({
    {50, 53, "splines", "let the CAM system write lines and arcs"},
    {70, 89, "lathe modes", "only mills with axes X, Y and Z are compensated"},
    {150, 169, "polar coordinates", "write X, Y and Z coordinates"},
    {280, 309, "moves to a stored position, which the program does not hold", "write G53 and the position"},
    {330, 339, "threads and rigid tapping", "take the block out; it must follow the spindle"},
    {380, 389, "probing", "take it out; its result is not known beforehand"},
    {410, 429, "cutter compensation", "let the CAM system write the path of the tool's centre"},
    {500, 519, "scaling and mirroring", "let the CAM system write the scaled path"},
    {680, 699, "rotated coordinates", "let the CAM system write the rotated path"},
    {700, 729, "a cycle of lathes", "let the CAM system write lines and arcs"},
    {740, 749, "left-hand tapping", "take the cycle out; it must follow the spindle"},
    {760, 769, "a threading or boring cycle", "write its motions as G0 and G1"},
    {840, 849, "tapping", "take the cycle out; it must follow the spindle"},
    {860, 889, "a boring cycle that stops the spindle", "write its motions as G0 and G1"},
    {960, 969, "constant surface speed", "only mills with axes X, Y and Z are compensated"},
});

[[noreturn]] void refuse_g(const NcWord& word, const NcPlace& place) {
  const int code = word.code();
  for (const RefusedCodes& refused : kRefusedG) {
    if (code >= refused.first && code <= refused.last)
      place.refuse(fmt::format("{} ({}) is not followed", g_code_name(code), refused.what), refused.remedy);
  }
  place.refuse(fmt::format("G{:g} is unknown", word.value),
               "write the codes of RS-274 that the guide lists, or take it out");
}

/// The group that a code belongs to; nothing for codes without one.
int* group_of(int code, NcCommands& commands) {
  switch (code) {
    case 0:
    case 10:
    case 20:
    case 30:
    case 730:
    case 800:
    case 810:
    case 820:
    case 830:
    case 850:
    case 890:
      return &commands.motion;
    case 40:
    case 100:
    case 520:
    case 920:
    case 921:
    case 922:
    case 923:
      return &commands.non_modal;
    case 170:
    case 180:
    case 190:
      return &commands.plane;
    case 200:
    case 210:
      return &commands.units;
    case 900:
    case 910:
      return &commands.distance;
    case 901:
    case 911:
      return &commands.arc_distance;
    case 930:
    case 940:
    case 950:
      return &commands.feed_mode;
    case 430:
    case 431:
    case 490:
      return &commands.tool_length;
    case 540:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590:
    case 591:
    case 592:
    case 593:
      return &commands.work_offset;
    case 980:
    case 990:
      return &commands.retract;
    case 610:
    case 611:
    case 640:
      return &commands.path_control;
    default:
      return nullptr;
  }
}

void add_g(const NcWord& word, const NcPlace& place, NcAxes axes, NcCommands& commands) {
  constexpr int kMachineAxes = 530, kNoCutterCompensation = 400, kSpindleSpeed = 970, kToolCentrePoint = 434;
  const int code = word.code();
  if (code == kMachineAxes) {
    commands.machine_axes = true;
    return;
  }
  if (code == kNoCutterCompensation || code == kSpindleSpeed) return;
  const bool turns = code == kToolCentrePoint && axes == NcAxes::WithRotary;
  int* const group = turns ? &commands.tool_length : group_of(code, commands);
  if (group == nullptr) refuse_g(word, place);
  // G80 beside a motion ends a cycle and is otherwise silent.
  constexpr int kCancelCycle = 800;
  if (group == &commands.motion && *group != kNoCode && code == kCancelCycle) return;
  if (*group != kNoCode && *group != kCancelCycle)
    place.refuse(fmt::format("{} and {} exclude each other", g_code_name(*group), g_code_name(code)),
                 "write them in two blocks");
  *group = code;
  if (group != &commands.motion) commands.mark_settings();
}

bool is_known_m(int number) {
  return number <= 9 || number == 19 || number == 30 || (number >= 48 && number <= 53) || number == 60 ||
         (number >= 62 && number <= 68) || (number >= 100 && number <= 199);
}

void add_m(const NcWord& word, const NcPlace& place, NcCommands& commands) {
  const int code = word.code();
  const int number = code / 10;
  if (code < 0 || code % 10 != 0 || !is_known_m(number)) {
    const bool subprogram = number >= 96 && number <= 99;
    place.refuse(fmt::format("M{:g} is {}", word.value,
                             subprogram ? "a subprogram, which is not followed" : "unknown"),
                 subprogram ? "write the program without subprograms" : "take it out if it moves no axis");
  }
  commands.program_end = commands.program_end || number == 2 || number == 30;
  commands.stop = commands.stop || number <= 2 || number == 30 || number == 60;
  commands.outputs = commands.outputs || (number >= 50 && number != 60);
}

void refuse_axis(char letter, const NcPlace& place, NcAxes axes) {
  const bool rotary = letter == 'A' || letter == 'B' || letter == 'C';
  if (rotary && axes == NcAxes::Linear)
    place.refuse(
        fmt::format("{} moves a rotary axis", letter),
        "only programs of X, Y and Z are compensated, and those with tool centre point motion (G43.4 H "
        "or TRAORI)");
  if (letter == 'U' || letter == 'V' || letter == 'W')
    place.refuse(fmt::format("{} moves a secondary axis or increments", letter),
                 "write X, Y and Z with G90 or G91");
  if (letter == 'D') place.refuse("D belongs to cutter compensation, which is not followed", "take it out");
}

}  // namespace

std::string g_code_name(int tenths) {
  return tenths % 10 == 0 ? fmt::format("G{}", tenths / 10) : fmt::format("G{}.{}", tenths / 10, tenths % 10);
}

NcCommands commands_of(const NcBlock& block, const NcPlace& place, NcAxes axes) {
  NcCommands commands;
  for (const NcWord& word : block.words) {
    if (word.letter == 'G') {
      add_g(word, place, axes, commands);
    } else if (word.letter == 'M') {
      add_m(word, place, commands);
    } else {
      refuse_axis(word.letter, place, axes);
      if (commands.has(word.letter))
        place.refuse(fmt::format("{} stands twice", word.letter), "write it once, or two blocks");
      commands.set(word.letter, word.value);
    }
  }
  return commands;
}

}  // namespace volcal
