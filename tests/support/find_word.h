#pragma once
/// The word of effect_words.h that a part of an effect's name is.

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/model/instruments/registry.h"

namespace volcal::testing_support {

/// "laser-tracer|laser-tracker|..."
inline std::string any_instrument() {
  static const std::regex special(R"([^A-Za-z0-9])");
  std::string names;
  for (const Instrument* instrument : instruments())
    names += (names.empty() ? "" : "|") + std::regex_replace(instrument->schema().name, special, R"(\$&)");
  return names;
}

/// Pattern of a word; only what stands for something in the files varies.
inline std::regex expression_of(std::string_view pattern) {
  const std::pair<std::string_view, std::string> places[] = {
      {"dir_AXIS ...", "dir_[xyzabcuvw]( dir_[xyzabcuvw])*"},
      {"AXIS ...", "[xyzabcuvw]( [xyzabcuvw])*"},
      {"SYMBOL ...", "E[XYZABC]0?[XYZABCUVW]( E[XYZABC]0?[XYZABCUVW])*"},
      {"SYMBOL", "E[XYZABC]0?[XYZABCUVW]"},
      {"AXIS", "[xyzabcuvw]"},
      {"PLANE", "[XYZABCUVW]{2}"},
      {"RUN", "-?[0-9]+"},
      {"TOOL", ".+"},
      {"STATION", ".+"},
      {"SETUP", ".+"},
      {"CHANNEL", ".+"},
      {"TARGET", ".+"},
      {"VARIABLES", ".*"},
      {"EXPRESSION", ".+"},
      {"INSTRUMENT", any_instrument()},
  };
  std::string text;
  while (!pattern.empty()) {
    const auto* const place =
        std::ranges::find_if(places, [&](const auto& each) { return pattern.starts_with(each.first); });
    if (place != std::end(places)) {
      text += place->second;
      pattern.remove_prefix(place->first.size());
      continue;
    }
    if (std::string_view("()-^").find(pattern.front()) != std::string_view::npos) text += '\\';
    text += pattern.front();
    pattern.remove_prefix(1);
  }
  return std::regex(text);
}

/// A kind that ends with a hyphen stands for all that start with it.
inline bool is_of_kind(const EffectWord& word, const std::string& kind) {
  if (word.kind.ends_with('-')) return kind.starts_with(word.kind);
  return word.kind.empty() || word.kind == kind;
}

inline bool is_of_pattern(const std::string& text, std::string_view pattern) {
  static std::map<std::string_view, std::regex> made;
  const auto known = made.find(pattern);
  const std::regex& expression =
      known != made.end() ? known->second : made.emplace(pattern, expression_of(pattern)).first->second;
  return std::regex_match(text, expression);
}

/// Absent when there is none.
inline std::optional<EffectWord> find_word(NamePart part, const EffectName& name) {
  const std::string& text = part == NamePart::Target   ? name.target.name()
                            : part == NamePart::Driver ? name.driver.name()
                                                       : name.shape;
  const auto words = effect_words(part);
  const auto found = std::ranges::find_if(words, [&](const EffectWord& word) {
    return is_of_kind(word, name.kind) && is_of_pattern(text, word.pattern);
  });
  return found == words.end() ? std::nullopt : std::optional(*found);
}

}  // namespace volcal::testing_support
