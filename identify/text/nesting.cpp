#include "volcal/identify/text/nesting.h"

#include <algorithm>
#include <string_view>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr int kDeepest = 100;

/// End of a text in quotes that begins at `at`: behind its closing quote, or of what there is.
std::size_t end_of_quoted(std::string_view text, std::size_t at, NestedText kind) {
  const char quote = text[at];
  const std::string_view three = text.substr(at, 3);
  const bool is_block =
      kind == NestedText::Toml && three.size() == 3 && three[1] == quote && three[2] == quote;
  const std::string_view close = is_block ? three : three.substr(0, 1);
  for (std::size_t i = at + close.size(); i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (text.substr(i, close.size()) == close) {
      return i + close.size();
    } else if (text[i] == '\n' && !is_block) {
      return i;  // the parser says that the quote does not close
    }
  }
  return text.size();
}

class Nesting {
 public:
  /// Takes a character outside quotes; false where it is too deep.
  bool take(char c) {
    switch (c) {
      case '[':
      case '{':
        ++depth_;
        dots_ = 0;
        break;
      case ']':
      case '}':
        depth_ = std::max(depth_ - 1, 0);
        dots_ = 0;
        break;
      case '.':
        ++dots_;
        break;
      case ',':
      case '=':
      case '\n':
        dots_ = 0;
        break;
      default:
        break;
    }
    return depth_ <= kDeepest && dots_ <= kDeepest;
  }

 private:
  int depth_ = 0;
  int dots_ = 0;
};

}  // namespace

void require_shallow(const std::string& text, NestedText kind, const std::string& file) {
  const bool is_toml = kind == NestedText::Toml;
  const std::string_view view(text);
  Nesting nesting;
  for (std::size_t i = 0; i < view.size();) {
    const char c = view[i];
    if (c == '"' || (is_toml && c == '\'')) {
      i = end_of_quoted(view, i, kind);
    } else if (is_toml && c == '#') {
      i = std::min(view.find('\n', i), view.size());
    } else if (nesting.take(c)) {
      ++i;
    } else {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw InputError({file, static_cast<int>(line)},
                       "values are nested deeper than " + std::to_string(kDeepest) + " levels",
                       "check that this is the right file: no file of volcal is nested so deep");
    }
  }
}

}  // namespace volcal
