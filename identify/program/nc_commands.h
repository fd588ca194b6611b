#pragma once
/// What a block asks for: its words sorted into the modal groups of RS-274 (NISTIR 6556, table 4). Every code
/// that is not tracked is refused by name, with the reason.

#include <array>
#include <cstdint>

#include "volcal/identify/program/nc_block.h"

namespace volcal {

inline constexpr int kNoCode = -1;

/// G codes in tenths (G43.1 is 431) by modal group, kNoCode where the block has none.
struct NcCommands {
  int motion = kNoCode;        ///< G0 G1 G2 G3 G73 G80 to G85 G89
  int non_modal = kNoCode;     ///< G4 G10 G52 G92 G92.1 to G92.3
  bool machine_axes = false;   ///< G53
  int plane = kNoCode;         ///< G17 G18 G19
  int units = kNoCode;         ///< G20 G21
  int distance = kNoCode;      ///< G90 G91
  int arc_distance = kNoCode;  ///< G90.1 G91.1
  int feed_mode = kNoCode;     ///< G93 G94 G95
  int tool_length = kNoCode;   ///< G43 G43.1 G43.4 G49
  int work_offset = kNoCode;   ///< G54 to G59.3
  int retract = kNoCode;       ///< G98 G99
  int path_control = kNoCode;  ///< G61 G61.1 G64
  bool stop = false;           ///< M0 M1 M2 M30 M60: act after the motion
  bool program_end = false;    ///< M2 M30
  bool outputs = false;        ///< M50 to M68, M100 to M199, which have words of their own

  bool has(char letter) const { return (given_ >> (letter - 'A') & 1U) != 0; }
  double value(char letter) const { return values_[static_cast<std::size_t>(letter - 'A')]; }
  /// 0 for what is not given.
  double value_or_zero(char letter) const { return has(letter) ? value(letter) : 0.0; }
  /// A, B and C among them in programs with rotary axes.
  bool has_axis_words() const { return has('X') || has('Y') || has('Z') || has('A') || has('B') || has('C'); }
  /// Something beside motion and coordinates.
  bool has_settings() const { return settings_; }

  void set(char letter, double number) {
    given_ |= 1U << (letter - 'A');
    values_[static_cast<std::size_t>(letter - 'A')] = number;
  }
  void mark_settings() { settings_ = true; }

 private:
  std::uint32_t given_ = 0;
  bool settings_ = false;
  std::array<double, 26> values_;
};

inline constexpr std::array<char, 3> kNcAxisLetters = {'X', 'Y', 'Z'};
inline constexpr std::array<char, 3> kNcCentreLetters = {'I', 'J', 'K'};

/// What a program may move: with rotary axes it says A, B, C and G43.4.
enum class NcAxes { Linear, WithRotary };

/// Throws InputError for codes and words that are not tracked, given twice, or of one modal group.
NcCommands commands_of(const NcBlock& block, const NcPlace& place, NcAxes axes = NcAxes::Linear);

/// A G code in tenths as it is written: "G43.1".
std::string g_code_name(int tenths);

}  // namespace volcal
