#include "volcal/identify/program/tcp/tcp_words.h"

#include <cctype>
#include <string>

namespace volcal {
namespace {

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

TcpName tcp_name(std::string_view line, const NcPlace& place) {
  const std::string text = bare(line);
  if (is_traori(text)) return TcpName::On;
  if (is_trafoof(text)) return TcpName::Off;
  if (text.starts_with("TRA"))
    place.refuse("the transformation " + text.substr(0, 40) + " is not followed",
                 "TRAORI and TRAFOOF are, each in a block of its own");
  return TcpName::None;
}

}  // namespace volcal
