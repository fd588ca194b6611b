#include "volcal/identify/io/import/column_meaning.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "volcal/identify/io/campaign/column_names.h"
#include "volcal/identify/io/import/import_format.h"
#include "volcal/identify/io/import/import_lines.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

bool is_unit(std::string_view text) {
  static constexpr std::string_view kOthers[] = {"s", "ms", "min", "degC", "\u00B0C", "C", "mm/min", "K"};
  return length_unit(text) || angle_unit(text) || std::ranges::find(kOthers, text) != std::end(kOthers);
}

bool is_letter_of_word(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalnum(byte) != 0 || byte >= 0x80;
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words = {""};
  for (const char c : text) {
    if (is_letter_of_word(c)) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

}  // namespace

bool HeaderWords::has(std::initializer_list<std::string_view> any) const {
  return std::ranges::any_of(
      words, [&](const std::string& word) { return std::ranges::find(any, word) != any.end(); });
}

char HeaderWords::letter() const {
  char found = 0;
  for (const std::string& word : words) {
    if (word.size() != 1 || std::string_view("xyzabcuvw").find(word[0]) == std::string_view::npos) continue;
    if (found != 0) return 0;
    found = word[0];
  }
  return found;
}

HeaderWords header_words(const std::string& header) {
  HeaderWords read;
  std::string_view name = header;
  const std::size_t open = name.find_first_of("[(");
  if (open != std::string_view::npos) {
    const std::size_t close = name.find_first_of("])", open);
    read.unit = std::string(
        without_blanks(name.substr(open + 1, close == std::string_view::npos ? close : close - open - 1)));
    name = name.substr(0, open);
  }
  std::vector<std::string> words = split_words(name);
  if (read.unit.empty() && words.size() > 1 && is_unit(words.back())) {
    read.unit = words.back();
    words.pop_back();
  }
  for (const std::string& word : words) read.words.push_back(lower_case(word));
  return read;
}

std::optional<double> factor_to_unit(const std::string& written, std::string_view column_unit) {
  const auto ratio = [](std::optional<double> si, double column) {
    return si ? std::optional(*si / column) : std::nullopt;
  };
  if (column_unit == "mm") return ratio(length_unit(written), kMetrePerMillimetre);
  if (column_unit == "um") return ratio(length_unit(written), kMetrePerMicrometre);
  if (column_unit == "deg") return ratio(angle_unit(written), kRadianPerDegree);
  if (column_unit == "urad") return ratio(angle_unit(written), kRadianPerMicroradian);
  if (column_unit == "degC" && is_degree_celsius(written)) return 1.0;
  if (column_unit == "mm_min" && written == "mm/min") return 1.0;
  if (column_unit == "s" && written == "s") return 1.0;
  if (column_unit == "s" && written == "ms") return 1e-3;
  if (column_unit == "s" && written == "min") return kSecondsPerMinute;
  return std::nullopt;
}

}  // namespace volcal
