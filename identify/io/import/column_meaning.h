#pragma once
/// What the header of a column of unknown origin may mean: its words and its unit.

#include <optional>
#include <string>
#include <vector>

namespace volcal {

struct HeaderWords {
  std::vector<std::string> words;  ///< in lower case, without the unit
  std::string unit;                ///< as it stands in brackets or behind the last _; empty = none

  bool has(std::initializer_list<std::string_view> any) const;
  /// The only word that is a letter of an axis or coordinate; 0 = none, or several.
  char letter() const;
};

HeaderWords header_words(const std::string& header);

/// Factor from a unit as written to the unit of a standard column, "mm", "um", "urad", "deg", "s", "degC",
/// "mm_min"; nothing where it is no unit of that kind.
std::optional<double> factor_to_unit(const std::string& written, std::string_view column_unit);

}  // namespace volcal
