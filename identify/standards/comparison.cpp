#include "volcal/identify/standards/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

#include "volcal/identify/standards/approach.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

using By = Grouping::Kind;

constexpr int kNoCell = -1;
constexpr std::size_t kFewestPerBlock = 30;

/// Puts every reading into one of the labelled cells, or into none.
struct Classifier {
  Grouping by;
  std::vector<std::string> labels;
  std::function<int(std::size_t setup, std::size_t row)> cell;
};

/// Labels in the order in which they are first asked for.
class LabelIndex {
 public:
  int operator()(const std::string& label) {
    const auto [place, is_new] = index_.try_emplace(label, static_cast<int>(labels_.size()));
    if (is_new) labels_.push_back(label);
    return place->second;
  }
  const std::vector<std::string>& labels() const { return labels_; }

 private:
  std::map<std::string, int> index_;
  std::vector<std::string> labels_;
};

Classifier by_setup_label(By by, const Campaign& campaign,
                          const std::function<std::string(const Setup&)>& label) {
  LabelIndex index;
  std::vector<int> cells;
  for (const Setup& setup : campaign.setups) cells.push_back(index(label(setup)));
  return {{by}, index.labels(), [cells](std::size_t setup, std::size_t) { return cells[setup]; }};
}

/// Cells by a whole-number column; setups without it are left out.
Classifier by_number(By kind, const Campaign& campaign, const std::vector<std::int32_t> Readings::*column,
                     bool within_setup) {
  const Grouping by{kind};
  LabelIndex index;
  std::vector<std::map<std::int32_t, int>> cells(campaign.setups.size());
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    const std::map<std::int32_t, int> unique = [&] {
      std::map<std::int32_t, int> numbers;
      for (const std::int32_t number : setup.readings.*column) numbers.emplace(number, 0);
      return numbers;
    }();
    if (within_setup && unique.size() < 2) continue;
    for (const auto& [number, unused] : unique) {
      const std::string label = fmt::format("{} {}", by.name(), number);
      cells[i][number] = index(within_setup ? setup.name + " " + label : label);
    }
  }
  const auto cell = [&campaign, column, cells](std::size_t setup, std::size_t row) {
    if (cells[setup].empty()) return kNoCell;
    return cells[setup].at((campaign.setups[setup].readings.*column)[row]);
  };
  return {by, index.labels(), cell};
}

/// Equal parts of a range; what lies outside belongs to the end parts.
struct Bins {
  double low = 0.0;
  double width = 1.0;
  int count = 1;

  static Bins over(double low, double high, int count) { return {low, (high - low) / count, count}; }
  int of(double value) const {
    if (!(width > 0.0)) return 0;
    return static_cast<int>(std::clamp(std::floor((value - low) / width), 0.0, count - 1.0));
  }
  double start(int bin) const { return low + bin * width; }
  std::string label(int bin, double unit) const {
    const auto rounded = [unit](double value) { return std::round(value / unit * 10.0) / 10.0 + 0.0; };
    return fmt::format("{:.10g} to {:.10g}", rounded(start(bin)), rounded(start(bin + 1)));
  }
};

const std::vector<double>& positions(const Campaign& campaign, std::size_t setup, AxisName axis) {
  return campaign.setups[setup].readings.position[index_of(axis)];
}

bool axis_moves(const Campaign& campaign, AxisName axis) {
  std::optional<double> first;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    for (const double position : positions(campaign, i, axis)) {
      if (!first) first = position;
      if (std::abs(position - *first) > kStandingRange) return true;
    }
  }
  return false;
}

std::vector<AxisName> moving_axes(const Campaign& campaign) {
  std::vector<AxisName> axes;
  for (const AxisName name : kAllAxes) {
    if (campaign.machine.has_axis(name) && axis_moves(campaign, name)) axes.push_back(name);
  }
  return axes;
}

Classifier by_position(const Campaign& campaign, AxisName name, int count) {
  const Axis& axis = campaign.machine.axis(name);
  const Bins bins = Bins::over(axis.travel_min, axis.travel_max, count);
  Classifier classifier{{By::Position, name}, {}, {}};
  for (int bin = 0; bin < count; ++bin) {
    classifier.labels.push_back(fmt::format("{} {} {}", letter_of(name),
                                            bins.label(bin, position_unit(name).si_per_unit),
                                            position_unit(name).suffix));
  }
  classifier.cell = [&campaign, bins, name](std::size_t setup, std::size_t row) {
    return bins.of(positions(campaign, setup, name)[row]);
  };
  return classifier;
}

Classifier by_direction(const Campaign& campaign, AxisName name) {
  std::vector<std::vector<int>> approach;
  for (const Setup& setup : campaign.setups)
    approach.push_back(axis_approach(campaign.machine, setup.readings, name));
  const std::string letter{letter_of(name)};
  return {{By::Direction, name},
          {letter + "+", letter + "-", letter + " unknown"},
          [approach](std::size_t setup, std::size_t row) {
            const int direction = approach[setup][row];
            return direction > 0 ? 0 : (direction < 0 ? 1 : 2);
          }};
}

Classifier by_region(const Campaign& campaign, const std::vector<AxisName>& moving, int blocks) {
  std::vector<AxisName> axes;
  std::vector<Bins> bins;
  for (const AxisName name : moving) {
    if (is_rotary(name)) continue;
    const Axis& axis = campaign.machine.axis(name);
    axes.push_back(name);
    bins.push_back(Bins::over(axis.travel_min, axis.travel_max, blocks));
  }
  const auto count = static_cast<int>(std::lround(std::pow(blocks, static_cast<double>(axes.size()))));
  Classifier classifier{{By::Region}, std::vector<std::string>(static_cast<std::size_t>(count)), {}};
  for (int cell = 0; cell < count; ++cell) {
    std::string& label = classifier.labels[static_cast<std::size_t>(cell)];
    int rest = cell;
    for (std::size_t k = 0; k < axes.size(); ++k, rest /= blocks) {
      label += fmt::format("{}{} {}", k == 0 ? "" : ", ", letter_of(axes[k]),
                           bins[k].label(rest % blocks, kMetrePerMillimetre));
    }
    label += " mm";
  }
  classifier.cell = [&campaign, axes, bins, blocks](std::size_t setup, std::size_t row) {
    int cell = 0;
    for (std::size_t k = axes.size(); k-- > 0;) {
      cell = cell * blocks + bins[k].of(positions(campaign, setup, axes[k])[row]);
    }
    return cell;
  };
  return classifier;
}

std::optional<Classifier> by_time(const Campaign& campaign, int count) {
  std::optional<double> low, high;
  for (const Setup& setup : campaign.setups) {
    for (const double time : setup.readings.time) {
      low = std::min(low.value_or(time), time);
      high = std::max(high.value_or(time), time);
    }
  }
  if (!low || !(*high > *low)) return std::nullopt;
  const Bins bins = Bins::over(*low, *high, count);
  Classifier classifier{{By::Time}, {}, {}};
  for (int bin = 0; bin < count; ++bin) {
    classifier.labels.push_back(fmt::format("{:.0f} to {:.0f} s", bins.start(bin), bins.start(bin + 1)));
  }
  classifier.cell = [&campaign, bins](std::size_t setup, std::size_t row) {
    const auto& time = campaign.setups[setup].readings.time;
    return time.empty() ? kNoCell : bins.of(time[row]);
  };
  return classifier;
}

int region_blocks(const ComparisonOptions& options, std::size_t observations) {
  if (options.region_blocks > 0) return options.region_blocks;
  return observations >= 27 * kFewestPerBlock ? 3 : 2;
}

std::vector<Classifier> all_classifiers(const Campaign& campaign, const ComparisonOptions& options,
                                        std::size_t observations) {
  std::vector<Classifier> all;
  all.push_back(by_setup_label(By::Setup, campaign, [](const Setup& setup) { return setup.name; }));
  all.push_back(
      by_setup_label(By::Instrument, campaign, [](const Setup& setup) { return setup.instrument; }));
  all.push_back(by_setup_label(By::Tool, campaign,
                               [&](const Setup& setup) { return campaign.machine.tools[setup.tool].name; }));
  const std::vector<AxisName> moving = moving_axes(campaign);
  for (const AxisName axis : moving) all.push_back(by_position(campaign, axis, options.position_bins));
  for (const AxisName axis : moving) all.push_back(by_direction(campaign, axis));
  all.push_back(by_region(campaign, moving, region_blocks(options, observations)));
  all.push_back(by_number(By::Line, campaign, &Readings::line, true));
  all.push_back(by_number(By::Run, campaign, &Readings::run, false));
  if (auto time = by_time(campaign, options.time_bins)) all.push_back(std::move(*time));
  return all;
}

void include(double residual, ResidualSize& size) {
  ++size.count;
  size.mean += residual;            // sum until `finish`
  size.rms += residual * residual;  // sum of squares until `finish`
  size.max = std::max(size.max, std::abs(residual));
}

void include(const ResidualRecord& record, bool is_angle, ComparisonCell& cell) {
  ++cell.observations;
  const double standardised = record.residual() / record.sigma;
  cell.chi2 += standardised * standardised;
  cell.dof += record.redundancy;
  include(record.residual(), is_angle ? cell.angles : cell.lengths);
}

void finish(ResidualSize& size) {
  if (size.count == 0) return;
  size.mean /= static_cast<double>(size.count);
  size.rms = std::sqrt(size.rms / static_cast<double>(size.count));
}

void finish(ComparisonCell& cell) {
  finish(cell.lengths);
  finish(cell.angles);
  if (cell.dof > 0.0) cell.probability = chi_squared_exceedance(cell.chi2, cell.dof);
}

Breakdown break_down(const Classifier& classifier, std::span<const ResidualRecord> records,
                     const std::vector<std::vector<bool>>& is_angle) {
  std::vector<ComparisonCell> cells(classifier.labels.size());
  for (const ResidualRecord& record : records) {
    const int cell = record.removed ? kNoCell : classifier.cell(record.setup, record.row);
    if (cell == kNoCell) continue;
    include(record, is_angle[record.setup][static_cast<std::size_t>(record.channel)],
            cells[static_cast<std::size_t>(cell)]);
  }
  Breakdown breakdown{classifier.by, {}};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].observations == 0) continue;
    cells[i].label = classifier.labels[i];
    finish(cells[i]);
    breakdown.cells.push_back(std::move(cells[i]));
  }
  return breakdown;
}

void judge(Comparison& comparison, double family_risk) {
  for (const Breakdown& breakdown : comparison.breakdowns) comparison.cells += breakdown.cells.size();
  const double risk = family_risk / static_cast<double>(std::max<std::size_t>(1, comparison.cells));
  const double level = std::max(1.0, comparison.total.reduced_chi2());
  comparison.total.significant = comparison.total.probability < family_risk;
  for (Breakdown& breakdown : comparison.breakdowns) {
    for (ComparisonCell& cell : breakdown.cells) {
      cell.significant = cell.probability < risk;
      if (cell.dof <= 0.0) continue;
      cell.stands_out = chi_squared_exceedance(cell.chi2 / level, cell.dof) < risk;
    }
  }
}

std::vector<std::size_t> worst_readings(std::span<const ResidualRecord> records, std::size_t count) {
  std::vector<std::size_t> order(records.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t listed = std::min(count, order.size());
  const auto size = [&](std::size_t i) { return std::abs(records[i].residual()) / records[i].sigma; };
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(listed), order.end(),
      [&](std::size_t a, std::size_t b) { return size(a) != size(b) ? size(a) > size(b) : a < b; });
  order.resize(listed);
  return order;
}

}  // namespace

std::string Grouping::name() const {
  constexpr std::array<const char*, 9> kNames = {"setup",  "instrument", "tool", "",    "direction of ",
                                                 "region", "line",       "run",  "time"};
  const bool of_axis = kind == By::Position || kind == By::Direction;
  return kNames[static_cast<std::size_t>(kind)] + (of_axis ? std::string(1, letter_of(axis)) : "");
}

const Breakdown* Comparison::find(const Grouping& by) const {
  const auto found = std::ranges::find(breakdowns, by, &Breakdown::by);
  return found == breakdowns.end() ? nullptr : &*found;
}

const ComparisonCell* Comparison::find_cell(const Grouping& by, const std::string& label) const {
  const Breakdown* breakdown = find(by);
  if (breakdown == nullptr) return nullptr;
  const auto found = std::ranges::find(breakdown->cells, label, &ComparisonCell::label);
  return found == breakdown->cells.end() ? nullptr : &*found;
}

Comparison compare(const Campaign& campaign, std::span<const ResidualRecord> records,
                   const ComparisonOptions& options) {
  const std::vector<std::vector<bool>> is_angle = angle_channels(campaign);
  Comparison comparison;
  comparison.total.label = "all";
  for (const ResidualRecord& record : records) {
    if (record.removed) {
      ++comparison.removed;
      continue;
    }
    include(record, is_angle[record.setup][static_cast<std::size_t>(record.channel)], comparison.total);
  }
  finish(comparison.total);
  for (const Classifier& classifier : all_classifiers(campaign, options, comparison.total.observations)) {
    Breakdown breakdown = break_down(classifier, records, is_angle);
    if (breakdown.cells.size() < 2 && breakdown.by.kind != By::Setup) continue;
    comparison.breakdowns.push_back(std::move(breakdown));
  }
  judge(comparison, options.family_risk);
  comparison.worst = worst_readings(records, options.worst);
  return comparison;
}

}  // namespace volcal
