#include "volcal/identify/standards/iso230_6.h"

#include <algorithm>

namespace volcal {
namespace {

std::optional<double> largest(std::span<const DiagonalFigures> diagonals,
                              std::optional<double> PositioningFigures::*figure) {
  std::optional<double> result;
  for (const auto& diagonal : diagonals) {
    const std::optional<double>& value = diagonal.positioning.*figure;
    if (!value) return std::nullopt;
    result = result ? std::max(*result, *value) : *value;
  }
  return result;
}

}  // namespace

DiagonalSummary diagonal_summary(std::span<const DiagonalFigures> diagonals) {
  DiagonalSummary summary;
  summary.diagonals = static_cast<int>(diagonals.size());
  summary.systematic = largest(diagonals, &PositioningFigures::systematic);
  summary.reversal = largest(diagonals, &PositioningFigures::reversal);
  return summary;
}

}  // namespace volcal
