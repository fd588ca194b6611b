#pragma once
/// How the amplitude of a reversal is called wherever parameters have names: "reversal EXX".

#include <optional>
#include <string>
#include <string_view>

#include "volcal/model/description/symbols.h"

namespace volcal {

inline constexpr std::string_view kReversalLabel = "reversal ";

inline std::string reversal_label(ErrorSymbol symbol) { return std::string(kReversalLabel) + symbol.name(); }

/// nullopt where the label is another effect's.
inline std::optional<ErrorSymbol> reversal_symbol(std::string_view label) {
  if (!label.starts_with(kReversalLabel)) return std::nullopt;
  return ErrorSymbol::parse(label.substr(kReversalLabel.size()));
}

}  // namespace volcal
