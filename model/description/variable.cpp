#include "volcal/model/description/variable.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace volcal {
namespace {

using Kind = Variable::Kind;

/// What is in capitals stands for something of the user's files or the machine's.
struct KindName {
  std::string_view name;
  std::string_view written;  ///< in expressions; empty: not there
};

/// In the order of Variable::Kind.
constexpr auto kNames = std::to_array<KindName>({
    {"AXIS", "AXIS"},
    {"dir_AXIS", "dir_AXIS"},
    {"speed_AXIS", ""},
    {"time", "t"},
    {"T_CHANNEL", "T_CHANNEL"},
    {"length", "length"},
    {"elevation", ""},
    {"run", ""},
    {"feed", "feed"},
    {"instrument INSTRUMENT", ""},
    {"tool TOOL", ""},
    {"station STATION", ""},
    {"travel since dir_AXIS", "since_AXIS"},
    {"tool_length", "tool_length"},
    {"tool_DIRECTION", "tool_DIRECTION"},
});

const KindName& names_of_kind(Kind kind) { return kNames[static_cast<std::size_t>(kind)]; }

bool is_upper(char letter) { return std::isupper(static_cast<unsigned char>(letter)) != 0; }

/// "dir_" of "dir_AXIS"; "T_" of "T_CHANNEL".
std::string_view prefix_of(std::string_view pattern) {
  std::size_t end = pattern.size();
  while (end > 0 && is_upper(pattern[end - 1])) --end;
  return pattern.substr(0, end);
}

/// Of a pattern's prefix and what followed it; absent where that is nothing of the kind.
std::optional<Variable> variable_of(Kind kind, std::string_view pattern, std::string_view rest) {
  Variable variable{kind};
  if (pattern.ends_with("AXIS")) {
    if (rest.size() != 1 || is_upper(rest[0])) return std::nullopt;
    const auto axis = axis_from_letter(static_cast<char>(std::toupper(static_cast<unsigned char>(rest[0]))));
    if (!axis) return std::nullopt;
    variable.axis = *axis;
  } else if (pattern.ends_with("DIRECTION")) {
    if (rest.size() != 1 || rest[0] < 'x' || rest[0] > 'z') return std::nullopt;
    variable.component = rest[0] - 'x';
  } else if (is_upper(pattern.back())) {
    if (rest.empty()) return std::nullopt;
    variable.subject = rest;
  } else if (!rest.empty()) {
    return std::nullopt;
  }
  return variable;
}

std::string text_of(const Variable& variable, std::string_view pattern) {
  std::string text(prefix_of(pattern));
  if (pattern.ends_with("AXIS")) return text + lower_letter_of(variable.axis);
  if (pattern.ends_with("DIRECTION")) return text + static_cast<char>('x' + variable.component);
  return text + variable.subject;
}

template <class PatternOf>
std::optional<Variable> parse_by(std::string_view text, const PatternOf& pattern_of_names) {
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    const std::string_view pattern = pattern_of_names(kNames[kind]), prefix = prefix_of(pattern);
    if (pattern.empty() || !text.starts_with(prefix)) continue;
    if (auto variable = variable_of(static_cast<Kind>(kind), pattern, text.substr(prefix.size())))
      return variable;
  }
  return std::nullopt;
}

}  // namespace

std::string Variable::name() const { return text_of(*this, names_of_kind(kind).name); }

std::string Variable::written() const {
  if (kind == Kind::Temperature) return channel_variable(subject);
  const KindName& names = names_of_kind(kind);
  return text_of(*this, names.written.empty() ? names.name : names.written);
}

std::optional<Variable> Variable::parse(std::string_view text) {
  if (auto variable = parse_by(text, [](const KindName& names) { return names.name; })) return variable;
  return parse_written(text);
}

std::optional<Variable> Variable::parse_written(std::string_view text) {
  return parse_by(text, [](const KindName& names) { return names.written; });
}

std::string Variable::column() const {
  switch (kind) {
    case Kind::Position:
      return position_column(axis);
    case Kind::Temperature:
    case Kind::Time:
    case Kind::Feed:
      return name() + "_" + std::string(unit().suffix);
    default:
      return written();
  }
}

std::optional<Variable> Variable::parse_column(std::string_view column) {
  auto variable = parse(stem_of_key(column));
  if (!variable || variable->column() != column) return std::nullopt;
  return variable;
}

Unit Variable::unit() const {
  switch (kind) {
    case Kind::Position:
    case Kind::TravelSinceTurning:
      return position_unit(axis);
    case Kind::Time:
      return {"s", 1.0};
    case Kind::Temperature:
      return {"degC", 1.0};
    case Kind::Elevation:
      return {"deg", kRadianPerDegree};
    case Kind::Feed:
      return {"mm_min", kMetrePerMillimetre / kSecondsPerMinute};
    case Kind::Length:
    case Kind::ToolLength:
    case Kind::ToolOffset:
      return {"mm", kMetrePerMillimetre};
    case Kind::Direction:
    case Kind::Speed:
    case Kind::Run:
    case Kind::Instrument:
    case Kind::Tool:
    case Kind::Station:
      break;
  }
  return {"", 1.0};
}

bool Variable::has_axis() const { return is_machine_state() || kind == Kind::TravelSinceTurning; }

bool Variable::is_indicator() const {
  return kind == Kind::Instrument || kind == Kind::Tool || kind == Kind::Station;
}

bool Variable::is_machine_state() const {
  return kind == Kind::Position || kind == Kind::Direction || kind == Kind::Speed;
}

bool Variable::is_of_the_beam() const {
  return kind == Kind::Length || kind == Kind::Elevation || kind == Kind::Instrument;
}

bool Variable::is_of_environment() const { return kind == Kind::Time || kind == Kind::Temperature; }

bool Variable::changes_at_rest() const { return is_of_environment() || kind == Kind::Feed; }

Variable position_of(AxisName axis) { return {.kind = Kind::Position, .axis = axis}; }
Variable direction_of_approach(AxisName axis) { return {.kind = Kind::Direction, .axis = axis}; }
Variable temperature_of(const std::string& channel) {
  return {.kind = Kind::Temperature, .subject = channel};
}
Variable temperature_or_time(const std::string& channel) {
  return channel.empty() ? Variable{.kind = Kind::Time} : temperature_of(channel);
}

std::string_view pattern_of(Variable::Kind kind) { return names_of_kind(kind).name; }

std::vector<std::string> names_of(const std::vector<Variable>& variables) {
  std::vector<std::string> names;
  std::ranges::transform(variables, std::back_inserter(names), &Variable::name);
  return names;
}

std::vector<std::string> written_names(const std::vector<Variable>& variables) {
  std::vector<std::string> names;
  std::ranges::transform(variables, std::back_inserter(names), &Variable::written);
  return names;
}

std::string written_list(const std::vector<Variable>& variables) {
  std::string text;
  for (const Variable& variable : variables) text += (text.empty() ? "" : " ") + variable.written();
  return text;
}

std::vector<Variable> variables_in(const std::string& list) {
  std::vector<Variable> variables;
  for (const std::string& word : words_in(list)) {
    const auto variable = Variable::parse_written(word);
    if (!variable) throw std::invalid_argument(word + " is not a variable");
    variables.push_back(*variable);
  }
  return variables;
}

std::string place_in_words(const std::vector<Variable>& variables, const std::vector<double>& at) {
  std::ostringstream words;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const std::string unit = unit_text(variables[i].unit().suffix);
    words.precision(std::abs(at[i]) < 1000.0 ? 3 : 5);
    words << (i > 0 ? ", " : "") << variables[i].written() << " = " << at[i] << (unit.empty() ? "" : " ")
          << unit;
  }
  return words.str();
}

std::string channel_variable(const std::string& channel) {
  std::string name = "T_" + channel;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

std::vector<std::string> words_in(const std::string& list) {
  std::istringstream stream(list);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace volcal
