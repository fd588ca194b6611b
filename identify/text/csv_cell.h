#pragma once
/// A text as one cell of a CSV file.

#include <string>

namespace volcal {

/// Quoted where it holds a comma, a quote or a line end.
std::string csv_cell(const std::string& text);

}  // namespace volcal
