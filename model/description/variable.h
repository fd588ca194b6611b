#pragma once
/// What is recorded with a reading, or follows from that, and may drive an effect: its names in files,
/// expressions and results, its unit and its axis derive from its kind.

#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/symbols.h"
#include "volcal/model/description/units.h"

namespace volcal {

struct Variable {
  enum class Kind {
    Position,
    Direction,  ///< of approach
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
    TravelSinceTurning,
    ToolLength,
    ToolOffset
  };
  Kind kind = Kind::Time;
  AxisName axis = AxisName::X;  ///< of a position, direction, speed or travel
  std::string subject = {};     ///< temperature channel, instrument, tool or station
  int component = 0;            ///< of a tool's offset: 0, 1, 2 = x, y, z

  /// As scans and results call it: "x", "dir_x", "speed_x", "time", "T_air", "length", "tool side",
  /// "station P1", "travel since dir_x", "tool_length", "tool_x".
  std::string name() const;
  /// As users write of it in expressions and lists of drivers: "t", "since_x" and "T_front_bearing" (of a
  /// channel "front bearing"), all others by their names.
  std::string written() const;
  /// Of a name or of what is written; absent where the text is neither.
  static std::optional<Variable> parse(std::string_view text);
  /// Of what users may write; absent where the text is not a variable of expressions.
  static std::optional<Variable> parse_written(std::string_view text);

  /// Column of files of readings: "x_mm", "dir_x", "time_s", "T_air_degC", "feed_mm_min", "run"; of what is
  /// in no column, what is written.
  std::string column() const;
  /// Of such a column; absent for other columns.
  static std::optional<Variable> parse_column(std::string_view column);

  /// In which users write of its values: mm, deg, s, degC, mm/min; dimensionless for the others.
  Unit unit() const;
  bool has_axis() const;
  /// Whether a reading belongs to something; of one kind only one does.
  bool is_indicator() const;
  /// The machine knows it and a beam does not: position, direction, speed.
  bool is_machine_state() const;
  /// A beam knows it and the machine does not: length, elevation, instrument.
  bool is_of_the_beam() const;
  /// Time, or a temperature, which are functions of each other.
  bool is_of_environment() const;
  /// It differs between readings at one pose of one machine: time, temperature, feed.
  bool changes_at_rest() const;

  friend bool operator==(const Variable&, const Variable&) = default;
  friend auto operator<=>(const Variable&, const Variable&) = default;
};

Variable position_of(AxisName axis);
Variable direction_of_approach(AxisName axis);
Variable temperature_of(const std::string& channel);
/// Of a channel, or time where that is empty.
Variable temperature_or_time(const std::string& channel);

/// "AXIS", "T_CHANNEL": the pattern of a kind's names; what is in capitals stands for something of the user's
/// files.
std::string_view pattern_of(Variable::Kind kind);

std::vector<std::string> names_of(const std::vector<Variable>& variables);
/// As users write of them.
std::vector<std::string> written_names(const std::vector<Variable>& variables);
/// As a list with blanks: "y T_column".
std::string written_list(const std::vector<Variable>& variables);
/// What is in such a list. Throws std::invalid_argument for a word that is no variable.
std::vector<Variable> variables_in(const std::string& list);

/// A place, a value for each variable in its unit: "y = 310 mm, z = -120 mm". Three digits, no fewer than to
/// the unit.
std::string place_in_words(const std::vector<Variable>& variables, const std::vector<double>& at);

/// Name of a channel in expressions: T_ and the channel, what is no letter or digit replaced by _.
std::string channel_variable(const std::string& channel);

/// Words of a list with blanks.
std::vector<std::string> words_in(const std::string& list);

}  // namespace volcal
