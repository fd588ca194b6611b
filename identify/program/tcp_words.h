#pragma once
/// What a block of a program with tool centre point motion says, and where that motion begins.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "volcal/identify/program/nc_block.h"

namespace volcal {

inline constexpr std::string_view kTcpLetters = "XYZABC";  ///< of the coordinates that are followed

enum class TcpBegin { ByCode, ByName };  ///< G43.4 H, TRAORI
/// Nothing where a line does not begin tool centre point motion.
std::optional<TcpBegin> tcp_begin(std::string_view line);

struct TcpWords {
  std::vector<int> g, m;  ///< tenths
  std::array<std::optional<double>, 26> value;
  bool on = false, off = false;
  bool by_name = false;  ///< TRAORI, TRAFOOF

  /// Reads the line into `block`. Throws InputError for a word that stands twice and for transformations
  /// that are not followed.
  TcpWords(std::string_view line, const NcPlace& place, NcBlock& block);

  bool has(char letter) const { return value[static_cast<std::size_t>(letter - 'A')].has_value(); }
  double of(char letter) const { return *value[static_cast<std::size_t>(letter - 'A')]; }
  bool has_g(int code) const;
  bool moves() const;

 private:
  void add(const NcWord& word, const NcPlace& place);
};

}  // namespace volcal
