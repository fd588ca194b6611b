#include "volcal/identify/report/text/signed_means_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using By = Grouping::Kind;
using Models = std::span<const Comparison* const>;

/// Lengths in um or angles in urad.
struct MeanKind {
  ResidualSize ComparisonCell::*size;
  const char* unit;
};
constexpr MeanKind kMeanKinds[] = {{&ComparisonCell::lengths, "um"}, {&ComparisonCell::angles, "urad"}};

bool tells_signs(By by) { return by == By::Setup || by == By::Direction; }

std::vector<const ComparisonCell*> told_cells(const Breakdown& breakdown, const MeanKind& kind,
                                              std::size_t most) {
  std::vector<const ComparisonCell*> cells;
  for (const ComparisonCell& cell : breakdown.cells) {
    if ((cell.*kind.size).count > 0) cells.push_back(&cell);
  }
  if (cells.size() <= most) return cells;
  const auto share = [&](const ComparisonCell* cell) {
    const ResidualSize& size = cell->*kind.size;
    return size.rms > 0.0 ? std::abs(size.mean) / size.rms : 0.0;
  };
  std::ranges::stable_sort(cells, std::greater<>(), share);
  cells.resize(most);
  return cells;
}

void add_means_of(const Breakdown& breakdown, const MeanKind& kind, Models models, std::size_t most,
                  TextTable& table) {
  std::string by = breakdown.by.name();
  for (const ComparisonCell* cell : told_cells(breakdown, kind, most)) {
    std::vector<std::string> row = {by, cell->label,
                                    count_number(static_cast<long long>((cell->*kind.size).count))};
    by.clear();
    for (const Comparison* model : models) {
      const ComparisonCell* own = model->find_cell(breakdown.by, cell->label);
      const bool any = own != nullptr && (own->*kind.size).count > 0;
      row.push_back(any ? fixed_number((own->*kind.size).mean / kMicro, 2) : "-");
      row.push_back(any ? fixed_number((own->*kind.size).rms / kMicro, 2) : "-");
    }
    row.emplace_back(kind.unit);
    table.add_row(std::move(row));
  }
}

}  // namespace

std::string signed_means_text(Models models, std::size_t most) {
  std::vector<TextColumn> columns = {{"by", Align::Left}, {"where", Align::Left}, {"n"}};
  const bool two = models.size() > 1;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::string suffix = two ? std::string(" ") + "AB"[m] : "";
    columns.push_back({"mean" + suffix});
    columns.push_back({"rms" + suffix});
  }
  columns.push_back({"unit", Align::Left});
  TextTable table(columns, "Signed means of the residuals, reading minus prediction");
  const auto& breakdowns = models.back()->breakdowns;
  const Breakdown* setups = models.back()->find({By::Setup});
  const bool one_setup = setups != nullptr && setups->cells.size() < 2;
  for (const bool directions : {true, false}) {
    for (const Breakdown& breakdown : breakdowns) {
      if (!tells_signs(breakdown.by.kind) || (breakdown.by.kind != By::Setup) != directions) continue;
      if (!directions && one_setup) continue;
      for (const MeanKind& kind : kMeanKinds) add_means_of(breakdown, kind, models, most, table);
    }
  }
  return table.text();
}

}  // namespace volcal
