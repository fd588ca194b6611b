/// Added-variable plot of the leading effect: the slope is its amplitude.

#include <algorithm>

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/result/result.h"

namespace volcal::report {

Json added_variable_page(const DiagnosisInput& input) {
  const AddedVariableFigure& leading = input.diagnosis.figures.leading;
  const double unit = leading.si_per_unit;
  const auto holds_leading = [&](const std::vector<EffectFinding>* set) {
    return std::ranges::find(*set, leading.label, &EffectFinding::label) != set->end();
  };
  const bool alternative = std::ranges::any_of(sets_of_alternatives(input.diagnosis), holds_leading);
  return {{"label", leading.label},
          {"unit", shown_unit(leading.unit)},
          {"accepted", leading.accepted},
          {"alternative", alternative},
          {"amplitude", rounded(leading.slope / unit, 4)},
          {"U95", rounded(kCoverageFactor * leading.u / unit, 3)},
          {"driver", rounded_array(leading.driver, unit, 4)},
          {"residual", rounded_array(leading.residual, 1.0, 3)},
          {"mean", binned_json(leading.mean, unit, 1.0)}};
}

}  // namespace volcal::report
