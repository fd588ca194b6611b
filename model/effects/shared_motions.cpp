#include "volcal/model/effects/shared_motions.h"

#include <algorithm>
#include <set>

#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

std::vector<std::string> words_of(const EffectTable& table, const char* key, const char* remedy) {
  std::vector<std::string> words = words_in(table.text(key, remedy));
  if (words.size() < 2) table.fail("one cause in several places needs two or more", remedy);
  if (std::set<std::string>(words.begin(), words.end()).size() < words.size())
    table.fail("it names one twice", remedy);
  return words;
}

/// Linear axes with two or more values of what is known.
template <class Column, class IsKnown>
std::vector<AxisName> axes_whose(const Campaign& campaign, const Column& column, const IsKnown& is_known) {
  std::vector<AxisName> axes;
  for (const AxisName axis : kLinearAxes) {
    if (!campaign.machine.has_axis(axis)) continue;
    std::set<double> values;
    for (const Setup& setup : campaign.setups) {
      for (const auto value : column(setup.readings, index_of(axis))) {
        if (is_known(value)) values.insert(static_cast<double>(value));
      }
    }
    if (values.size() > 1) axes.push_back(axis);
  }
  return axes;
}

}  // namespace

std::vector<AxisName> shared_axes(const EffectTable& table) {
  constexpr const char* kRemedy = "write axes = \"X Y Z\"";
  std::vector<AxisName> axes;
  for (const std::string& word : words_of(table, "axes", kRemedy)) {
    const auto axis = word.size() == 1 ? axis_from_letter(word[0]) : std::nullopt;
    if (!axis || is_rotary(*axis)) table.fail("\"" + word + "\" is not a linear axis", kRemedy);
    axes.push_back(*axis);
  }
  return axes;
}

std::vector<ErrorSymbol> shared_symbols(const EffectTable& table) {
  constexpr const char* kRemedy = "write symbols = \"EXX EYY EZZ\"";
  std::vector<ErrorSymbol> symbols;
  for (const std::string& word : words_of(table, "symbols", kRemedy)) {
    const auto symbol = ErrorSymbol::parse(word);
    if (!symbol) table.fail("\"" + word + "\" is not an error motion", kRemedy);
    symbols.push_back(*symbol);
    if (is_rotation(symbol->component) != is_rotation(symbols.front().component))
      table.fail("one amplitude is not both a displacement and a rotation", "name motions of one unit");
  }
  return symbols;
}

KeySchema shared_axes_key(const std::string& help) {
  return {.key = "axes", .type = KeyType::Text, .required = true, .help = help};
}

KeySchema shared_symbols_key(const std::string& help) {
  return {.key = "symbols", .type = KeyType::Text, .required = true, .help = help};
}

std::vector<ErrorSymbol> positioning_errors(const std::vector<AxisName>& axes) {
  std::vector<ErrorSymbol> symbols;
  symbols.reserve(axes.size());
  for (const AxisName axis : axes) symbols.push_back({positioning_component(axis), axis});
  return symbols;
}

std::string names_of_symbols(const std::vector<ErrorSymbol>& symbols) {
  std::string names;
  for (const ErrorSymbol symbol : symbols) names += (names.empty() ? "" : " ") + symbol.name();
  return names;
}

std::string names_of_axes(const std::vector<AxisName>& axes) {
  std::string names;
  for (const AxisName axis : axes) names += (names.empty() ? "" : " ") + std::string(1, letter_of(axis));
  return names;
}

std::vector<EffectTarget> targets_of(const std::vector<ErrorSymbol>& symbols) {
  std::vector<EffectTarget> targets;
  targets.reserve(symbols.size());
  for (const ErrorSymbol symbol : symbols) targets.push_back({.kind = TargetKind::Motion, .symbol = symbol});
  return targets;
}

std::vector<AxisName> axes_that_move(const Campaign& campaign) {
  return axes_whose(
      campaign,
      [](const Readings& readings, std::size_t axis) -> const auto& { return readings.position[axis]; },
      [](double /*position*/) { return true; });
}

std::vector<AxisName> axes_that_turn_round(const Campaign& campaign) {
  return axes_whose(
      campaign,
      [](const Readings& readings, std::size_t axis) -> const auto& { return readings.direction[axis]; },
      [](std::int8_t direction) { return direction != 0; });
}

}  // namespace volcal
