/// U and observability of every error with the plan and with what it is compared with.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/result/error_unit.h"
#include "volcal/identify/result/result.h"

namespace volcal::report {
Json plan_errors_page(const PlanPageInput& input) {
  const CampaignPlan& plan = input.plan;
  std::vector<const ExpectedCampaign*> campaigns = {&plan.plan};
  if (plan.settings.existing == nullptr) campaigns.push_back(&plan.textbook);
  if (plan.given) campaigns.push_back(&*plan.given);
  Json names = Json::array(), rows = Json::array();
  for (const ExpectedCampaign* each : campaigns) names.push_back(each->name);
  for (const Observability& error : plan.plan.result.rank.errors) {
    const ErrorUnit unit = unit_of(plan.plan.result, error.symbol);
    Json expanded = Json::array();
    for (const ExpectedCampaign* each : campaigns) {
      const Observability* own = find_observability(each->result, error.symbol);
      const bool visible = own != nullptr && own->visible;
      expanded.push_back(visible ? rounded(kCoverageFactor * own->u_rms / unit.si_per_unit, 3)
                                 : Json(nullptr));
    }
    rows.push_back({{"symbol", error.symbol.name()},
                    {"axis", axis_letter_of(error.symbol)},
                    {"unit", shown_unit(unit.name)},
                    {"U", std::move(expanded)},
                    {"visible_fraction", rounded(error.visible_fraction, 4)},
                    {"effective_parameters", rounded(error.effective_parameters, 3)},
                    {"visible", error.visible}});
  }
  return {{"campaigns", std::move(names)}, {"errors", std::move(rows)}};
}

}  // namespace volcal::report
