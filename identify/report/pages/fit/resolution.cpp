/// How finely each error function is resolved.

#include <cmath>

#include "volcal/identify/report/numbers.h"

namespace volcal::report {

Json resolution_page(const PageInput& input) {
  const FitResult& result = input.result;
  Json rows = Json::array();
  for (const FunctionSummary& function : result.functions) {
    const FunctionSpec& spec = result.identified.function(function.symbol);
    const Axis& axis = result.machine.axis(function.symbol.axis);
    const double factor = position_factor(axis.name);
    const bool pieces = function.intervals > 0;
    rows.push_back(
        {{"symbol", function.symbol.name()},
         {"axis", axis_letter(axis.name)},
         {"basis", spec.basis},
         {"degree", spec.degree},
         {"intervals", function.intervals},
         {"interval_length", rounded(pieces ? axis.travel() * factor / function.intervals : NAN, 4)},
         {"position_unit", position_unit(axis.name).suffix},
         {"smoothed", function.smoothed},
         {"effective_parameters", rounded(function.effective_parameters, 3)},
         {"measured",
          {rounded(function.measured_min * factor, 6), rounded(function.measured_max * factor, 6)}},
         {"travel", {rounded(axis.travel_min * factor, 6), rounded(axis.travel_max * factor, 6)}}});
  }
  return {{"rows", std::move(rows)}};
}

}  // namespace volcal::report
