#include "volcal/model/effects/effect_keys.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>

#include "volcal/model/description/units.h"
#include "volcal/model/instruments/nuisance.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

void add_unique(std::vector<std::string>& names, const std::string& name) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

Eigen::VectorXd mapped(const std::vector<double>& column) {
  return Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size()));
}

}  // namespace

void EffectTable::fail(const std::string& problem, const std::string& remedy) const {
  throw InputError(place, "effect \"" + spec.kind + "\": " + problem, remedy);
}

std::string EffectTable::text(const std::string& key, const std::string& remedy) const {
  const auto value = spec.options.text(key);
  if (!value || value->empty()) fail("it names no " + key, remedy);
  return *value;
}

ErrorSymbol EffectTable::symbol() const {
  const std::string name = text("symbol", "add symbol = \"EXX\"");
  const auto symbol = ErrorSymbol::parse(name);
  if (!symbol) {
    fail("\"" + name + "\" is not an error motion",
         "write E, the component X Y Z A B C, the moving axis, as in EXX or ECX");
  }
  return *symbol;
}

AxisName EffectTable::axis(const std::string& key) const {
  const std::string name = text(key, "add " + key + " = \"Z\"");
  const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
  if (!axis) fail("\"" + name + "\" is not an axis", "write one of X Y Z A B C");
  return *axis;
}

KeySchema symbol_key(const std::string& help) {
  return {.key = "symbol", .type = KeyType::Text, .required = true, .help = help};
}

KeySchema amplitude_key(const std::string& key, const std::string& help) {
  return {.key = key, .help = help, .plausible_min = 1e-6, .plausible_max = 1e4};
}

std::vector<KeySchema> motion_amplitude_keys(std::initializer_list<std::string> per,
                                             const std::string& help) {
  std::vector<KeySchema> keys;
  for (const std::string& each : per) {
    for (const std::string unit : {"um", "urad"}) {
      keys.push_back({.key = "amplitude_" + unit + (each.empty() ? "" : "_" + each),
                      .help = help + (unit == "um" ? ", displacements" : ", rotations"),
                      .plausible_min = 1e-6,
                      .plausible_max = 1e5});
    }
  }
  return keys;
}

std::string motion_amplitude_key(ErrorSymbol symbol, const std::string& per, const std::string& stem) {
  return stem + "_" + std::string(edge_unit(symbol.component)) + (per.empty() ? "" : "_" + per);
}

std::vector<KeySchema> joined(std::initializer_list<std::vector<KeySchema>> parts) {
  std::vector<KeySchema> keys;
  for (const auto& part : parts) keys.insert(keys.end(), part.begin(), part.end());
  return keys;
}

std::vector<std::string> temperature_channels(const Campaign& campaign) {
  std::vector<std::string> channels;
  for (const Setup& setup : campaign.setups) {
    for (const auto& [channel, values] : setup.readings.temperature) add_unique(channels, channel);
  }
  return channels;
}

std::string listed_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::string station_of(const Setup& setup) {
  if (!setup.options.vector("station")) return {};
  return setup.options.text("station").value_or(setup.name);
}

bool measures_lengths(const Setup& setup) { return traits_of(setup).laser_length != LaserLength::None; }

std::vector<std::string> station_names(const Campaign& campaign) {
  std::vector<std::string> stations;
  for (const Setup& setup : campaign.setups) add_unique(stations, station_of(setup));
  return stations;
}

std::vector<std::string> tools_in_use(const Campaign& campaign) {
  std::vector<std::string> tools;
  for (const Setup& setup : campaign.setups) add_unique(tools, campaign.machine.tools[setup.tool].name);
  return tools;
}

std::pair<double, double> time_span(const Campaign& campaign) {
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const Setup& setup : campaign.setups) {
    for (const double time : setup.readings.time) {
      first = std::min(first, time);
      last = std::max(last, time);
    }
  }
  return first <= last ? std::pair{first, last} : std::pair{0.0, 0.0};
}

bool has_time(const Campaign& campaign) {
  const auto [first, last] = time_span(campaign);
  return last > first;
}

double clock_start(const SetupView& view) {
  return view.clock_start ? *view.clock_start : time_span(view.campaign).first;
}

void check_axis(const Campaign& campaign, AxisName axis, const std::string& what, const SourcePlace& place) {
  if (campaign.machine.has_axis(axis)) return;
  throw InputError(
      place, what + ": the machine has no axis " + letter_of(axis),
      "name an axis of structure \"" + campaign.machine.structure.code + "\" or remove the effect");
}

void check_channel(const Campaign& campaign, const std::string& channel, const SourcePlace& place) {
  const auto channels = temperature_channels(campaign);
  if (std::ranges::find(channels, channel) != channels.end()) return;
  throw InputError(place, "no reading has the temperature channel \"" + channel + "\"",
                   "add the column T_" + channel + "_degC, name a channel of the campaign (" +
                       listed_names(channels) + ") or remove the effect");
}

void check_time(const Campaign& campaign, const std::string& what, const SourcePlace& place) {
  if (has_time(campaign)) return;
  throw InputError(place, what + " depends on time, but no two readings differ in time_s",
                   "add the column time_s or remove the effect");
}

void check_station(const Campaign& campaign, const std::string& station, const SourcePlace& place) {
  const auto stations = station_names(campaign);
  if (std::ranges::find(stations, station) != stations.end()) return;
  throw InputError(place, "no setup stands at a station \"" + station + "\"",
                   "name a station of the campaign (" + listed_names(stations) + ") or remove the effect");
}

void check_tool(const Campaign& campaign, const std::string& tool, const SourcePlace& place) {
  const auto tools = tools_in_use(campaign);
  if (std::ranges::find(tools, tool) != tools.end()) return;
  throw InputError(place, "no setup uses a tool \"" + tool + "\"",
                   "name a tool of the campaign (" + listed_names(tools) + ") or remove the effect");
}

void check_setup(const Campaign& campaign, const std::string& setup, const SourcePlace& place) {
  std::vector<std::string> setups;
  for (const Setup& each : campaign.setups) setups.push_back(each.name);
  if (std::ranges::find(setups, setup) != setups.end()) return;
  throw InputError(place, "the campaign has no setup \"" + setup + "\"",
                   "name a setup of the campaign (" + listed_names(setups) + ") or remove the effect");
}

SquarenessMotion motion_of_squareness(LocationSymbol location) {
  const int about = direction_of(location.component);
  const int along = direction_of(location.axis);
  const int across = 3 - about - along;
  return {{kAllComponents[static_cast<std::size_t>(across)], location.axis},
          (along - about + 3) % 3 == 1 ? 1.0 : -1.0};
}

Eigen::VectorXd constant(const SetupView& view, double value) {
  return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(view.rows()), value);
}

Eigen::VectorXd positions_from_home(const SetupView& view, AxisName axis) {
  return mapped(view.setup.readings.position[index_of(axis)]).array() - view.campaign.machine.axis(axis).home;
}

Eigen::VectorXd directions(const SetupView& view, AxisName axis) {
  const auto& direction = view.setup.readings.direction[index_of(axis)];
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.rows()));
  for (std::size_t row = 0; row < direction.size(); ++row) {
    values[static_cast<Eigen::Index>(row)] = direction[row];
  }
  return values;
}

Eigen::VectorXd times(const SetupView& view, double unknown) {
  if (view.setup.readings.time.empty()) {
    return constant(view, unknown);
  }
  return mapped(view.setup.readings.time);
}

Eigen::VectorXd beam_displacements(const SetupView& view) {
  const auto& points_w = view.nominal_point_w;
  const Eigen::Vector3d first_w = points_w.front();
  const auto given = view.setup.options.vector("direction");
  const Eigen::Vector3d beam_w =
      given ? given->normalized() : line_direction(points_w).value_or(Eigen::Vector3d::Zero());
  Eigen::VectorXd along(static_cast<Eigen::Index>(points_w.size()));
  for (std::size_t row = 0; row < points_w.size(); ++row) {
    along[static_cast<Eigen::Index>(row)] = beam_w.dot(points_w[row] - first_w);
  }
  return along;
}

Eigen::VectorXd temperature_excess(const SetupView& view, const std::string& channel) {
  const auto found = view.setup.readings.temperature.find(channel);
  if (found == view.setup.readings.temperature.end()) {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.rows()));
  }
  return mapped(found->second).array() - kReferenceTemperature_degC;
}

EffectSpec effect_spec(const std::string& kind,
                       std::initializer_list<std::pair<std::string, OptionValue>> options) {
  EffectSpec spec;
  spec.kind = kind;
  for (const auto& [stem, value] : options) spec.options.set(stem, value);
  return spec;
}

}  // namespace volcal
