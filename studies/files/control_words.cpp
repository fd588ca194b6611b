#include "volcal/studies/files/control_words.h"

#include <stdexcept>

namespace volcal {

std::vector<Words> lines_of_words(const std::string& text, const std::string& separators) {
  std::vector<Words> lines(1);
  std::string word;
  const auto end_word = [&] {
    if (!word.empty()) lines.back().push_back(word);
    word.clear();
  };
  for (const char c : text + "\n") {
    if (c == '\n') {
      end_word();
      if (!lines.back().empty()) lines.emplace_back();
    } else if (c == '\r' || separators.find(c) != std::string::npos) {
      end_word();
    } else {
      word += c;
    }
  }
  lines.pop_back();
  return lines;
}

AxisName axis_in(const std::string& word) {
  const auto axis = axis_from_letter(word.at(0));
  if (!axis) throw std::invalid_argument("\"" + word + "\" names no axis");
  return *axis;
}

}  // namespace volcal
