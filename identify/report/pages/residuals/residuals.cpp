/// Normalised residuals against everything recorded: positions of the axes, time, setup.
/// Means are over all readings but the suspect, the histogram over all; the points drawn are a sample when
/// there are very many.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/channels.h"

namespace volcal::report {
namespace {

constexpr std::size_t kDrawn = 4000;  ///< per plot: five plots of a page stay near 20,000 points
constexpr int kMeanBins = 20;
constexpr double kFewestPerBin = 5.0;  ///< a mean of fewer readings says nothing
constexpr double kHistogramEnd = 5.0;
constexpr int kHistogramBins = 40;

double nan() { return std::numeric_limits<double>::quiet_NaN(); }

/// Readings that means are taken over: those with a residual of their own, suspect ones left out.
bool counts(const ResidualRecord& record) { return !is_suspect(record) && record.redundancy > 0.0; }

/// Mean of w in equal bins of an abscissa, with the number of readings in each.
Json binned_mean(const std::vector<double>& abscissa, const std::vector<ResidualRecord>& records) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double x : abscissa) {
    if (std::isnan(x)) continue;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  std::vector<double> sum(kMeanBins, 0.0);
  std::vector<double> count(kMeanBins, 0.0);
  const double width = (high - low) / kMeanBins;
  if (width > 0.0) {
    for (std::size_t i = 0; i < abscissa.size(); ++i) {
      if (std::isnan(abscissa[i]) || !counts(records[i])) continue;
      const auto bin = static_cast<std::size_t>(
          std::clamp(static_cast<int>((abscissa[i] - low) / width), 0, kMeanBins - 1));
      sum[bin] += records[i].w;
      count[bin] += 1.0;
    }
  }
  Json centre = Json::array();
  Json mean = Json::array();
  Json half_band = Json::array();
  for (int bin = 0; bin < kMeanBins; ++bin) {
    const auto k = static_cast<std::size_t>(bin);
    if (count[k] < kFewestPerBin) continue;
    centre.push_back(rounded(low + (bin + 0.5) * width, 6));
    mean.push_back(rounded(sum[k] / count[k], 4));
    half_band.push_back(rounded(2.0 / std::sqrt(count[k]), 4));
  }
  return {{"centre", std::move(centre)}, {"mean", std::move(mean)}, {"band", std::move(half_band)}};
}

/// One plot: values of the abscissa for the drawn readings and the binned mean of all readings.
template <class Abscissa>
Json plot(const PageInput& input, const std::vector<std::size_t>& drawn, const Abscissa& abscissa) {
  const std::vector<ResidualRecord>& records = input.result.residuals;
  std::vector<double> all(records.size());
  std::ranges::transform(records, all.begin(), abscissa);
  Json x = Json::array();
  for (const std::size_t i : drawn) x.push_back(rounded(all[i], 6));
  return {{"x", std::move(x)}, {"mean", binned_mean(all, records)}};
}

bool has_time(const Campaign& campaign) {
  return std::ranges::any_of(campaign.setups,
                             [](const Setup& setup) { return !setup.readings.time.empty(); });
}

Json plots(const PageInput& input, const std::vector<std::size_t>& drawn) {
  const std::vector<Setup>& setups = input.campaign.setups;
  Json list = Json::array();
  for (const Axis& axis : input.result.machine.axes) {
    const std::size_t k = index_of(axis.name);
    Json json = plot(input, drawn, [&](const ResidualRecord& record) {
      return setups[record.setup].readings.position[k][record.row] * position_factor(axis.name);
    });
    json["axis"] = axis_letter(axis.name);
    json["title"] = "Position " + axis_letter(axis.name);
    json["unit"] = position_unit(axis.name).suffix;
    list.push_back(std::move(json));
  }
  if (has_time(input.campaign)) {
    Json json = plot(input, drawn, [&](const ResidualRecord& record) {
      const std::vector<double>& time = setups[record.setup].readings.time;
      return time.empty() ? nan() : time[record.row] / kSecondsPerMinute;
    });
    json["axis"] = "time";
    json["title"] = "Time";
    json["unit"] = "min";
    list.push_back(std::move(json));
  }
  return list;
}

Json drawn_records(const PageInput& input, const std::vector<std::size_t>& drawn) {
  const std::vector<std::vector<bool>> is_angle = angle_channels(input.campaign);
  Json setup = Json::array();
  Json line = Json::array();
  Json residual = Json::array();
  Json sigma = Json::array();
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
    w.push_back(rounded(record.w, 3));
    flag.push_back(record.removed ? 2 : record.flagged ? 1 : 0);
  }
  return {{"setup", std::move(setup)},       {"file_line", std::move(line)}, {"angle", std::move(angle)},
          {"residual", std::move(residual)}, {"sigma", std::move(sigma)},    {"w", std::move(w)},
          {"flag", std::move(flag)}};
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

/// Mean and RMS of w per setup, over all its readings.
Json by_setup(const PageInput& input) {
  const FitResult& result = input.result;
  std::vector<double> sum(result.setups.size(), 0.0);
  std::vector<double> square(result.setups.size(), 0.0);
  std::vector<double> count(result.setups.size(), 0.0);
  for (const ResidualRecord& record : result.residuals) {
    if (record.removed || record.redundancy <= 0.0) continue;
    sum[record.setup] += record.w;
    square[record.setup] += record.w * record.w;
    count[record.setup] += 1.0;
  }
  Json rows = Json::array();
  for (std::size_t i = 0; i < result.setups.size(); ++i) {
    const auto& options = input.campaign.setups[i].options;
    rows.push_back({{"name", result.setups[i].name},
                    {"instrument", result.setups[i].instrument},
                    {"station", options.text("station").value_or("")},
                    {"mean_w", rounded(count[i] > 0 ? sum[i] / count[i] : nan(), 3)},
                    {"rms_w", rounded(count[i] > 0 ? std::sqrt(square[i] / count[i]) : nan(), 4)},
                    {"count", count[i]}});
  }
  return rows;
}

}  // namespace

Json residuals_page(const PageInput& input) {
  const FitResult& result = input.result;
  const std::vector<std::size_t> drawn = residual_sample(result.residuals, kDrawn);
  return {{"total", result.residuals.size()},
          {"drawn", drawn.size()},
          {"critical", rounded(result.outlier_critical_value, 4)},
          {"records", drawn_records(input, drawn)},
          {"plots", plots(input, drawn)},
          {"setups", by_setup(input)},
          {"histogram", histogram(result.residuals)}};
}

}  // namespace volcal::report
