#include "volcal/identify/report/values/error_range.h"

namespace volcal::report {

ErrorRange error_range(const FitResult& result, const std::vector<ErrorTableRow>& table,
                       const Observability& error) {
  if (const ParameterBlock* block = result.layout.find_block(error.symbol)) {
    const double value = result.parameters[block->offset];
    return {value, value, result.coverage_factor * error.u_rms};
  }
  ErrorRange range;
  for (const ErrorTableRow& row : table) {
    if (row.symbol != error.symbol || row.extrapolated) continue;
    range.low = std::fmin(range.low, row.value);
    range.high = std::fmax(range.high, row.value);
    range.expanded = std::fmax(range.expanded, result.coverage_factor * row.u);
  }
  // a table is held by the stated roughness where the readings say nothing
  const double expanded = result.coverage_factor * error.u_rms;
  if (!error.visible && range.expanded < expanded) range.expanded = expanded;
  return range;
}

bool is_amplitude(const FitResult& result, const Observability& error) {
  const ParameterBlock* block = result.layout.find_block(error.symbol);
  return block != nullptr && block->kind == ParameterKind::Effect;
}

}  // namespace volcal::report
