#pragma once
/// One line (block) of an NC program after ISO 6983-1 and RS-274 (NISTIR 6556, clause 3.3) as words with
/// their places in the text: an optional `/`, an optional N number, words of a letter and a number, comments
/// in
/// `( )` and after `;`. Letters count in either case; blanks may stand between words and between a letter and
/// its number. Parameters `#`, expressions `[ ]`, O words and numbers with exponents are refused, not read.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace volcal {

/// Where a block stands; throws its errors.
struct NcPlace {
  std::string_view file;
  std::int64_t line = 0;  ///< 1-based

  /// Throws InputError.
  [[noreturn]] void refuse(const std::string& problem, const std::string& remedy) const;
};

struct NcWord {
  char letter = 0;  ///< A to Z
  double value = 0.0;
  std::uint32_t begin = 0;  ///< of its letter in the text
  std::uint32_t end = 0;    ///< behind its number

  /// G43.1 is 431, M3 is 30; -1 for a number of other decimals.
  int code() const;
};

struct NcBlock {
  std::string_view text;      ///< without line end
  std::string_view line_end;  ///< "\n", "\r\n" or nothing at the end of a file
  bool deletable = false;     ///< begins with `/`
  bool percent = false;       ///< `%`: begin or end of the program
  std::vector<NcWord> words;  ///< in the order of the text

  bool blank() const { return words.empty(); }
};

/// Longest line that is read, characters.
inline constexpr std::size_t kLongestNcLine = 2000;

/// Splits `line` (with its line end) into `block`, which refers to it. Throws InputError.
void parse_block(std::string_view line, const NcPlace& place, NcBlock& block);

}  // namespace volcal
