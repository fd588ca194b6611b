#include "volcal/identify/program/nc_block.h"

#include <charconv>
#include <cmath>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
char upper(char c) { return c >= 'a' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Cuts the line end off: LF, CR LF, and CR CR LF of files that went through two systems.
void split_line_end(std::string_view line, NcBlock& block) {
  std::size_t size = line.size();
  if (size > 0 && line[size - 1] == '\n') --size;
  while (size > 0 && line[size - 1] == '\r') --size;
  block.text = line.substr(0, size);
  block.line_end = line.substr(size);
}

[[noreturn]] void refuse_character(char c, const NcPlace& place) {
  if (c == '#' || c == '=') place.refuse("parameters (#) are not evaluated", "write the numbers themselves");
  if (c == '[' || c == ']')
    place.refuse("expressions in [ ] are not evaluated", "write the numbers themselves");
  if (c == ')') place.refuse("a comment ends that has not begun", "remove the ) or add a (");
  if (c == '%') place.refuse("% stands beside other words", "write it on a line of its own");
  if (c == '@' || c == '^')
    place.refuse("polar coordinates (@ and ^) are not read", "write X, Y and Z coordinates");
  const char* const usage = "write words of a letter and a number, and comments in ( ) or after ;";
  const auto code = static_cast<unsigned char>(c);
  if (code > 0x20 && code < 0x7F) place.refuse(std::string("\"") + c + "\" begins no word", usage);
  if (c == '\r')
    place.refuse("a carriage return (CR) stands within the line",
                 "end the lines of the program with LF or CRLF");
  constexpr char kDigits[] = "0123456789ABCDEF";
  const std::string byte = {'0', 'x', kDigits[code >> 4], kDigits[code & 0xF]};
  if (code >= 0x80)
    place.refuse("a character outside ASCII (byte " + byte + ") stands outside a comment",
                 "write it in ASCII; comments may hold any character");
  place.refuse("a control character (byte " + byte + ")", "remove it; " + std::string(usage));
}

class BlockReader {
 public:
  BlockReader(const NcPlace& place, NcBlock& block) : place_(place), block_(block), text_(block.text) {}

  void read() {
    skip_blanks();
    if (at_ < text_.size() && text_[at_] == '%') {
      read_percent();
      return;
    }
    if (at_ < text_.size() && text_[at_] == '/') {
      block_.deletable = true;
      ++at_;
    }
    for (skip_blanks(); at_ < text_.size(); skip_blanks()) {
      const char c = text_[at_];
      if (c == ';') return;
      if (c == '(') {
        skip_comment();
      } else if (is_letter(c)) {
        read_word();
      } else {
        refuse_character(c, place_);
      }
    }
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }

  void read_percent() {
    block_.percent = true;
    ++at_;
    skip_blanks();
    if (at_ < text_.size() && text_[at_] != ';' && text_[at_] != '(') refuse_character('%', place_);
  }

  void skip_comment() {
    const std::size_t end = text_.find_first_of("()", at_ + 1);
    if (end == std::string_view::npos) place_.refuse("the comment is not closed", "end it with )");
    if (text_[end] == '(') place_.refuse("a comment stands in a comment", "comments cannot be nested");
    at_ = end + 1;
  }

  void read_word() {
    NcWord word;
    word.begin = static_cast<std::uint32_t>(at_);
    word.letter = upper(text_[at_++]);
    if (word.letter == 'O')
      place_.refuse("O words (program numbers, subprograms) are not followed",
                    "write the program without subprograms, and take its number out");
    skip_blanks();
    word.value = read_number(word.letter);
    word.end = static_cast<std::uint32_t>(at_);
    if (word.letter == 'N' && !block_.words.empty())
      place_.refuse("N stands behind other words", "write the number of a block first");
    block_.words.push_back(word);
  }

  double read_number(char letter) {
    const bool sign = at_ < text_.size() && (text_[at_] == '+' || text_[at_] == '-');
    const bool negative = sign && text_[at_] == '-';
    if (sign) ++at_;
    const bool digits =
        at_ < text_.size() &&
        (is_digit(text_[at_]) || (text_[at_] == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1])));
    if (!digits) {
      if (at_ < text_.size() && (text_[at_] == '#' || text_[at_] == '['))
        refuse_character(text_[at_], place_);
      place_.refuse(std::string("no number follows ") + letter, "write a decimal number behind every letter");
    }
    double value = 0.0;
    const char* const begin = text_.data() + at_;
    const auto read = std::from_chars(begin, text_.data() + text_.size(), value, std::chars_format::fixed);
    constexpr double kLargest = 1e9;
    if (read.ec != std::errc() || !(value < kLargest))
      place_.refuse(std::string("the number behind ") + letter + " is too large", "write a number below 1e9");
    at_ += static_cast<std::size_t>(read.ptr - begin);
    return negative ? -value : value;
  }

  const NcPlace& place_;
  NcBlock& block_;
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

void NcPlace::refuse(const std::string& problem, const std::string& remedy) const {
  throw InputError({std::string(file), static_cast<int>(line)}, problem, remedy);
}

int NcWord::code() const {
  const double tenths = value * 10.0;
  const double whole = std::round(tenths);
  return whole < 0.0 || whole > 99999.0 || std::abs(tenths - whole) > 1e-6 ? -1 : static_cast<int>(whole);
}

void parse_block(std::string_view line, const NcPlace& place, NcBlock& block) {
  block.deletable = false;
  block.percent = false;
  block.words.clear();
  split_line_end(line, block);
  if (block.text.size() > kLongestNcLine)
    place.refuse("the line is longer than 2000 characters",
                 "is it an NC program? end its lines with LF or CRLF");
  BlockReader(place, block).read();
}

}  // namespace volcal
