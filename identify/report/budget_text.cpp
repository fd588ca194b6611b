#include "volcal/identify/report/budget_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "volcal/identify/report/quantity_groups.h"
#include "volcal/identify/report/text_tables.h"

namespace volcal {
namespace {

constexpr double kWorthAColumn = 0.01;  // share of a line's variance

/// Mean variance of a line by source.
Eigen::RowVectorXd mean_variance(const UncertaintyBudget& budget, const std::vector<std::size_t>& values) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(budget.u.cols());
  for (const std::size_t i : values) sum += budget.u.row(static_cast<Eigen::Index>(i)).cwiseAbs2();
  return sum / static_cast<double>(values.size());
}

Eigen::MatrixXd shares_of(const UncertaintyBudget& budget, const std::vector<QuantityGroup>& groups) {
  Eigen::MatrixXd shares(static_cast<Eigen::Index>(groups.size()), budget.u.cols());
  for (Eigen::Index g = 0; g < shares.rows(); ++g) {
    const Eigen::RowVectorXd variance = mean_variance(budget, groups[static_cast<std::size_t>(g)].values);
    shares.row(g) = variance.sum() > 0.0 ? Eigen::RowVectorXd(variance / variance.sum()) : variance;
  }
  return shares;
}

/// Sources that matter in some line, the largest first.
std::vector<Eigen::Index> sources_worth_a_column(const Eigen::MatrixXd& shares) {
  std::vector<Eigen::Index> sources(static_cast<std::size_t>(shares.cols()));
  std::iota(sources.begin(), sources.end(), 0);
  std::erase_if(sources, [&](Eigen::Index s) { return shares.col(s).maxCoeff() < kWorthAColumn; });
  std::ranges::stable_sort(
      sources, [&](Eigen::Index a, Eigen::Index b) { return shares.col(a).sum() > shares.col(b).sum(); });
  return sources;
}

bool is_of_a_table(const MonteCarloResult& result, const QuantityGroup& group) {
  return result.quantities[group.values.front()].quantity.kind != QuantityKind::Parameter;
}

std::string share_table(const MonteCarloResult& result, const std::vector<QuantityGroup>& groups,
                        const Eigen::MatrixXd& shares, const std::vector<Eigen::Index>& sources) {
  std::vector<TextColumn> columns = {{"quantity", Align::Left}, {"unit", Align::Left}, {"u linear, RMS"}};
  for (std::size_t k = 0; k < sources.size(); ++k) columns.push_back({fmt::format("[{}]", k + 1)});
  TextTable table(columns, "Where it comes from: share of the variance, %, mean of each line");
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double unit = result.quantities[groups[g].values.front()].quantity.si_per_unit;
    const double u = std::sqrt(mean_variance(result.budget, groups[g].values).sum());
    std::vector<std::string> cells = {groups[g].name, groups[g].unit, short_number(u / unit)};
    for (const Eigen::Index source : sources)
      cells.push_back(fixed_number(100.0 * shares(static_cast<Eigen::Index>(g), source), 1));
    table.add_row(std::move(cells));
  }
  return table.text();
}

/// Root mean square u of ex, ey, ez over the points and tools of the volume.
double volume_u(const MonteCarloResult& result, const Eigen::VectorXd& u) {
  double squares = 0.0, points = 0.0;
  for (std::size_t i = 0; i < result.quantities.size(); ++i) {
    if (result.quantities[i].quantity.kind != QuantityKind::VolumetricError) continue;
    squares += u[static_cast<Eigen::Index>(i)] * u[static_cast<Eigen::Index>(i)];
    points += 1.0;
  }
  return points > 0.0 ? std::sqrt(squares / points) : 0.0;
}

std::string halving_table(const MonteCarloResult& result, const std::vector<Eigen::Index>& sources) {
  const double now = volume_u(result, result.budget.u.rowwise().norm());
  if (!(now > 0.0)) return {};
  TextTable table(
      {{"source", Align::Left}, {"u would be [um]"}, {"less by"}},
      fmt::format("If one source were half as large: u of ex, ey, ez in the volume, now {} um RMS",
                  short_number(now * 1e6)));
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const auto source = static_cast<std::size_t>(sources[k]);
    const double half = volume_u(result, result.budget.u_with_half_of(source));
    table.add_row({fmt::format("[{}] {}", k + 1, result.budget.sources[source]), short_number(half * 1e6),
                   fixed_number(100.0 * (1.0 - half / now), 1) + " %"});
  }
  return "\n" + table.text();
}

}  // namespace

std::string budget_text(const MonteCarloResult& result) {
  std::vector<QuantityGroup> groups = quantity_groups(result);
  std::erase_if(groups, [&](const QuantityGroup& group) { return !is_of_a_table(result, group); });
  if (groups.empty() || result.budget.sources.empty()) return {};
  const Eigen::MatrixXd shares = shares_of(result.budget, groups);
  const std::vector<Eigen::Index> sources = sources_worth_a_column(shares);
  std::string text = share_table(result, groups, shares, sources);
  for (std::size_t k = 0; k < sources.size(); ++k)
    text += fmt::format("  [{}] {}\n", k + 1, result.budget.sources[static_cast<std::size_t>(sources[k])]);
  const std::size_t others = result.budget.sources.size() - sources.size();
  if (others > 0)
    text += fmt::format("  {} other sources contribute less than {:g} % to every line\n", others,
                        100.0 * kWorthAColumn);
  return text + halving_table(result, sources);
}

}  // namespace volcal
