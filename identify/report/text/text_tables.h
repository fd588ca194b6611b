#pragma once
/// Aligned text tables for the terminal: headers carry the units, numbers stand right, names left.

#include <string>
#include <vector>

namespace volcal {

enum class Align { Left, Right };

struct TextColumn {
  std::string header;  ///< with the unit: "rms [um]"
  Align align = Align::Right;
};

/// Rows of text under aligned headers. Widths count characters (UTF-8 code points), lines carry no trailing
/// blanks and end in a newline. A table without rows is an empty string.
class TextTable {
 public:
  explicit TextTable(std::vector<TextColumn> columns, std::string title = {});

  /// Throws std::invalid_argument when the number of cells is not the number of columns.
  void add_row(std::vector<std::string> cells);
  bool empty() const { return rows_.empty(); }
  std::string text(int indent = 2) const;

 private:
  std::string line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths,
                   int indent) const;

  std::vector<TextColumn> columns_;
  std::string title_;
  std::vector<std::vector<std::string>> rows_;
};

/// Number with `decimals` digits after the point; "-" for NaN (not available), never "-0.00".
std::string fixed_number(double value, int decimals);
/// Number with `digits` significant digits, without exponent between 1e-4 and 1e6; "-" for NaN.
std::string short_number(double value, int digits = 4);
/// "tool short"; without a name "at the spindle reference" (Machine::functional_tools).
std::string functional_point_words(const std::string& tool);
/// Whole number with a comma between groups of three: 6,048.
std::string count_number(long long value);

}  // namespace volcal
