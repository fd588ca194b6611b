#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/report/text/comparison_report.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/signed_means_text.h"
#include "volcal/identify/report/text/standard_figures_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kWorthTelling = 1.2;  // chi2/dof of a place over the campaign's
constexpr std::size_t kPlacesTold = 3;
constexpr std::size_t kCellsShown = 3;
constexpr std::size_t kSetupsShown = 40;

using By = Grouping::Kind;

const char* const kSuffix[] = {" A", " B"};

std::string observations_text(std::size_t count) {
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
    const By kind = breakdown.by.kind;
    if (kind == By::Line || kind == By::Instrument) continue;
    const ComparisonCell* cell = worst_cell(breakdown, condition);
    if (!cell || cell->reduced_chi2() < least) continue;
    const bool named = kind == By::Setup || kind == By::Tool || kind == By::Time;
    places.emplace_back((named ? breakdown.by.name() + " " : "") + cell->label, cell);
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

std::string size_cell(const ResidualSize& size, double ResidualSize::*figure) {
  return size.count == 0 ? "-" : fixed_number(size.*figure * kPerMicro, 2);
}

std::string mark(const ComparisonCell& cell) {
  return cell.stands_out ? "**" : (cell.significant ? "*" : "");
}

std::string chi2_cell(const ComparisonCell& cell) {
  return cell.dof > 0.0 ? short_number(cell.reduced_chi2(), 3) : "-";
}

/// Residual sizes and chi2/dof of one model; of two, side by side with B - A and B / A.
class CellColumns {
 public:
  explicit CellColumns(std::span<const Comparison* const> models) : two_(models.size() > 1) {
    for (const Comparison* model : models) {
      lengths_ = lengths_ || model->total.lengths.count > 0;
      angles_ = angles_ || model->total.angles.count > 0;
    }
  }

  void add_headers(std::vector<TextColumn>& columns) const {
    if (lengths_) add_size_headers(columns, "um");
    if (lengths_ && !two_) columns.push_back({"max [um]"});
    if (angles_) add_size_headers(columns, "urad");
    if (two_) {
      for (const char* header : {"chi2/dof A", "chi2/dof B"}) columns.push_back({header});
      for (const char* header : {"A", "B"}) columns.push_back({header, Align::Left});
    } else {
      columns.push_back({"chi2/dof"});
      columns.push_back({"", Align::Left});
    }
  }

  void add_cells(std::span<const ComparisonCell* const> of_models, std::vector<std::string>& cells) const {
    if (lengths_) add_sizes(of_models, &ComparisonCell::lengths, cells);
    if (lengths_ && !two_) cells.push_back(size_cell(of_models[0]->lengths, &ResidualSize::max));
    if (angles_) add_sizes(of_models, &ComparisonCell::angles, cells);
    for (const ComparisonCell* cell : of_models) cells.push_back(chi2_cell(*cell));
    for (const ComparisonCell* cell : of_models) cells.push_back(mark(*cell));
  }

 private:
  void add_size_headers(std::vector<TextColumn>& columns, const char* unit) const {
    if (!two_) {
      columns.push_back({fmt::format("rms [{}]", unit)});
      return;
    }
    for (const char* name : {"rms A", "rms B", "B - A"})
      columns.push_back({fmt::format("{} [{}]", name, unit)});
    columns.push_back({"B / A"});
  }

  void add_sizes(std::span<const ComparisonCell* const> of_models, ResidualSize ComparisonCell::*kind,
                 std::vector<std::string>& cells) const {
    for (const ComparisonCell* cell : of_models) cells.push_back(size_cell(cell->*kind, &ResidualSize::rms));
    if (!two_) return;
    const ResidualSize &a = of_models[0]->*kind, &b = of_models[1]->*kind;
    const bool both = a.count > 0 && b.count > 0;
    cells.push_back(both ? fixed_number((b.rms - a.rms) * kPerMicro, 2) : "-");
    cells.push_back(both && a.rms > 0.0 ? fixed_number(b.rms / a.rms, 3) : "-");
  }

  bool two_;
  bool lengths_ = false;
  bool angles_ = false;
};

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

using Comparisons = std::vector<const Comparison*>;

template <class Model>
Comparisons comparisons_of(std::span<const Model> models) {
  Comparisons all;
  for (const Model& model : models) all.push_back(&model.comparison);
  return all;
}

std::vector<std::string> row_of(const Grouping& by, const std::string& label, std::size_t count,
                                const Comparisons& models, const CellColumns& columns) {
  static const ComparisonCell kNone;
  std::vector<const ComparisonCell*> cells;
  for (const Comparison* model : models) {
    const ComparisonCell* cell = model->find_cell(by, label);
    cells.push_back(cell ? cell : &kNone);
  }
  std::vector<std::string> row = {label, count_number(static_cast<long long>(count))};
  columns.add_cells(cells, row);
  return row;
}

std::string setups_text(const Campaign& campaign, const Comparisons& models, bool all, std::string title) {
  const CellColumns cell_columns(models);
  const Breakdown& setups = *models.back()->find({By::Setup});
  std::vector<TextColumn> columns = {{"setup", Align::Left}, {"instrument", Align::Left}, {"n"}};
  cell_columns.add_headers(columns);
  const auto shown = shown_cells(setups, all ? setups.cells.size() : kSetupsShown);
  if (shown.size() < setups.cells.size()) {
    title += fmt::format(", worst {} of {}", shown.size(), setups.cells.size());
  }
  TextTable table(columns, title);
  for (const ComparisonCell* cell : shown) {
    auto row = row_of({By::Setup}, cell->label, cell->observations, models, cell_columns);
    const auto setup = std::find_if(campaign.setups.begin(), campaign.setups.end(),
                                    [&](const Setup& one) { return one.name == cell->label; });
    row.insert(row.begin() + 1, setup->instrument);
    table.add_row(std::move(row));
  }
  std::vector<std::string> total = {"all", "",
                                    count_number(static_cast<long long>(models.back()->total.observations))};
  std::vector<const ComparisonCell*> totals;
  for (const Comparison* model : models) totals.push_back(&model->total);
  cell_columns.add_cells(totals, total);
  table.add_row(std::move(total));
  return table.text();
}

std::string places_text(const Comparisons& models, const ComparisonTextOptions& options) {
  const CellColumns cell_columns(models);
  std::vector<TextColumn> columns = {{"by", Align::Left}, {"where", Align::Left}, {"n"}};
  cell_columns.add_headers(columns);
  TextTable table(columns,
                  options.all_cells
                      ? std::string("Residuals by place, direction and time")
                      : fmt::format("Residuals by place, direction and time, worst {} of each", kCellsShown));
  for (const Breakdown& breakdown : models.back()->breakdowns) {
    if (breakdown.by.kind == By::Setup) continue;
    std::string by = fmt::format("{} ({})", breakdown.by.name(), breakdown.cells.size());
    for (const ComparisonCell* cell :
         shown_cells(breakdown, options.all_cells ? breakdown.cells.size() : kCellsShown)) {
      auto row = row_of(breakdown.by, cell->label, cell->observations, models, cell_columns);
      row.insert(row.begin(), std::exchange(by, ""));
      table.add_row(std::move(row));
    }
  }
  return table.text();
}

/// Indices of the worst readings; of two models taken in turn from both, worst first.
std::vector<std::size_t> worst_of(std::span<const ComparedModel> models, std::size_t count) {
  std::vector<std::size_t> worst;
  for (std::size_t place = 0; worst.size() < count; ++place) {
    bool any = false;
    for (const ComparedModel& model : models) {
      if (place >= model.comparison.worst.size()) continue;
      any = true;
      const std::size_t i = model.comparison.worst[place];
      if (worst.size() < count && std::find(worst.begin(), worst.end(), i) == worst.end()) worst.push_back(i);
    }
    if (!any) break;
  }
  return worst;
}

std::string remark_of(const ComparedModel& model, std::size_t i) {
  const bool fits = !model.comparison.total.significant;  // else a large residual is the model's
  return model.records[i].removed ? "left out" : (fits && model.records[i].flagged ? "outlier?" : "");
}

std::string worst_text(const Campaign& campaign, std::span<const ComparedModel> models, std::size_t count) {
  const bool two = models.size() > 1;
  std::vector<TextColumn> columns = {{"setup", Align::Left}, {"line of file"}, {"channel", Align::Left}};
  for (std::size_t m = 0; m < models.size(); ++m)
    columns.push_back({std::string("residual") + (two ? kSuffix[m] : "")});
  if (two) columns.push_back({"B - A"});
  columns.insert(columns.end(), {{"sigma"}, {"unit", Align::Left}});
  for (std::size_t m = 0; m < models.size(); ++m) {
    columns.push_back({std::string("residual/sigma") + (two ? kSuffix[m] : "")});
  }
  for (std::size_t m = 0; m < models.size(); ++m)
    columns.push_back({two ? std::string(1, "AB"[m]) : "", Align::Left});
  TextTable table(columns, two ? "Worst readings of A and of B" : "Worst readings");
  for (const std::size_t i : worst_of(models, count)) {
    const ResidualRecord& record = models[0].records[i];
    const Setup& setup = campaign.setups[record.setup];
    const auto channel = static_cast<std::size_t>(record.channel);
    std::vector<std::string> row = {setup.name, std::to_string(record.source_line),
                                    channel_column(setup, channel)};
    for (const ComparedModel& model : models)
      row.push_back(fixed_number(model.records[i].residual() * kPerMicro, 2));
    if (two)
      row.push_back(fixed_number((models[1].records[i].residual() - record.residual()) * kPerMicro, 2));
    row.push_back(fixed_number(record.sigma * kPerMicro, 2));
    row.push_back(residual_unit(setup, channel));
    for (const ComparedModel& model : models) {
      row.push_back(fixed_number(model.records[i].residual() / model.records[i].sigma, 1));
    }
    for (const ComparedModel& model : models) row.push_back(remark_of(model, i));
    table.add_row(std::move(row));
  }
  return table.text();
}

/// "B against A: RMS 1.92 -> 1.31 um (0.68 times)".
std::string against_sentence(const Comparison& a, const Comparison& b, const std::string& where) {
  std::string text;
  const auto add = [&](const ResidualSize& of_a, const ResidualSize& of_b, const char* unit) {
    if (of_a.count == 0 || of_b.count == 0) return;
    text += fmt::format("{}RMS {} -> {} {}", text.empty() ? "" : ", ", fixed_number(of_a.rms * kPerMicro, 2),
                        fixed_number(of_b.rms * kPerMicro, 2), unit);
    if (of_a.rms > 0.0) text += fmt::format(" ({} times)", fixed_number(of_b.rms / of_a.rms, 3));
  };
  add(a.total.lengths, b.total.lengths, "um");
  add(a.total.angles, b.total.angles, "urad");
  return text.empty() ? "" : "B against A, " + where + ": " + text + ".\n";
}

std::string where_it_fails(const ComparedModel& model) {
  const Comparison& comparison = model.comparison;
  const ComparisonCell& total = comparison.total;
  const std::string overall = fmt::format("chi2/dof {} over {}", short_number(total.reduced_chi2(), 3),
                                          observations_text(total.observations));
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

}  // namespace

std::string compared_name(const std::string& name, const ModelSpec& model) {
  std::string called = states_errors(model) ? name : "nominal machine (" + name + " holds no coefficients)";
  std::string labels;
  for (const EffectSpec& spec : effects_without_amplitude(model))
    labels += (labels.empty() ? "" : ", ") + effect_label(*find_effect(spec.kind)->make(spec, model.file));
  if (!labels.empty()) called += " (without an amplitude, taken as zero: " + labels + ")";
  return called;
}

void note_compared(std::span<const ModelSpec> models, const std::vector<Finding>& of_tables,
                   Campaign& campaign) {
  std::set<std::pair<FindingCode, std::string>> said;
  std::vector<Finding> notes;
  const auto note = [&](std::vector<Finding> findings) {
    for (Finding& each : findings) {
      if (said.emplace(each.code, each.text(each.has("axis") ? "axis" : "effect")).second)
        notes.push_back(std::move(each));
    }
  };
  for (const ModelSpec& model : models) {
    if (states_errors(model)) note(missing_rotary_errors(campaign, model));
  }
  for (const ModelSpec& model : models) note(held_beyond_measured(campaign, model));
  notes.insert(notes.end(), of_tables.begin(), of_tables.end());
  std::ranges::move(notes, std::back_inserter(campaign.notes));
}

std::string failure_sentence(const ComparedModel& model) {
  std::string text = where_it_fails(model);
  if (!model.screening) return text;
  if (const std::optional<Finding> scanned = finding_of(*model.screening))
    text += (model.comparison.total.significant ? " Besides, " : " But ") + contradiction(*scanned) + ".";
  if (model.screening->misread) text += " Note: " + sentence(*model.screening->misread) + ".";
  return text;
}

bool fails(const ComparedModel& model) {
  return model.comparison.total.significant || (model.screening && model.screening->contradicts) ||
         !worst_places(model.comparison, &ComparisonCell::significant, 0.0).empty();
}

std::string comparison_text(const Campaign& campaign, std::span<const ComparedModel> models,
                            const ComparisonTextOptions& options) {
  const bool two = models.size() > 1;
  std::string text;
  for (std::size_t m = 0; m < models.size(); ++m) {
    text += (two ? std::string(kSuffix[m]).substr(1) + " = " : "") + failure_sentence(models[m]) + '\n';
    if (models[m].comparison.removed > 0) {
      text += fmt::format("{} that the adjustment left out are not counted.\n",
                          observations_text(models[m].comparison.removed));
    }
  }
  const Comparisons comparisons = comparisons_of(models);
  if (two) text += against_sentence(*comparisons[0], *comparisons[1], "all readings");
  text += findings_text(campaign.notes);
  text += '\n' + setups_text(campaign, comparisons, options.all_cells, "Residuals by setup");
  const std::string places = places_text(comparisons, options);
  if (!places.empty()) text += '\n' + places;
  text +=
      "  * worse than chance, ** also worse than the rest (chi2 tests, 5 % over all cells)\n"
      "  dof: readings less the nuisance parameters estimated anew; readings that the model was fitted to "
      "have\n"
      "  chi2/dof a little below 1\n";
  const std::string means =
      signed_means_text(comparisons, options.all_cells ? campaign.setups.size() : kSetupsShown);
  if (!means.empty()) text += '\n' + means;
  std::vector<NamedFigures> figures;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::string name = two ? std::string("model") + kSuffix[m] : "model";
    figures.push_back({name, &models[m].figures});
  }
  const std::string standards = standard_figures_text(figures);
  if (!standards.empty()) text += '\n' + standards;
  const std::string worst = worst_text(campaign, models, options.worst);
  return worst.empty() ? text : text + '\n' + worst;
}

std::string heldout_text(const Campaign& campaign, std::span<const HeldOutModel> models,
                         std::size_t observations) {
  const Comparisons comparisons = comparisons_of(models);
  std::string text = fmt::format("Held-out lines, used in no fit: every fifth, {} of {}.\n",
                                 count_number(static_cast<long long>(comparisons[0]->total.observations)),
                                 observations_text(observations));
  for (std::size_t m = 0; m < models.size(); ++m) {
    text +=
        fmt::format("{}{}: {}.\n", models.size() > 1 ? std::string(1, "AB"[m]) + " = " : "", models[m].name,
                    models[m].fitted ? "fitted anew without them, then its errors held" : "nothing to fit");
  }
  if (models.size() > 1) text += against_sentence(*comparisons[0], *comparisons[1], "held-out lines");
  return text + '\n' + setups_text(campaign, comparisons, false, "Residuals of held-out lines by setup");
}

std::string heldout_hint() {
  return "These readings may be the ones that the models were fitted to, and more parameters always fit them "
         "better:\na result does not say which it left out. --held-out fits both anew without every fifth "
         "line "
         "and judges\nthem on those lines.\n";
}

}  // namespace volcal
