/// What contributes what to the uncertainties, and what halving a source would bring.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/values/budget_shares.h"

namespace volcal::report {
namespace {

Json halved_rows(const MonteCarloResult& study, const std::vector<std::size_t>& sources, double now) {
  Json rows = Json::array();
  for (const std::size_t source : sources) {
    const double half = volume_u(study, study.budget.u_with_half_of(source));
    rows.push_back({{"source", study.budget.sources[source]},
                    {"u_um", rounded(half * kPerMicro, 6)},
                    {"less", rounded(1.0 - half / now, 3)}});
  }
  return rows;
}

}  // namespace

Json budget_page(const MonteCarloPageInput& input) {
  const MonteCarloResult& study = input.study;
  const BudgetShares shares(study);
  Json groups = Json::array();
  for (std::size_t g = 0; g < shares.groups.size(); ++g) {
    const QuantityGroup& group = shares.groups[g];
    Json of_sources = Json::array();
    for (const std::size_t source : shares.sources) of_sources.push_back(rounded(shares.of(g, source), 4));
    const double unit = study.quantities[group.values.front()].quantity.si_per_unit;
    groups.push_back({{"name", group.name},
                      {"unit", shown_unit(group.unit)},
                      {"u", rounded(shares.u[g] / unit, 3)},
                      {"share", std::move(of_sources)}});
  }
  Json sources = Json::array();
  for (const std::size_t source : shares.sources) sources.push_back(study.budget.sources[source]);
  const double now = volume_u(study, study.budget.u.rowwise().norm());
  return {{"sources", std::move(sources)},
          {"others", study.budget.sources.size() - shares.sources.size()},
          {"groups", std::move(groups)},
          {"volume_u_um", rounded(now * kPerMicro, 4)},
          {"halved", now > 0.0 ? halved_rows(study, shares.sources, now) : Json::array()}};
}

}  // namespace volcal::report
