#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr double kUsualGap = 4.0;  // s between readings

template <class T>
std::vector<T> picked(const std::vector<T>& column, const std::vector<std::size_t>& rows) {
  std::vector<T> out;
  if (column.empty()) return out;
  for (const std::size_t row : rows) out.push_back(column[row]);
  return out;
}

/// `count` of `total` indices, ascending, spread evenly but on no grid.
std::vector<std::size_t> spread(std::size_t total, std::size_t count) {
  std::set<std::size_t> chosen;
  for (std::size_t k = 0; chosen.size() < std::min(count, total); ++k) {
    const double share = std::fmod((static_cast<double>(k) + 0.5) * kGoldenShare, 1.0);
    chosen.insert(static_cast<std::size_t>(share * static_cast<double>(total)));
  }
  return {chosen.begin(), chosen.end()};
}

double usual_gap(const Readings& readings) {
  std::vector<double> gaps;
  for (std::size_t row = 1; row < readings.time.size(); ++row) {
    const double gap = readings.time[row] - readings.time[row - 1];
    if (gap > 0.0) gaps.push_back(gap);
  }
  if (gaps.empty()) return kUsualGap;
  std::ranges::nth_element(gaps, gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2));
  return gaps[gaps.size() / 2];
}

/// Temperature of a channel at the beginning or the end of the campaign.
double temperature_at(const Campaign& campaign, const std::string& channel, Temperatures temperatures) {
  const bool first = temperatures == Temperatures::First;
  double best_time =
      first ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  double value = kReferenceTemperature_degC;
  for (const Setup& setup : campaign.setups) {
    const auto found = setup.readings.temperature.find(channel);
    if (found == setup.readings.temperature.end() || found->second.empty()) continue;
    const auto& time = setup.readings.time;
    const double when = time.empty() ? 0.0 : first ? time.front() : time.back();
    if (first ? when >= best_time : when < best_time) continue;
    best_time = when;
    value = first ? found->second.front() : found->second.back();
  }
  return value;
}

}  // namespace

std::vector<std::size_t> spread_rows(const Setup& setup, std::size_t count) {
  const Readings& readings = setup.readings;
  if (readings.line.empty()) return spread(readings.size(), count);
  std::map<std::int32_t, std::vector<std::size_t>> lines;
  for (std::size_t row = 0; row < readings.size(); ++row) lines[readings.line[row]].push_back(row);
  const double per_line = static_cast<double>(readings.size()) / static_cast<double>(lines.size());
  const auto wanted =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(static_cast<double>(count) / per_line)));
  if (wanted == 1) {  // one long line: points of it
    const std::vector<std::size_t>& rows = lines.begin()->second;
    std::vector<std::size_t> out = spread(rows.size(), count);
    for (std::size_t& i : out) i = rows[i];
    return out;
  }
  std::vector<const std::vector<std::size_t>*> order;
  order.reserve(lines.size());
  for (const auto& [id, rows] : lines) order.push_back(&rows);
  std::vector<std::size_t> out;
  for (const std::size_t i : spread(order.size(), wanted)) {
    out.insert(out.end(), order[i]->begin(), order[i]->end());
  }
  std::ranges::sort(out);
  return out;
}

ExtraMeasurement taken_again(const CandidateContext& context, const Setup& setup, const std::string& name,
                             std::string words, double later_s, Temperatures temperatures) {
  const std::vector<std::size_t> rows = spread_rows(setup, context.readings);
  Setup out;
  out.name = name;
  out.instrument = setup.instrument;
  out.tool = setup.tool;
  for (const auto& [key, value] : setup.options.all()) {
    if (key.first != "station_sigma") out.options.set(key.first, value);
  }
  if (const std::string station = station_of(setup); !station.empty()) out.options.set("station", station);
  out.noise = setup.noise;
  out.has_noise = setup.has_noise;
  out.repeatability = setup.repeatability;
  const Readings& from = setup.readings;
  Readings& to = out.readings;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    to.position[axis] = picked(from.position[axis], rows);
    to.direction[axis] = picked(from.direction[axis], rows);
  }
  for (const auto& channel : from.value) to.value.push_back(picked(channel, rows));
  for (const auto& column : from.given) to.given.push_back(picked(column, rows));
  to.column_set = from.column_set;
  to.sigma = picked(from.sigma, rows);
  to.line = picked(from.line, rows);
  to.run = picked(from.run, rows);
  to.feed = picked(from.feed, rows);
  to.source_line.assign(rows.size(), 0);
  complete_readings(context, end_of(context.campaign) + later_s, usual_gap(from), temperatures,
                    from.channels(), to);
  ExtraMeasurement extra;
  extra.setup = setup.name;
  extra.words = std::move(words);
  extra.setups.push_back(std::move(out));
  return extra;
}

std::vector<ExtraMeasurement> altered_again(
    const CandidateContext& context, const std::string& suffix,
    const std::function<std::string(const Setup& measured, const Axis& axis, Readings& again)>& alter,
    const std::function<std::string(const std::string& place, const std::string& changes)>& words) {
  std::vector<ExtraMeasurement> all;
  for (const Setup* setup : one_setup_per_station(context.campaign)) {
    ExtraMeasurement extra = taken_again(context, *setup, setup->name + suffix);
    std::string changes;
    for (const Axis& axis : context.campaign.machine.axes) {
      const std::string change = alter(*setup, axis, extra.setups.front().readings);
      if (!change.empty()) changes += (changes.empty() ? "" : ", ") + change;
    }
    if (changes.empty()) continue;
    extra.words = words(place_and_tool(context.campaign, *setup), changes);
    all.push_back(std::move(extra));
  }
  return all;
}

std::vector<const Setup*> one_setup_per_station(const Campaign& campaign) {
  std::vector<const Setup*> out;
  std::set<std::string> seen;
  for (const Setup& setup : campaign.setups) {
    if (seen.insert(place_name(setup)).second) out.push_back(&setup);
  }
  return out;
}

std::string place_name(const Setup& setup) {
  const std::string station = station_of(setup);
  return station.empty() ? setup.name : station;
}

std::string place_and_tool(const Campaign& campaign, const Setup& setup) {
  return place_name(setup) + " with tool " + campaign.machine.tools[setup.tool].name;
}

double end_of(const Campaign& campaign) { return time_span(campaign).second; }

void complete_readings(const CandidateContext& context, double start_s, double seconds_per_reading,
                       Temperatures temperatures, std::size_t channels, Readings& readings) {
  const std::size_t count = readings.source_line.size();
  if (has_time(context.campaign)) {
    readings.time.resize(count);
    for (std::size_t row = 0; row < count; ++row) {
      readings.time[row] = start_s + seconds_per_reading * static_cast<double>(row);
    }
  }
  for (const std::string& channel : temperature_channels(context.campaign)) {
    readings.temperature[channel].assign(count, temperature_at(context.campaign, channel, temperatures));
  }
  readings.value.resize(channels);
  for (auto& value : readings.value) value.resize(count, 0.0);
}

}  // namespace volcal
