/// Residuals against everything recorded: positions of the axes, direction of approach, temperatures, length
/// of the beam, time, setup. Normalised by the noise of the adjustment, by the stated noise where the
/// estimated one is larger (an effect that the noise model has taken for noise stays visible then), or in
/// their units. Means are over all readings but the suspect, the histogram over all; the points drawn are a
/// sample when there are very many.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/line_means.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/identify/report/values/shown_variable.h"
#include "volcal/identify/report/values/swallowed_noise.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal::report {
namespace {

constexpr std::size_t kPointsOfAll = 20000;  // over all plots of the page
constexpr std::size_t kMostDrawn = 4000;     // per plot
constexpr std::size_t kFewestDrawn = 1200;
constexpr std::size_t kMostTemperatures = 6;
constexpr int kMeanBins = 20;
constexpr std::size_t kFewestPerBin = 5;  ///< a mean of fewer readings says nothing
constexpr double kHistogramEnd = 5.0;
constexpr int kHistogramBins = 40;

double nan() { return std::numeric_limits<double>::quiet_NaN(); }

/// Readings that means are taken over: those with a residual of their own, suspect ones left out.
bool counts(const ResidualRecord& record) { return !is_suspect(record) && record.redundancy > 0.0; }

/// What is drawn over the abscissae.
struct Ordinate {
  std::string name;                                 ///< "w", "stated", "um", "urad"
  std::function<double(std::size_t record)> value;  ///< not a number: not of this kind
  std::function<double(std::size_t record)> sigma;  ///< of the value
};

std::vector<Ordinate> ordinates(const PageInput& input, const SwallowedNoise& swallowed,
                                const std::vector<std::vector<bool>>& is_angle) {
  const std::vector<ResidualRecord>& records = input.result.residuals;
  const auto one = [](std::size_t) { return 1.0; };
  std::vector<Ordinate> list = {{"w", [&records](std::size_t i) { return records[i].w; }, one}};
  if (swallowed.readings > 0)
    list.push_back({"stated", [&](std::size_t i) { return records[i].w * swallowed.factor[i]; }, one});
  for (const bool angle : {false, true}) {
    const auto value = [&records, &is_angle, angle](std::size_t i) {
      const ResidualRecord& record = records[i];
      const bool is = is_angle[record.setup][static_cast<std::size_t>(record.channel)];
      return is == angle ? record.residual() * kPerMicro : nan();
    };
    const auto sigma = [&records, &swallowed](std::size_t i) {
      return records[i].sigma / swallowed.factor[i] * kPerMicro;
    };
    list.push_back({angle ? "urad" : "um", value, sigma});
  }
  return list;
}

/// What residuals are drawn against.
struct Abscissa {
  std::string key;  ///< "X", "time", "dir_X", "T_air", "length"
  std::string title;
  std::string unit;
  std::function<double(const ResidualRecord&)> value;
  bool discrete = false;  ///< -1, 0, 1
};

/// `value_si`: of a record.
template <class Value>
Abscissa abscissa(std::string key, const Variable& variable, const Value& value_si) {
  const ShownVariable shown = shown_variable(variable);
  return {
      std::move(key), shown.title, shown.unit,
      [value_si, factor = shown.factor](const ResidualRecord& record) { return value_si(record) * factor; }};
}

/// Means of an ordinate in equal bins of an abscissa, or at its values.
Json binned_mean(const PageInput& input, const std::vector<double>& x, bool discrete,
                 const Ordinate& ordinate) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double each : x) {
    if (std::isnan(each)) continue;
    low = std::min(low, each);
    high = std::max(high, each);
  }
  const double width = discrete ? 1.0 : (high - low) / kMeanBins;
  std::map<int, LineMean> bins;
  for (std::size_t i = 0; i < x.size() && width > 0.0; ++i) {
    const ResidualRecord& record = input.result.residuals[i];
    const double value = ordinate.value(i);
    if (std::isnan(x[i]) || std::isnan(value) || !counts(record)) continue;
    const int bin = discrete ? static_cast<int>(std::lround(x[i] - low))
                             : std::clamp(static_cast<int>((x[i] - low) / width), 0, kMeanBins - 1);
    const std::vector<std::int32_t>& line = input.campaign.setups[record.setup].readings.line;
    bins[bin].add(value, ordinate.sigma(i), record.setup, line.empty() ? 0 : line[record.row]);
  }
  Json centre = Json::array(), mean = Json::array(), band = Json::array(), count = Json::array();
  for (const auto& [bin, of_bin] : bins) {
    if (of_bin.count() < kFewestPerBin) continue;
    centre.push_back(rounded(discrete ? low + bin : low + (bin + 0.5) * width, 6));
    mean.push_back(rounded(of_bin.mean(), 4));
    band.push_back(rounded(2.0 * of_bin.standard_u(), 4));
    count.push_back(of_bin.count());
  }
  return {{"centre", std::move(centre)},
          {"mean", std::move(mean)},
          {"band", std::move(band)},
          {"count", std::move(count)}};
}

/// Nothing to draw against what never changes.
bool varies(const std::vector<double>& x) {
  double first = nan();
  for (const double each : x) {
    if (std::isnan(each)) continue;
    if (std::isnan(first)) first = each;
    if (each != first) return true;
  }
  return false;
}

const Readings& readings_of(const PageInput& input, const ResidualRecord& record) {
  return input.campaign.setups[record.setup].readings;
}

void add_axes(const PageInput& input, std::vector<Abscissa>& list) {
  for (const Axis& axis : input.result.machine.axes) {
    const std::size_t k = index_of(axis.name);
    list.push_back(abscissa(axis_letter(axis.name), position_of(axis.name), [&input, k](const auto& record) {
      return readings_of(input, record).position[k][record.row];
    }));
  }
  for (const Axis& axis : input.result.machine.axes) {
    const std::size_t k = index_of(axis.name);
    list.push_back(abscissa("dir_" + axis_letter(axis.name), direction_of_approach(axis.name),
                            [&input, k](const auto& record) {
                              const auto& direction = readings_of(input, record).direction[k];
                              return direction.empty() ? nan() : static_cast<double>(direction[record.row]);
                            }));
    list.back().discrete = true;
  }
}

/// The channels that most readings record, all where there are few.
std::vector<std::string> temperature_channels(const Campaign& campaign) {
  std::map<std::string, std::size_t> readings;
  for (const Setup& setup : campaign.setups) {
    for (const auto& [channel, values] : setup.readings.temperature) readings[channel] += values.size();
  }
  std::vector<std::string> channels;
  for (const auto& [channel, count] : readings) channels.push_back(channel);
  std::ranges::stable_sort(channels, std::greater<>(),
                           [&](const std::string& channel) { return readings.at(channel); });
  if (channels.size() > kMostTemperatures) channels.resize(kMostTemperatures);
  return channels;
}

void add_environment(const PageInput& input, std::vector<Abscissa>& list) {
  for (const std::string& channel : temperature_channels(input.campaign)) {
    const Variable variable = temperature_of(channel);
    list.push_back(abscissa(variable.name(), variable, [&input, channel](const auto& record) {
      const auto& all = readings_of(input, record).temperature;
      const auto found = all.find(channel);
      return found == all.end() || found->second.empty() ? nan() : found->second[record.row];
    }));
  }
  const Variable length{Variable::Kind::Length}, time{Variable::Kind::Time};
  list.push_back(abscissa(length.name(), length, [&input](const auto& record) {
    const Setup& setup = input.campaign.setups[record.setup];
    return traits_of(setup).laser_length == LaserLength::Distance ? setup.readings.value[0][record.row]
                                                                  : nan();
  }));
  list.push_back(abscissa(time.name(), time, [&input](const auto& record) {
    const std::vector<double>& recorded = readings_of(input, record).time;
    return recorded.empty() ? nan() : recorded[record.row];
  }));
}

struct Against {
  Abscissa abscissa;
  std::vector<double> x;  ///< of every record
};

/// Everything recorded that changes.
std::vector<Against> recorded(const PageInput& input) {
  std::vector<Abscissa> list;
  add_axes(input, list);
  add_environment(input, list);
  std::vector<Against> all;
  for (Abscissa& abscissa : list) {
    std::vector<double> x(input.result.residuals.size());
    std::ranges::transform(input.result.residuals, x.begin(), abscissa.value);
    if (varies(x)) all.push_back({std::move(abscissa), std::move(x)});
  }
  return all;
}

Json plots(const PageInput& input, const std::vector<Against>& against, const std::vector<std::size_t>& drawn,
           const std::vector<Ordinate>& list) {
  Json json = Json::array();
  for (const auto& [abscissa, all] : against) {
    Json x = Json::array(), means = Json::object();
    for (const std::size_t i : drawn) x.push_back(rounded(all[i], 6));
    for (const Ordinate& ordinate : list)
      means[ordinate.name] = binned_mean(input, all, abscissa.discrete, ordinate);
    json.push_back({{"axis", abscissa.key},
                    {"title", abscissa.title},
                    {"unit", abscissa.unit},
                    {"discrete", abscissa.discrete},
                    {"x", std::move(x)},
                    {"mean", std::move(means)}});
  }
  return json;
}

Json drawn_records(const PageInput& input, const std::vector<std::size_t>& drawn,
                   const SwallowedNoise& swallowed, const std::vector<std::vector<bool>>& is_angle) {
  Json setup = Json::array();
  Json line = Json::array();
  Json residual = Json::array();
  Json sigma = Json::array();
  Json factor = Json::array();
  Json w = Json::array();
  Json flag = Json::array();
  Json angle = Json::array();
  for (const std::size_t i : drawn) {
    const ResidualRecord& record = input.result.residuals[i];
    setup.push_back(record.setup);
    angle.push_back(is_angle[record.setup][static_cast<std::size_t>(record.channel)] ? 1 : 0);
    line.push_back(record.source_line);
    residual.push_back(rounded(record.residual() * kPerMicro, 3));
    sigma.push_back(rounded(record.sigma * kPerMicro, 3));
    if (swallowed.readings > 0) factor.push_back(rounded(swallowed.factor[i], 4));
    w.push_back(rounded(record.w, 3));
    flag.push_back(record.removed ? 2 : record.flagged ? 1 : 0);
  }
  return {{"setup", std::move(setup)},       {"file_line", std::move(line)}, {"angle", std::move(angle)},
          {"residual", std::move(residual)}, {"sigma", std::move(sigma)},    {"w", std::move(w)},
          {"factor", std::move(factor)},     {"flag", std::move(flag)}};
}

/// Counts of w in equal bins between -5 and 5; the end bins take everything beyond.
Json histogram(const std::vector<ResidualRecord>& records) {
  const double width = 2.0 * kHistogramEnd / kHistogramBins;
  std::vector<std::size_t> count(kHistogramBins, 0);
  std::size_t total = 0;
  for (const ResidualRecord& record : records) {
    if (record.redundancy <= 0.0) continue;
    const double place = (record.w + kHistogramEnd) / width;
    ++count[static_cast<std::size_t>(std::clamp(place, 0.0, kHistogramBins - 1.0))];
    ++total;
  }
  return {{"from", -kHistogramEnd}, {"width", width}, {"count", count}, {"total", total}};
}

/// RMS of w and means of every ordinate per setup, suspect readings left out of the means.
Json by_setup(const PageInput& input, const std::vector<Ordinate>& list) {
  const FitResult& result = input.result;
  std::vector<double> square(result.setups.size(), 0.0);
  std::vector<double> count(result.setups.size(), 0.0);
  std::vector<std::vector<LineMean>> means(result.setups.size(), std::vector<LineMean>(list.size()));
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const ResidualRecord& record = result.residuals[i];
    if (record.removed || record.redundancy <= 0.0) continue;
    square[record.setup] += record.w * record.w;
    count[record.setup] += 1.0;
    if (!counts(record)) continue;
    const std::vector<std::int32_t>& line = readings_of(input, record).line;
    for (std::size_t k = 0; k < list.size(); ++k) {
      const double value = list[k].value(i);
      if (!std::isnan(value))
        means[record.setup][k].add(value, list[k].sigma(i), record.setup,
                                   line.empty() ? 0 : line[record.row]);
    }
  }
  Json rows = Json::array();
  for (std::size_t i = 0; i < result.setups.size(); ++i) {
    Json of_setup = Json::object();
    for (std::size_t k = 0; k < list.size(); ++k) {
      const LineMean& mean = means[i][k];
      if (mean.count() == 0) continue;
      of_setup[list[k].name] = {{"mean", rounded(mean.mean(), 3)},
                                {"band", rounded(2.0 * mean.standard_u(), 3)}};
    }
    rows.push_back({{"name", result.setups[i].name},
                    {"instrument", result.setups[i].instrument},
                    {"station", input.campaign.setups[i].options.text("station").value_or("")},
                    {"mean", std::move(of_setup)},
                    {"rms_w", rounded(count[i] > 0 ? std::sqrt(square[i] / count[i]) : nan(), 4)},
                    {"count", count[i]}});
  }
  return rows;
}

Json swallowed_json(const SwallowedNoise& swallowed) {
  Json groups = Json::array();
  for (const auto& [name, factor] : swallowed.groups)
    groups.push_back({{"name", name}, {"factor", rounded(factor, 3)}});
  return {{"readings", swallowed.readings}, {"groups", std::move(groups)}};
}

}  // namespace

Json residuals_page(const PageInput& input) {
  const FitResult& result = input.result;
  const std::vector<std::vector<bool>> is_angle = angle_channels(input.campaign);
  const SwallowedNoise swallowed = swallowed_noise(result, input.campaign);
  const std::vector<Ordinate> list = ordinates(input, swallowed, is_angle);
  const std::vector<Against> against = recorded(input);
  const std::size_t limit = std::clamp(kPointsOfAll / (against.size() + 1), kFewestDrawn, kMostDrawn);
  const std::vector<std::size_t> drawn = residual_sample(result.residuals, limit);
  return {{"total", result.residuals.size()},
          {"drawn", drawn.size()},
          {"critical", rounded(result.outlier_critical_value, 4)},
          {"swallowed", swallowed_json(swallowed)},
          {"records", drawn_records(input, drawn, swallowed, is_angle)},
          {"plots", plots(input, against, drawn, list)},
          {"setups", by_setup(input, list)},
          {"histogram", histogram(result.residuals)}};
}

}  // namespace volcal::report
