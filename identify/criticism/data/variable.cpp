#include "volcal/identify/criticism/data/variable.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>

namespace volcal {
namespace {

using Kind = Variable::Kind;

/// In the order of Variable::Kind.
constexpr auto kKinds = std::to_array<EffectWord>({
    {"AXIS", "position of an axis"},
    {"dir_AXIS", "direction of approach of an axis"},
    {"speed_AXIS", "share of the feed along an axis, with its sign, of readings taken in motion"},
    {"time", "time since the first reading of the campaign"},
    {"T_CHANNEL", "temperature of a channel"},
    {"length", "length that is measured"},
    {"elevation", "angle of the beam above the horizontal, at the nominal station"},
    {"run", "number of the run"},
    {"feed", "feed rate"},
    {"instrument INSTRUMENT", "whether the reading is of this instrument"},
    {"tool TOOL", "whether this tool is carried"},
    {"station STATION", "whether the reading was taken from this station"},
    {"travel since dir_AXIS", "how far an axis has gone since it last turned round"},
});

bool is_upper(char letter) { return std::isupper(static_cast<unsigned char>(letter)) != 0; }

/// "dir_" of "dir_AXIS"; "T_" of "T_CHANNEL".
std::string_view prefix_of(std::string_view pattern) {
  std::size_t end = pattern.size();
  while (end > 0 && is_upper(pattern[end - 1])) --end;
  return pattern.substr(0, end);
}

}  // namespace

std::string Variable::name() const {
  const std::string_view pattern = kKinds[static_cast<std::size_t>(kind)].pattern;
  std::string text(prefix_of(pattern));
  if (pattern.ends_with("AXIS")) return text + lower_letter_of(axis);
  return text + subject;
}

std::optional<Variable> Variable::parse(std::string_view name) {
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    const std::string_view pattern = kKinds[kind].pattern, prefix = prefix_of(pattern);
    if (!name.starts_with(prefix)) continue;
    const std::string_view rest = name.substr(prefix.size());
    Variable variable{static_cast<Kind>(kind)};
    if (pattern.ends_with("AXIS")) {
      if (rest.size() != 1 || is_upper(rest[0])) continue;
      const auto axis =
          axis_from_letter(static_cast<char>(std::toupper(static_cast<unsigned char>(rest[0]))));
      if (!axis) continue;
      variable.axis = *axis;
    } else if (prefix == pattern) {
      if (!rest.empty()) continue;
    } else {
      if (rest.empty()) continue;
      variable.subject = rest;
    }
    return variable;
  }
  return std::nullopt;
}

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

std::vector<std::string> names_of(const std::vector<Variable>& variables) {
  std::vector<std::string> names;
  std::ranges::transform(variables, std::back_inserter(names), &Variable::name);
  return names;
}

std::span<const EffectWord> scan_words() { return std::span(kKinds).first(kKinds.size() - 1); }

}  // namespace volcal
