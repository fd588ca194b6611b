#include "volcal/identify/program/tcp_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace volcal {
namespace {

constexpr int kTcpOn = 434, kTcpOff = 490;

/// Without blanks, comments and a block number, in upper case.
std::string bare(std::string_view line) {
  std::string text;
  bool comment = false;
  for (const char c : line) {
    if (c == ';') break;
    if (c == '(' && text.find("TRAORI") == std::string::npos) comment = true;
    if (!comment && !std::isspace(static_cast<unsigned char>(c)))
      text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (c == ')') comment = false;
  }
  if (text.size() > 1 && text[0] == 'N' && std::isdigit(static_cast<unsigned char>(text[1])) != 0) {
    const std::size_t end = text.find_first_not_of("0123456789", 1);
    text = end == std::string::npos ? std::string() : text.substr(end);
  }
  return text;
}

bool is_traori(const std::string& text) { return text == "TRAORI" || text == "TRAORI(1)"; }
bool is_trafoof(const std::string& text) { return text == "TRAFOOF"; }

}  // namespace

std::optional<TcpBegin> tcp_begin(std::string_view line) {
  const std::string text = bare(line);
  if (text.starts_with("TRAORI")) return TcpBegin::ByName;
  const std::size_t at = text.find("G43.4");
  if (at == std::string::npos) return std::nullopt;
  const bool longer = at + 5 < text.size() && std::isdigit(static_cast<unsigned char>(text[at + 5])) != 0;
  return longer ? std::nullopt : std::optional(TcpBegin::ByCode);
}

bool TcpWords::has_g(int code) const { return std::ranges::find(g, code) != g.end(); }

bool TcpWords::moves() const {
  return std::ranges::any_of(kTcpLetters, [this](char letter) { return has(letter); });
}

TcpWords::TcpWords(std::string_view line, const NcPlace& place, NcBlock& block) {
  const std::string text = bare(line);
  by_name = is_traori(text) || is_trafoof(text);
  on = is_traori(text);
  off = is_trafoof(text);
  if (by_name) {
    block = NcBlock{};
    block.text = line;
    return;
  }
  if (text.starts_with("TRA"))
    place.refuse("the transformation " + text.substr(0, 40) + " is not followed",
                 "TRAORI and TRAFOOF are, each in a block of its own");
  parse_block(line, place, block);
  for (const NcWord& word : block.words) add(word, place);
  on = has_g(kTcpOn);
  off = has_g(kTcpOff);
}

void TcpWords::add(const NcWord& word, const NcPlace& place) {
  if (word.letter == 'G') return g.push_back(word.code());
  if (word.letter == 'M') return m.push_back(word.code());
  auto& of_letter = value[static_cast<std::size_t>(word.letter - 'A')];
  if (of_letter) place.refuse(fmt::format("{} stands twice", word.letter), "write it once, or two blocks");
  of_letter = word.value;
}

}  // namespace volcal
