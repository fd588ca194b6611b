#include "volcal/model/effects/recorded_variable.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/travel_since_turning.h"

namespace volcal {
namespace {

/// The channel that a variable T_... means.
const std::vector<double>* temperature(const Readings& readings, const std::string& variable) {
  for (const auto& [channel, values] : readings.temperature) {
    if (channel_variable(channel) == variable) return &values;
  }
  return nullptr;
}

std::optional<AxisName> axis_of(const std::string& letter) {
  if (letter.size() != 1 || letter[0] < 'a') return std::nullopt;
  return axis_from_letter(static_cast<char>(std::toupper(letter[0])));
}

constexpr const char* kDirection = "dir_";
constexpr const char* kSinceTurning = "since_";

/// Of a position, direction or travel since turning.
std::optional<AxisName> axis_in(const std::string& name) {
  for (const std::string prefix : {kDirection, kSinceTurning}) {
    if (name.starts_with(prefix)) return axis_of(name.substr(prefix.size()));
  }
  return axis_of(name);
}

template <class Values>
Eigen::VectorXd scaled(const Values& values, double unit) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    out[static_cast<Eigen::Index>(i)] = static_cast<double>(values[i]) / unit;
  }
  return out;
}

/// As far as ever until it first turns.
Eigen::VectorXd since_turning(const Setup& setup, AxisName axis) {
  std::vector<double> travelled = travel_since_turning(setup, axis);
  double farthest = 0.0;
  for (const double each : travelled) farthest = std::isinf(each) ? farthest : std::max(farthest, each);
  for (double& each : travelled) each = std::min(each, farthest);
  return scaled(travelled, position_unit(axis).si_per_unit);
}

}  // namespace

const std::vector<std::string>& plain_variables() {
  static const std::vector<std::string> kNames = {"t",      "length", "feed",  "tool_length",
                                                  "tool_x", "tool_y", "tool_z"};
  return kNames;
}

bool is_recorded_variable(const std::string& name) {
  if (name.starts_with("T_")) return name.size() > 2;
  if (std::ranges::find(plain_variables(), name) != plain_variables().end()) return true;
  return axis_in(name).has_value();
}

std::vector<std::string> variables_in(const std::string& list) {
  std::istringstream stream(list);
  std::vector<std::string> names;
  for (std::string name; stream >> name;) names.push_back(name);
  return names;
}

std::optional<Eigen::VectorXd> recorded_variable(const SetupView& view, const std::string& name) {
  const Readings& readings = view.setup.readings;
  const auto rows = static_cast<Eigen::Index>(view.rows());
  if (name.starts_with("T_")) {
    const std::vector<double>* values = temperature(readings, name);
    if (values == nullptr) return std::nullopt;
    return scaled(*values, 1.0);
  }
  if (name.starts_with(kSinceTurning)) return since_turning(view.setup, *axis_in(name));
  if (name.starts_with(kDirection)) {
    const auto& direction = readings.direction[index_of(*axis_in(name))];
    if (direction.empty()) return std::nullopt;
    return scaled(direction, 1.0);
  }
  if (const auto axis = axis_of(name)) {
    return scaled(readings.position[index_of(*axis)], position_unit(*axis).si_per_unit);
  }
  if (name == "t") {
    if (readings.time.empty()) return std::nullopt;
    return times(view).array() - clock_start(view);
  }
  if (name == "feed") {
    if (readings.feed.empty()) return std::nullopt;
    return scaled(readings.feed, unit_of_key("feed_mm_min").si_per_unit);
  }
  if (name == "length") return view.length / kMetrePerMillimetre;
  const Eigen::Vector3d offset = view.campaign.machine.tools[view.setup.tool].offset / kMetrePerMillimetre;
  return Eigen::VectorXd::Constant(rows, name == "tool_length" ? offset.norm() : offset[name.back() - 'x']);
}

bool has_variable(const Setup& setup, const std::string& name) {
  const Readings& readings = setup.readings;
  if (name.starts_with("T_")) return temperature(readings, name) != nullptr;
  if (name.starts_with(kDirection)) return !readings.direction[index_of(*axis_in(name))].empty();
  if (name == "t") return !readings.time.empty();
  if (name == "feed") return !readings.feed.empty();
  return true;
}

std::string column_of_variable(const std::string& variable) {
  if (variable.starts_with("T_")) return variable + "_degC";
  if (variable == "t") return "time_s";
  if (variable == "feed") return "feed_mm_min";
  return variable;
}

void check_variable(const Campaign& campaign, const std::string& name,
                    const std::function<bool(const Setup&)>& acts_on, const std::string& what,
                    const std::string& user, const SourcePlace& place) {
  if (const auto axis = axis_in(name)) check_axis(campaign, *axis, what, place);
  for (const Setup& setup : campaign.setups) {
    if (acts_on(setup) && has_variable(setup, name)) return;
  }
  std::string remedy = "add the column " + column_of_variable(name) + " or write another variable";
  if (name.starts_with("T_")) {
    remedy += "; channels of the campaign: " + listed_names(temperature_channels(campaign));
  }
  throw InputError(place, what + ": column " + column_of_variable(name) + " is missing, but " + user, remedy);
}

}  // namespace volcal
