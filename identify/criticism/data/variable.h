#pragma once
/// What is recorded with every reading and may drive an effect, as a type: names in files, words of `volcal
/// diagnose
/// --list` and what an effect may have to do with it derive from its kind.

#include <compare>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/symbols.h"

namespace volcal {

/// A pattern of a word and its meaning; what is in capitals stands for something of the user's files.
struct EffectWord {
  std::string_view pattern;  ///< "readings of SETUP"
  std::string_view meaning;
  std::string_view kind = {};  ///< the only one that has it; "common-": all that start so; empty: any
};

struct Variable {
  enum class Kind {
    Position,
    Direction,
    Speed,
    Time,
    Temperature,
    Length,
    Elevation,
    Run,
    Feed,
    Instrument,
    Tool,
    Station,
    TravelSinceTurning
  };
  Kind kind = Kind::Time;
  AxisName axis = AxisName::X;  ///< of a position, direction, speed or travel
  std::string subject = {};     ///< temperature channel, instrument, tool or station

  /// As in files: "x", "dir_x", "speed_x", "time", "T_air", "length", "tool side", "station P1".
  std::string name() const;
  /// Absent where it names no variable.
  static std::optional<Variable> parse(std::string_view name);

  /// Whether a reading belongs to something; of one kind only one does.
  bool is_indicator() const;
  /// The machine knows it and a beam does not: position, direction, speed.
  bool is_machine_state() const;
  /// A beam knows it and the machine does not: length, elevation, instrument.
  bool is_of_the_beam() const;
  /// Time, or a temperature, which are functions of each other.
  bool is_of_environment() const;

  friend bool operator==(const Variable&, const Variable&) = default;
  friend auto operator<=>(const Variable&, const Variable&) = default;
};

std::vector<std::string> names_of(const std::vector<Variable>& variables);

/// Words for what scans without a catalogue go through, in the order of Variable::Kind.
std::span<const EffectWord> scan_words();

}  // namespace volcal
