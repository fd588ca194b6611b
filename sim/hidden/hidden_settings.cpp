#include "volcal/sim/hidden/hidden_settings.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "volcal/model/description/variable.h"
#include "volcal/sim/measurement/instruments.h"

namespace volcal::sim {
namespace {

template <class Names>
std::string joined(const Names& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? "none" : all;
}

std::string station_of(const SetupPlan& plan) { return plan.options.text("station").value_or(""); }

}  // namespace

InputError HiddenSettings::error(const std::string& problem, const std::string& remedy) const {
  return {effect_.place, role_ + effect_.kind + ": " + problem, remedy};
}

void HiddenSettings::fail(const std::string& problem, const std::string& remedy) const {
  throw error(problem, remedy);
}

double HiddenSettings::number(const std::string& stem, double otherwise) const {
  return effect_.options.number(stem).value_or(otherwise);
}

double HiddenSettings::number(const std::string& stem) const {
  const auto value = effect_.options.number(stem);
  if (!value) fail("\"" + stem + "\" is missing", "state it");
  return *value;
}

double HiddenSettings::positive(const std::string& stem) const {
  const double value = number(stem);
  if (!(value > 0.0)) fail("\"" + stem + "\" is not positive", "give a number above 0");
  return value;
}

double HiddenSettings::positive(const std::string& stem, double otherwise) const {
  return has(stem) ? positive(stem) : otherwise;
}

int HiddenSettings::power() const {
  const double value = number("power", 1.0);
  if (value != 1.0 && value != 2.0 && value != 3.0) fail("\"power\" is not 1, 2 or 3", "choose one of them");
  return static_cast<int>(value);
}

Eigen::Vector3d HiddenSettings::vector(const std::string& stem, const Eigen::Vector3d& otherwise) const {
  return effect_.options.vector(stem).value_or(otherwise);
}

Eigen::Vector3d HiddenSettings::direction(const Eigen::Vector3d& otherwise) const {
  const Eigen::Vector3d given = vector("direction", otherwise);
  if (given.norm() == 0.0) fail("\"direction\" is zero", "give a vector such as [0, 0, -1]");
  return given.normalized();
}

std::string HiddenSettings::text(const std::string& stem, const std::string& otherwise) const {
  return effect_.options.text(stem).value_or(otherwise);
}

std::string HiddenSettings::required_text(const std::string& stem) const {
  const auto value = effect_.options.text(stem);
  if (!value) fail("\"" + stem + "\" is missing", "state it");
  return *value;
}

std::vector<double> HiddenSettings::numbers(const std::string& stem) const {
  return effect_.options.numbers(stem).value_or(std::vector<double>{});
}

ErrorSymbol HiddenSettings::symbol() const {
  const std::string name = required_text("symbol");
  const auto symbol = ErrorSymbol::parse(name);
  if (!symbol || !context_.machine.has_axis(symbol->axis)) {
    fail("\"" + name + "\" is not an error motion of this machine",
         "write a symbol of ISO 230-1, such as EXX");
  }
  return *symbol;
}

LocationSymbol HiddenSettings::location_symbol() const {
  const std::string name = required_text("symbol");
  const auto symbol = LocationSymbol::parse(name);
  const auto squareness = context_.machine.datum.squareness();
  const bool known = symbol && context_.machine.has_axis(symbol->axis) &&
                     (is_rotary(symbol->axis) || std::ranges::find(squareness, *symbol) != squareness.end());
  if (known) return *symbol;
  std::vector<std::string> names;
  names.reserve(squareness.size());
  for (const LocationSymbol& each : squareness) names.push_back(each.name());
  fail("\"" + name + "\" is not a location error of this machine",
       "with this datum there are " + joined(names));
}

AxisName HiddenSettings::axis(const std::string& stem) const {
  const std::string name = required_text(stem);
  const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
  if (!axis || !context_.machine.has_axis(*axis)) {
    fail("\"" + name + "\" is not an axis of this machine", "name one of its axes");
  }
  return *axis;
}

AxisName HiddenSettings::linear_axis(const std::string& stem) const {
  const AxisName name = axis(stem);
  if (is_rotary(name)) fail(std::string("axis ") + letter_of(name) + " is rotary", "use X, Y or Z");
  return name;
}

std::vector<AxisName> HiddenSettings::linear_axes(const std::string& stem) const {
  std::istringstream words(required_text(stem));
  std::vector<AxisName> axes;
  for (std::string word; words >> word;) {
    const auto name = word.size() == 1 ? axis_from_letter(word[0]) : std::nullopt;
    if (!name || is_rotary(*name) || !context_.machine.has_axis(*name))
      fail("\"" + word + "\" is not a linear axis of the machine", "write \"X Y Z\"");
    if (std::ranges::find(axes, *name) != axes.end()) fail("it names " + word + " twice", "write \"X Y Z\"");
    axes.push_back(*name);
  }
  if (axes.size() < 2) fail("one cause in several places needs two axes or more", "write \"X Y Z\"");
  return axes;
}

AxisName HiddenSettings::other_axis(const std::string& stem) const {
  const AxisName name = axis(stem);
  if (name == symbol().axis) {
    fail(symbol().name() + " depends on " + letter_of(name) + " as it is", "name another axis");
  }
  return name;
}

std::size_t HiddenSettings::tool() const {
  const std::string name = required_text("tool");
  const auto index = context_.machine.tool_index(name);
  if (!index) fail("there is no tool \"" + name + "\"", "use a tool of the machine file");
  return *index;
}

StateNumber HiddenSettings::position(AxisName axis) const {
  return [k = index_of(axis)](const MachineState& state) { return state.position[k]; };
}

StateNumber HiddenSettings::share(AxisName axis) const {
  const Axis& described = context_.machine.axis(axis);
  return [k = index_of(axis), home = described.home, travel = described.travel()](const MachineState& state) {
    return (state.position[k] - home) / travel;
  };
}

StateNumber HiddenSettings::share_or_one(const std::string& stem) const {
  if (has(stem)) return share(axis(stem));
  return [](const MachineState&) { return 1.0; };
}

const TemperatureChannel& HiddenSettings::channel(const std::string& stem) const {
  const std::string name = required_text(stem);
  const auto& channels = context_.environment.channels;
  const auto found = std::ranges::find(channels, name, &TemperatureChannel::name);
  if (found != channels.end()) return *found;
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const TemperatureChannel& each : channels) names.push_back(each.name);
  fail("the study does not simulate the temperature \"" + name + "\"",
       "add a [[temperatures]] table, or use one of: " + joined(names));
}

StateNumber HiddenSettings::excess_temperature(const std::string& stem) const {
  return [name = channel(stem).name](const MachineState& state) {
    const auto found = state.temperature.find(name);
    if (found == state.temperature.end()) throw std::invalid_argument("no temperature of channel " + name);
    return found->second - kReferenceTemperature;
  };
}

StateNumber HiddenSettings::written_temperature(const std::string& written) const {
  for (const TemperatureChannel& channel : context_.environment.channels) {
    if (channel_variable(channel.name) != written) continue;
    return [name = channel.name](const MachineState& state) { return state.temperature.at(name); };
  }
  fail("the study does not simulate the temperature " + written, "add a [[temperatures]] table");
}

OccasionTest HiddenSettings::at_station(const std::string& station) const {
  const bool exists =
      std::ranges::any_of(context_.plans, [&](const SetupPlan& plan) { return station_of(plan) == station; });
  if (!exists) fail("no setup has the station \"" + station + "\"", "use a name that the campaign will have");
  return [station](const Occasion& occasion) { return station_of(occasion.plan) == station; };
}

OccasionTest HiddenSettings::at_setup(const std::string& setup) const {
  if (std::ranges::find(context_.plans, setup, &SetupPlan::name) == context_.plans.end())
    fail("there is no setup \"" + setup + "\"", "use a name that the campaign will have");
  return [setup](const Occasion& occasion) { return occasion.plan.name == setup; };
}

ReadingTest HiddenSettings::of_column(const std::string& column, const std::string& setup) const {
  constexpr std::size_t kMostChannels = 3;
  const auto reads = [column, setup](const SetupPlan& plan, std::size_t channel) {
    return (setup.empty() || plan.name == setup) && column_read(plan, channel) == column;
  };
  if (!setup.empty()) at_setup(setup);
  const bool exists = std::ranges::any_of(context_.plans, [&](const SetupPlan& plan) {
    bool found = false;
    for (std::size_t channel = 0; channel < kMostChannels; ++channel) found |= reads(plan, channel);
    return found;
  });
  if (!exists)
    fail("\"" + column + "\" is not a column that is read there",
         "name an error motion, \"tool x\", \"station NAME x\" or a column of the readings");
  return [reads](const Occasion& occasion, std::size_t channel) { return reads(occasion.plan, channel); };
}

OccasionTest HiddenSettings::where() const {
  const std::string setup = text("setup", "");
  const std::string station = text("station", "");
  if (!setup.empty()) at_setup(setup);
  if (!station.empty()) at_station(station);
  return [setup, station](const Occasion& occasion) {
    return (setup.empty() || occasion.plan.name == setup) &&
           (station.empty() || station_of(occasion.plan) == station);
  };
}

Eigen::Vector3d HiddenSettings::middle_of_travel() const {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Axis& axis : context_.machine.axes) {
    if (!is_rotary(axis.name)) middle[direction_of(axis.name)] = 0.5 * (axis.travel_min + axis.travel_max);
  }
  return middle;
}

double hours(const MachineState& state) { return state.time / 3600.0; }

ErrorSymbol positioning_of(AxisName axis) { return {positioning_component(axis), axis}; }

KeySchema symbol_key() { return {"symbol", KeyType::Text, true, "error motion, such as EXX"}; }

KeySchema axis_key(const std::string& key, const std::string& help, bool required) {
  return {key, KeyType::Text, required, help, {"X", "Y", "Z", "A", "B", "C"}};
}

KeySchema text_key(const std::string& key, const std::string& help, bool required) {
  return {key, KeyType::Text, required, help};
}

KeySchema number_key(const std::string& key, const std::string& help, bool required) {
  return {key, KeyType::Number, required, help};
}

KeySchema vector_key(const std::string& key, const std::string& help, bool required) {
  return {key, KeyType::Vector3, required, help};
}

std::vector<KeySchema> place_keys() {
  return {text_key("setup", "this setup only", false),
          text_key("station", "setups at this station only", false)};
}

}  // namespace volcal::sim
