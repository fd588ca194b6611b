#include "volcal/model/effects/effect_name.h"

#include <algorithm>
#include <array>
#include <utility>

namespace volcal {
namespace {

using Kind = Variable::Kind;

constexpr std::string_view kToolWord = "tool", kStationWord = "station", kStationsWord = "stations",
                           kReadingsWord = "readings", kOf = " of ", kDirectionLetters = "xyz";

std::string joined_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string with_direction(std::string text, std::optional<int> direction) {
  if (direction) text += std::string(" ") + kDirectionLetters[static_cast<std::size_t>(*direction)];
  return text;
}

/// "long x" as a name and a direction; all of it as a name where it ends in none.
std::pair<std::string, std::optional<int>> owner_and_direction(std::string_view text) {
  const std::size_t space = text.rfind(' ');
  const std::string_view last = space == std::string_view::npos ? text : text.substr(space + 1);
  const std::size_t direction = last.size() == 1 ? kDirectionLetters.find(last[0]) : std::string_view::npos;
  if (direction == std::string_view::npos) return {std::string(text), std::nullopt};
  const std::string_view owner = space == std::string_view::npos ? std::string_view{} : text.substr(0, space);
  return {std::string(owner), static_cast<int>(direction)};
}

/// What follows a word and a blank; absent where the text begins otherwise.
std::optional<std::string_view> after_word(std::string_view text, std::string_view word) {
  if (!text.starts_with(word) || text.size() <= word.size() + 1 || text[word.size()] != ' ')
    return std::nullopt;
  return text.substr(word.size() + 1);
}

std::optional<std::vector<ErrorSymbol>> motions_in(std::string_view text) {
  std::vector<ErrorSymbol> motions;
  for (const std::string& word : words_in(std::string(text))) {
    const auto motion = ErrorSymbol::parse(word);
    if (!motion) return std::nullopt;
    motions.push_back(*motion);
  }
  return motions;
}

}  // namespace

TargetName::TargetName(ErrorSymbol motion) : name_(motion.name()), errors_{motion} {}

TargetName::TargetName(LocationSymbol location) : name_(location.name()), errors_{location} {}

TargetName::TargetName(const std::vector<ErrorSymbol>& motions) : errors_(motions.begin(), motions.end()) {
  name_ = joined_words(names_of(errors_));
}

TargetName TargetName::of_tool(const std::string& tool, std::optional<int> direction) {
  TargetName target;
  if (!tool.empty()) target.owner_ = Variable{.kind = Kind::Tool, .subject = tool};
  target.name_ = with_direction(target.owner_ ? target.owner_->name() : std::string(kToolWord), direction);
  return target;
}

TargetName TargetName::of_station(const std::string& station, std::optional<int> direction) {
  TargetName target;
  if (!station.empty()) target.owner_ = Variable{.kind = Kind::Station, .subject = station};
  target.name_ =
      with_direction(target.owner_ ? target.owner_->name() : std::string(kStationsWord), direction);
  return target;
}

TargetName TargetName::of_readings(const std::string& setup) {
  return called(std::string(kReadingsWord) + (setup.empty() ? "" : std::string(kOf) + setup));
}

TargetName TargetName::called(std::string name) {
  TargetName target;
  target.name_ = std::move(name);
  return target;
}

TargetName TargetName::within(const std::string& part) const {
  TargetName target = *this;
  target.name_ += std::string(kOf) + part;
  return target;
}

TargetName TargetName::parse(std::string_view text) {
  if (const std::size_t of = text.find(kOf); of != std::string_view::npos)
    return parse(text.substr(0, of)).within(std::string(text.substr(of + kOf.size())));
  TargetName target;
  if (const auto location = LocationSymbol::parse(text)) {
    target = *location;
  } else if (const auto motions = motions_in(text); motions && !motions->empty()) {
    target = TargetName(*motions);
  } else if (const auto tool = after_word(text, kToolWord)) {
    const auto [owner, direction] = owner_and_direction(*tool);
    target = of_tool(owner, direction);
  } else if (const auto station = after_word(text, kStationWord)) {
    const auto [owner, direction] = owner_and_direction(*station);
    target = owner.empty() ? called(std::string(text)) : of_station(owner, direction);
  }
  target.name_ = text;  // as it stands in the file, blanks and all
  return target;
}

EffectDriver::EffectDriver(const Variable& variable) : EffectDriver(std::vector{variable}) {}

EffectDriver::EffectDriver(const std::vector<Variable>& variables)
    : name_(joined_words(names_of(variables))), variables_(variables) {}

EffectDriver EffectDriver::written(const std::vector<Variable>& variables) {
  return called(written_list(variables), variables);
}

EffectDriver EffectDriver::called(std::string name, std::vector<Variable> variables,
                                  std::vector<Variable> where) {
  EffectDriver driver;
  driver.name_ = std::move(name);
  driver.variables_ = std::move(variables);
  driver.where_ = std::move(where);
  return driver;
}

EffectDriver EffectDriver::parse(std::string_view text) {
  std::vector<Variable> variables;
  const std::string name(text);
  if (const auto whole = Variable::parse(name); whole && whole->is_indicator()) {
    variables.push_back(*whole);
  } else {
    for (const std::string& word : words_in(name)) {
      if (const auto variable = Variable::parse(word)) variables.push_back(*variable);
    }
  }
  return called(name, std::move(variables));
}

bool EffectDriver::has(const Variable& variable) const {
  return std::ranges::find(variables_, variable) != variables_.end();
}

bool EffectDriver::is(const Variable& variable) const {
  return variables_.size() == 1 && variables_.front() == variable;
}

std::optional<EffectName> EffectName::parse(std::string_view text) {
  std::array<std::string_view, 4> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    // an expression as the shape may have colons of its own
    const std::size_t end = i + 1 < parts.size() ? text.find(':') : text.size();
    if (end == std::string_view::npos || end == 0) return std::nullopt;
    parts[i] = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return of_parts(std::string(parts[0]), parts[1], parts[2], std::string(parts[3]));
}

EffectName EffectName::of_parts(std::string kind, std::string_view target, std::string_view driver,
                                std::string shape) {
  return {std::move(kind), TargetName::parse(target), EffectDriver::parse(driver), std::move(shape)};
}

std::string full_name(const EffectName& name) {
  return name.kind + ":" + name.target.name() + ":" + name.driver.name() + ":" + name.shape;
}

}  // namespace volcal
