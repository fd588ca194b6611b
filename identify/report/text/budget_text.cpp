#include "volcal/identify/report/text/budget_text.h"

#include <fmt/format.h>

#include <vector>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/budget_shares.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

std::string share_table(const MonteCarloResult& result, const BudgetShares& shares) {
  std::vector<TextColumn> columns = {{"quantity", Align::Left}, {"unit", Align::Left}, {"u linear, RMS"}};
  for (std::size_t k = 0; k < shares.sources.size(); ++k) columns.push_back({fmt::format("[{}]", k + 1)});
  TextTable table(columns, "Where it comes from: share of the variance, %, mean of each line");
  for (std::size_t g = 0; g < shares.groups.size(); ++g) {
    const QuantityGroup& group = shares.groups[g];
    const double unit = result.quantities[group.values.front()].quantity.si_per_unit;
    std::vector<std::string> cells = {group.name, group.unit, short_number(shares.u[g] / unit)};
    for (const std::size_t source : shares.sources)
      cells.push_back(fixed_number(100.0 * shares.of(g, source), 1));
    table.add_row(std::move(cells));
  }
  return table.text();
}

std::string halving_table(const MonteCarloResult& result, const std::vector<std::size_t>& sources) {
  const double now = volume_u(result, result.budget.u.rowwise().norm());
  if (!(now > 0.0)) return {};
  TextTable table(
      {{"source", Align::Left}, {"u would be [um]"}, {"less by"}},
      fmt::format("If one source were half as large: u of ex, ey, ez in the volume, now {} um RMS",
                  short_number(now * kPerMicro)));
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const double half = volume_u(result, result.budget.u_with_half_of(sources[k]));
    table.add_row({fmt::format("[{}] {}", k + 1, result.budget.sources[sources[k]]),
                   short_number(half * kPerMicro), fixed_number(100.0 * (1.0 - half / now), 1) + " %"});
  }
  return "\n" + table.text();
}

}  // namespace

std::string budget_text(const MonteCarloResult& result) {
  const BudgetShares shares(result);
  if (shares.groups.empty() || shares.sources.empty()) return {};
  std::string text = share_table(result, shares);
  for (std::size_t k = 0; k < shares.sources.size(); ++k)
    text += fmt::format("  [{}] {}\n", k + 1, result.budget.sources[shares.sources[k]]);
  const std::size_t others = result.budget.sources.size() - shares.sources.size();
  if (others > 0)
    text += fmt::format("  {} other sources contribute less than {:g} % to every line\n", others,
                        100.0 * BudgetShares::kWorthAColumn);
  return text + halving_table(result, shares.sources);
}

}  // namespace volcal
