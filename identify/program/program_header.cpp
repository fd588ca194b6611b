#include "volcal/identify/program/program_header.h"

#include <fmt/format.h>

#include <algorithm>

namespace volcal {
namespace {

constexpr std::string_view kMark = "volcal compensate:";

std::string in_comment(std::string_view text) {
  std::string comment(text);
  for (char& c : comment) {
    if (c == '(' || c == ')' || static_cast<unsigned char>(c) < 0x20) c = '_';
  }
  return comment;
}

std::string conditions_words(std::span<const StatedCondition> conditions) {
  std::string words = "conditions:";
  for (const StatedCondition& condition : conditions) {
    words += fmt::format("{} {}={:.12g} {}", words.back() == ':' ? "" : ",", condition.name(),
                         condition.value, condition.origin);
  }
  return words;
}

/// As many comments as it takes, broken at blanks.
void add_comments(std::string_view text, CommentStyle style, std::vector<std::string>& comments) {
  const std::string_view begin = style == CommentStyle::Brackets ? "(" : "; ";
  const std::string_view end = style == CommentStyle::Brackets ? ")" : "";
  const std::size_t room = kLongestLine - begin.size() - end.size();
  while (text.size() > room) {
    std::size_t cut = text.rfind(' ', room);
    if (cut == std::string_view::npos || cut == 0) cut = room;
    comments.push_back(fmt::format("{}{}{}", begin, text.substr(0, cut), end));
    text.remove_prefix(text[cut] == ' ' ? cut + 1 : cut);
  }
  comments.push_back(fmt::format("{}{}{}", begin, text, end));
}

}  // namespace

std::vector<std::string> program_header(std::string_view made_of, std::span<const StatedCondition> conditions,
                                        CommentStyle style) {
  std::vector<std::string> comments;
  add_comments(in_comment(fmt::format("{} {}", kMark, made_of)), style, comments);
  if (!conditions.empty()) add_comments(in_comment(conditions_words(conditions)), style, comments);
  return comments;
}

bool is_compensated(std::string_view line) {
  const std::size_t mark = line.find(kMark);
  if (mark == std::string_view::npos) return false;
  const std::string_view before = line.substr(0, mark);
  return before.ends_with('(') || before.ends_with("; ");
}

}  // namespace volcal
