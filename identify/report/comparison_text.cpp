#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "volcal/identify/report/comparison_report.h"
#include "volcal/identify/report/standard_figures_text.h"
#include "volcal/identify/report/text_tables.h"
#include "volcal/identify/stats/channels.h"

namespace volcal {
namespace {

constexpr double kWorthTelling = 1.2;  // chi2/dof of a place over the campaign's
constexpr std::size_t kPlacesTold = 3;
constexpr std::size_t kCellsShown = 3;
constexpr std::size_t kSetupsShown = 40;

const char* const kSuffix[] = {" A", " B"};

std::string observations(std::size_t count) {
  return count_number(static_cast<long long>(count)) + (count == 1 ? " observation" : " observations");
}

const ComparisonCell* worst_cell(const Breakdown& breakdown, bool ComparisonCell::*condition) {
  const ComparisonCell* worst = nullptr;
  for (const ComparisonCell& cell : breakdown.cells) {
    if (cell.*condition && (!worst || cell.reduced_chi2() > worst->reduced_chi2())) worst = &cell;
  }
  return worst;
}

/// The worst cell of each breakdown, worst first; a setup or what else is worse than its breakdown's others.
std::vector<std::pair<std::string, const ComparisonCell*>> worst_places(const Comparison& comparison,
                                                                        bool ComparisonCell::*condition,
                                                                        double least) {
  std::vector<std::pair<std::string, const ComparisonCell*>> places;
  for (const Breakdown& breakdown : comparison.breakdowns) {
    if (breakdown.by == "line" || breakdown.by == "instrument") continue;
    const ComparisonCell* cell = worst_cell(breakdown, condition);
    if (!cell || cell->reduced_chi2() < least) continue;
    const bool named = breakdown.by == "setup" || breakdown.by == "tool" || breakdown.by == "time";
    places.emplace_back((named ? breakdown.by + " " : "") + cell->label, cell);
  }
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return a.second->reduced_chi2() > b.second->reduced_chi2();
  });
  if (places.size() > kPlacesTold) places.resize(kPlacesTold);
  return places;
}

std::string list_of(const std::vector<std::pair<std::string, const ComparisonCell*>>& places) {
  std::string text;
  for (std::size_t i = 0; i < places.size(); ++i) {
    text += fmt::format("{}{} (chi2/dof {})",
                        i == 0                   ? ""
                        : i + 1 == places.size() ? " and "
                                                 : ", ",
                        places[i].first, short_number(places[i].second->reduced_chi2(), 3));
  }
  return text;
}

std::string column(const char* name, std::size_t model, std::size_t models, const char* unit = "") {
  return std::string(name) + (models > 1 ? kSuffix[model] : "") + unit;
}

std::string size_cell(const ResidualSize& size, double ResidualSize::*figure) {
  return size.count == 0 ? "-" : fixed_number(size.*figure * 1e6, 2);
}

std::string mark(const ComparisonCell& cell) {
  return cell.stands_out ? "**" : (cell.significant ? "*" : "");
}

/// Columns of residual sizes and chi2/dof, one group per model.
class CellColumns {
 public:
  explicit CellColumns(std::span<const ComparedModel> models) : models_(models) {
    for (const ComparedModel& model : models) {
      lengths_ = lengths_ || model.comparison.total.lengths.count > 0;
      angles_ = angles_ || model.comparison.total.angles.count > 0;
    }
  }

  void add_headers(std::vector<TextColumn>& columns) const {
    for (std::size_t m = 0; m < models_.size(); ++m) {
      if (lengths_) columns.push_back({column("rms", m, models_.size(), " [um]")});
      if (lengths_) columns.push_back({column("max", m, models_.size(), " [um]")});
      if (angles_) columns.push_back({column("rms", m, models_.size(), " [urad]")});
      columns.push_back({column("chi2/dof", m, models_.size())});
      columns.push_back({"", Align::Left});
    }
  }

  void add_cells(const ComparisonCell& cell, std::vector<std::string>& cells) const {
    if (lengths_) cells.push_back(size_cell(cell.lengths, &ResidualSize::rms));
    if (lengths_) cells.push_back(size_cell(cell.lengths, &ResidualSize::max));
    if (angles_) cells.push_back(size_cell(cell.angles, &ResidualSize::rms));
    cells.push_back(cell.dof > 0.0 ? short_number(cell.reduced_chi2(), 3) : "-");
    cells.push_back(mark(cell));
  }

 private:
  std::span<const ComparedModel> models_;
  bool lengths_ = false;
  bool angles_ = false;
};

const ComparisonCell* same_cell(const ComparedModel& model, const std::string& by, const std::string& label) {
  const Breakdown* breakdown = model.comparison.find(by);
  if (!breakdown) return nullptr;
  const auto found = std::find_if(breakdown->cells.begin(), breakdown->cells.end(),
                                  [&](const ComparisonCell& cell) { return cell.label == label; });
  return found == breakdown->cells.end() ? nullptr : &*found;
}

/// Cells in their natural order when there are few, else the worst ones by the last model, worst first.
std::vector<const ComparisonCell*> shown_cells(const Breakdown& breakdown, std::size_t most) {
  std::vector<const ComparisonCell*> cells;
  for (const ComparisonCell& cell : breakdown.cells) cells.push_back(&cell);
  if (cells.size() <= most) return cells;
  std::stable_sort(cells.begin(), cells.end(), [](const ComparisonCell* a, const ComparisonCell* b) {
    return a->reduced_chi2() > b->reduced_chi2();
  });
  cells.resize(most);
  return cells;
}

std::vector<std::string> row_of(const std::string& by, const std::string& label, std::size_t count,
                                std::span<const ComparedModel> models, const CellColumns& columns) {
  std::vector<std::string> row = {label, count_number(static_cast<long long>(count))};
  for (const ComparedModel& model : models) {
    const ComparisonCell* cell = same_cell(model, by, label);
    columns.add_cells(cell ? *cell : ComparisonCell{}, row);
  }
  return row;
}

std::string setups_text(const Campaign& campaign, std::span<const ComparedModel> models,
                        const ComparisonTextOptions& options) {
  const CellColumns cell_columns(models);
  const Breakdown& setups = *models.back().comparison.find("setup");
  std::vector<TextColumn> columns = {{"setup", Align::Left}, {"instrument", Align::Left}, {"n"}};
  cell_columns.add_headers(columns);
  const auto shown = shown_cells(setups, options.all_cells ? setups.cells.size() : kSetupsShown);
  std::string title = "Residuals by setup";
  if (shown.size() < setups.cells.size()) {
    title += fmt::format(", worst {} of {}", shown.size(), setups.cells.size());
  }
  TextTable table(columns, title);
  for (const ComparisonCell* cell : shown) {
    auto row = row_of("setup", cell->label, cell->observations, models, cell_columns);
    const auto setup = std::find_if(campaign.setups.begin(), campaign.setups.end(),
                                    [&](const Setup& one) { return one.name == cell->label; });
    row.insert(row.begin() + 1, setup->instrument);
    table.add_row(std::move(row));
  }
  std::vector<std::string> total = {
      "all", "", count_number(static_cast<long long>(models.back().comparison.total.observations))};
  for (const ComparedModel& model : models) cell_columns.add_cells(model.comparison.total, total);
  table.add_row(std::move(total));
  return table.text();
}

std::string places_text(std::span<const ComparedModel> models, const ComparisonTextOptions& options) {
  const CellColumns cell_columns(models);
  std::vector<TextColumn> columns = {{"by", Align::Left}, {"where", Align::Left}, {"n"}};
  cell_columns.add_headers(columns);
  TextTable table(columns,
                  options.all_cells
                      ? std::string("Residuals by place, direction and time")
                      : fmt::format("Residuals by place, direction and time, worst {} of each", kCellsShown));
  for (const Breakdown& breakdown : models.back().comparison.breakdowns) {
    if (breakdown.by == "setup") continue;
    std::string by = fmt::format("{} ({})", breakdown.by, breakdown.cells.size());
    for (const ComparisonCell* cell :
         shown_cells(breakdown, options.all_cells ? breakdown.cells.size() : kCellsShown)) {
      auto row = row_of(breakdown.by, cell->label, cell->observations, models, cell_columns);
      row.insert(row.begin(), std::exchange(by, ""));
      table.add_row(std::move(row));
    }
  }
  return table.text();
}

std::string worst_text(const Campaign& campaign, const ComparedModel& model, std::size_t count, bool named) {
  TextTable table({{"setup", Align::Left},
                   {"line"},
                   {"channel", Align::Left},
                   {"residual"},
                   {"sigma"},
                   {"unit", Align::Left},
                   {"residual/sigma"},
                   {"", Align::Left}},
                  "Worst readings" + (named ? " of " + model.name : std::string()));
  const bool fits = !model.comparison.total.significant;  // else a large residual is the model's
  for (const std::size_t i : model.comparison.worst) {
    if (count-- == 0) break;
    const ResidualRecord& record = model.records[i];
    const Setup& setup = campaign.setups[record.setup];
    const auto channel = static_cast<std::size_t>(record.channel);
    table.add_row({setup.name, std::to_string(record.source_line), channel_column(setup, channel),
                   fixed_number(record.residual() * 1e6, 2), fixed_number(record.sigma * 1e6, 2),
                   is_angle_channel(setup, channel) ? "urad" : "um",
                   fixed_number(record.residual() / record.sigma, 1),
                   record.removed ? "left out" : (fits && record.flagged ? "outlier?" : "")});
  }
  return table.text();
}

}  // namespace

ComparedModel compared_model(std::string name, const Campaign& campaign, std::vector<ResidualRecord> records,
                             const ComparisonOptions& options) {
  ComparedModel model{std::move(name), std::move(records), {}, {}};
  model.comparison = compare(campaign, model.records, options);
  model.figures = standard_figures(campaign, model.records);
  return model;
}

std::string failure_sentence(const ComparedModel& model) {
  const Comparison& comparison = model.comparison;
  const ComparisonCell& total = comparison.total;
  const std::string overall = fmt::format("chi2/dof {} over {}", short_number(total.reduced_chi2(), 3),
                                          observations(total.observations));
  const auto significant = worst_places(comparison, &ComparisonCell::significant, 0.0);
  if (!total.significant && significant.empty()) {
    return fmt::format(
        "{}: no failure found, {}; none of {} places, directions and times is worse than chance.", model.name,
        overall, comparison.cells);
  }
  const auto outstanding =
      worst_places(comparison, &ComparisonCell::stands_out, kWorthTelling * total.reduced_chi2());
  if (!total.significant) {
    return fmt::format("{}: right on the whole, {}, but not in {}.", model.name, overall,
                       list_of(significant));
  }
  if (outstanding.empty()) {
    return fmt::format(
        "{}: does not explain the readings, {}; no setup, place, direction or time is much worse "
        "than the rest.",
        model.name, overall);
  }
  return fmt::format("{}: does not explain the readings, {}; worst: {}.", model.name, overall,
                     list_of(outstanding));
}

std::string comparison_text(const Campaign& campaign, std::span<const ComparedModel> models,
                            const ComparisonTextOptions& options) {
  const bool two = models.size() > 1;
  std::string text;
  for (std::size_t m = 0; m < models.size(); ++m) {
    text += (two ? std::string(kSuffix[m]).substr(1) + " = " : "") + failure_sentence(models[m]) + '\n';
    if (models[m].comparison.removed > 0) {
      text += fmt::format("{} that the adjustment left out are not counted.\n",
                          observations(models[m].comparison.removed));
    }
  }
  text += '\n' + setups_text(campaign, models, options);
  const std::string places = places_text(models, options);
  if (!places.empty()) text += '\n' + places;
  text +=
      "  * worse than chance, ** also worse than the rest (chi2 tests, 5 % over all cells)\n"
      "  dof: readings less the nuisance parameters estimated anew; readings that the model was fitted to "
      "have\n"
      "  chi2/dof a little below 1\n";
  std::vector<NamedFigures> figures;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::string name = two ? std::string("model") + kSuffix[m] : "model";
    figures.push_back({name, &models[m].figures});
  }
  const std::string standards = standard_figures_text(figures);
  if (!standards.empty()) text += '\n' + standards;
  for (const ComparedModel& model : models) {
    const std::string worst = worst_text(campaign, model, options.worst, two);
    if (!worst.empty()) text += '\n' + worst;
  }
  return text;
}

}  // namespace volcal
