#include "volcal/identify/io/campaign/column_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

/// Words of a name in lower case; what stands in brackets is a unit and no word.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words = {""};
  for (const char c : name.substr(0, name.find_first_of("[("))) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || byte >= 0x80) {
      words.back() += static_cast<char>(std::tolower(byte));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

bool is_one_of(const std::string& word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

bool says_direction(const std::string& word) {
  return is_one_of(word, {"dir", "direction", "approach", "sense", "richtung"});
}

/// "direction_x", "dirx", "x_dir"; "direction" alone where only one axis can be meant.
std::string meant_direction(const std::vector<std::string>& words, const Machine& machine) {
  for (const Axis& axis : machine.axes) {
    const std::string letter(1, static_cast<char>(std::tolower(letter_of(axis.name))));
    const bool split = words.size() == 2 && ((says_direction(words[0]) && words[1] == letter) ||
                                             (words[0] == letter && says_direction(words[1])));
    const bool joined =
        words.size() == 1 && words[0].size() > 1 &&
        ((words[0].ends_with(letter) && says_direction(words[0].substr(0, words[0].size() - 1))) ||
         (words[0].starts_with(letter) && says_direction(words[0].substr(1))));
    const bool alone = words.size() == 1 && says_direction(words[0]) && machine.axes.size() == 1;
    if (split || joined || alone) return direction_column(axis.name);
  }
  return "";
}

/// "°C" of "T air [°C]".
std::string unit_in_brackets(const std::string& name) {
  const std::size_t open = name.find_first_of("[(");
  if (open == std::string::npos) return "";
  const std::size_t begin = name.find_first_not_of(' ', open + 1);
  const std::size_t close = name.find_first_of("])", open);
  if (begin == std::string::npos || begin >= close) return "";
  const std::string unit = name.substr(begin, close == std::string::npos ? close : close - begin);
  return unit.substr(0, unit.find_last_not_of(' ') + 1);
}

bool is_unit_of_temperature(const std::string& unit) {
  return is_degree_celsius(unit) || is_one_of(unit, {"K", "degF", "\u00B0F"});
}

/// "temp_x", "temperature spindle", "Temp", "T_air_degC": the words behind it name the channel. Where the
/// unit is that of a temperature, as in "T air [°C]" and "spindle [°C]", any words do.
std::string meant_temperature(const std::string& name, const std::vector<std::string>& words) {
  const bool by_unit = is_unit_of_temperature(unit_in_brackets(name)) ||
                       (words.front() == "t" && is_one_of(words.back(), {"degc", "c", "celsius"}));
  const bool by_word = is_one_of(words.front(), {"temp", "temperature", "temperatur"});
  if (!by_unit && !by_word) return "";
  std::string channel;
  for (std::size_t i = by_word || words.front() == "t" ? 1 : 0; i < words.size(); ++i) {
    if (is_one_of(words[i], {"degc", "c", "deg", "celsius"})) continue;
    channel += (channel.empty() ? "" : "_") + words[i];
  }
  return temperature_of(channel.empty() ? "machine" : channel).column();
}

std::string meant_word(const std::string& word) {
  if (is_one_of(word, {"time", "zeit", "timestamp", "t", "elapsed", "seconds"})) return "time_s";
  if (is_one_of(word, {"feed", "feedrate", "vorschub"})) return "feed_mm_min";
  if (is_one_of(word, {"run", "cycle", "lauf", "repeat", "repetition"})) return "run";
  if (is_one_of(word, {"line", "pass", "path", "linie"})) return "line";
  return "";
}

}  // namespace

bool is_degree_celsius(std::string_view unit) {
  static constexpr std::string_view kNames[] = {"degC",  "\u00B0C",  "\u00BAC", "\u2103", "C",
                                                "deg C", "\u00B0 C", "Celsius", "celsius"};
  return std::ranges::find(kNames, unit) != std::end(kNames);
}

std::string meant_column(const std::string& name, const std::vector<std::string>& missing,
                         const Machine& machine) {
  const std::vector<std::string> words = words_of(name);
  if (words.empty()) return "";
  if (std::string temperature = meant_temperature(name, words); !temperature.empty()) return temperature;
  std::string meant = meant_direction(words, machine);
  if (meant.empty()) meant = meant_word(words.front());
  if (meant.empty() && words.size() > 1 && says_direction(words[0])) return "";
  if (meant.empty()) meant = nearest_name(name, missing).value_or("");
  return std::ranges::find(missing, meant) == missing.end() ? "" : meant;
}

}  // namespace volcal
