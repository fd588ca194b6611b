#include "volcal/identify/io/results/result_json_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "volcal/identify/text/json_number.h"
#include "volcal/identify/text/text_encoding.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/functions/registry.h"

namespace volcal::json_parts {
namespace {

constexpr int kLargestDegree = 1000;

constexpr std::array<std::pair<ParameterKind, const char*>, 6> kParameterKinds = {{
    {ParameterKind::Location, "location"},
    {ParameterKind::Effect, "effect"},
    {ParameterKind::EffectShape, "effect shape"},
    {ParameterKind::Expansion, "expansion"},
    {ParameterKind::ToolOffset, "tool offset"},
    {ParameterKind::Nuisance, "nuisance"},
}};

constexpr std::array<std::pair<KnotChoice, const char*>, 3> kKnotChoices = {{
    {KnotChoice::Automatic, "auto"},
    {KnotChoice::IntervalCount, "intervals"},
    {KnotChoice::Explicit, "breakpoints"},
}};

template <class Table, class Value>
std::string name_in(const Table& table, Value value) {
  return std::ranges::find(table, value, &Table::value_type::first)->second;
}

template <class Table>
auto value_in(const Table& table, const Json& json) {
  const auto name = json.get<std::string>();
  const auto found = std::ranges::find_if(table, [&](const auto& entry) { return name == entry.second; });
  if (found == table.end()) throw std::invalid_argument("\"" + printable(name) + "\" is not known");
  return found->first;
}

AxisName axis_name(const Json& json) {
  const auto name = json.get<std::string>();
  const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
  if (!axis) throw std::invalid_argument("\"" + printable(name) + "\" is not an axis");
  return *axis;
}

LocationSymbol location_symbol(const Json& json) {
  const auto name = json.get<std::string>();
  const auto symbol = LocationSymbol::parse(name);
  if (!symbol) throw std::invalid_argument("\"" + printable(name) + "\" is not a location error");
  return *symbol;
}

Eigen::Vector3d vector3_from(const Json& json) {
  const Eigen::VectorXd values = vector_from(json);
  if (values.size() != 3) throw std::invalid_argument("a vector of 3 is expected");
  return values;
}

std::vector<double> numbers_from(const Json& json) {
  const Eigen::VectorXd values = vector_from(json);
  return {values.begin(), values.end()};
}

Json numbers(const std::vector<double>& values) {
  return vector(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

Json axis_json(const Axis& axis) {
  Json json = {{"name", std::string(1, letter_of(axis.name))},    {"travel_min", number(axis.travel_min)},
               {"travel_max", number(axis.travel_max)},           {"home", number(axis.home)},
               {"reference_point", vector(axis.reference_point)}, {"centre", vector(axis.centre)}};
  if (axis.endless) json["endless"] = *axis.endless;
  if (axis.expansion) {
    json["expansion"] = {{"per_kelvin", number(axis.expansion->per_kelvin)},
                         {"per_kelvin_sigma", number(axis.expansion->per_kelvin_sigma)},
                         {"channel", axis.expansion->channel}};
  }
  return json;
}

Axis axis_from(const Json& json) {
  Axis axis;
  axis.name = axis_name(json.at("name"));
  axis.travel_min = number(json.at("travel_min"));
  axis.travel_max = number(json.at("travel_max"));
  axis.home = number(json.at("home"));
  axis.reference_point = vector3_from(json.at("reference_point"));
  axis.centre = vector3_from(json.at("centre"));
  if (json.contains("endless")) axis.endless = json.at("endless").get<bool>();
  if (!(axis.travel_min < axis.travel_max)) throw std::invalid_argument("an axis has no travel");
  if (json.contains("expansion")) {
    const Json& expansion = json.at("expansion");
    axis.expansion =
        ScaleExpansion{number(expansion.at("per_kelvin")), number(expansion.at("per_kelvin_sigma")),
                       expansion.at("channel").get<std::string>()};
  }
  return axis;
}

Json function_json(const FunctionSpec& spec) {
  Json json = {{"basis", spec.basis},
               {"degree", spec.degree},
               {"knots", name_in(kKnotChoices, spec.knots)},
               {"intervals", spec.intervals},
               {"breakpoints", numbers(spec.breakpoints)},
               {"coefficients", numbers(spec.coefficients)}};
  if (spec.automatic_degree) json["automatic_degree"] = true;
  if (spec.smoothed) json["smoothed"] = true;
  return json;
}

FunctionSpec function_from(const Json& json) {
  FunctionSpec spec;
  spec.basis = json.at("basis").get<std::string>();
  spec.degree = json.at("degree").get<int>();
  spec.automatic_degree = json.value("automatic_degree", false);
  spec.smoothed = json.value("smoothed", false);
  spec.knots = value_in(kKnotChoices, json.at("knots"));
  spec.intervals = json.at("intervals").get<int>();
  spec.breakpoints = numbers_from(json.at("breakpoints"));
  spec.coefficients = numbers_from(json.at("coefficients"));
  if (!find_basis(spec.basis))
    throw std::invalid_argument("basis \"" + printable(spec.basis) + "\" is not known");
  if (spec.degree < -kLargestDegree || spec.degree > kLargestDegree)
    throw std::invalid_argument("a degree is out of range");
  return spec;
}

Json option_json(const OptionValue& value) {
  if (const auto* scalar = std::get_if<double>(&value)) return number(*scalar);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    Json numbers = Json::array();
    for (const double each : *list) numbers.push_back(number(each));
    return {{"numbers", numbers}};
  }
  return vector(std::get<Eigen::Vector3d>(value));
}

OptionValue option_from(const Json& json) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_array()) return vector3_from(json);
  if (json.is_object()) {
    const Eigen::VectorXd numbers = vector_from(json.at("numbers"));
    return std::vector<double>(numbers.begin(), numbers.end());
  }
  return number(json);
}

Json block_json(const ParameterBlock& block) {
  Json json = {{"kind", name_in(kParameterKinds, block.kind)},
               {"name", block.name},
               {"labels", block.labels},
               {"units", block.units},
               {"si_per_unit", numbers(block.si_per_unit)},
               {"offset", block.offset},
               {"guess", vector(block.guess)},
               {"prior_mean", vector(block.prior_mean)},
               {"prior_sigma", vector(block.prior_sigma)},
               {"weak_default_prior", block.weak_default_prior}};
  if (block.location) json["location"] = block.location->name();
  if (block.is_held) json["is_held"] = true;
  return json;
}

ParameterBlock block_from(const Json& json) {
  ParameterBlock block;
  block.kind = value_in(kParameterKinds, json.at("kind"));
  block.name = json.at("name").get<std::string>();
  block.labels = json.at("labels").get<std::vector<std::string>>();
  block.units = json.at("units").get<std::vector<std::string>>();
  block.si_per_unit = numbers_from(json.at("si_per_unit"));
  block.offset = json.at("offset").get<int>();
  block.guess = vector_from(json.at("guess"));
  block.prior_mean = vector_from(json.at("prior_mean"));
  block.prior_sigma = vector_from(json.at("prior_sigma"));
  block.weak_default_prior = json.at("weak_default_prior").get<bool>();
  if (json.contains("location")) block.location = location_symbol(json.at("location"));
  block.is_held = json.value("is_held", false);
  const std::size_t size = block.labels.size();
  const auto count = static_cast<Eigen::Index>(size);
  if (block.units.size() != size || block.si_per_unit.size() != size || block.guess.size() != count ||
      block.prior_mean.size() != count || block.prior_sigma.size() != count) {
    throw std::invalid_argument("block \"" + printable(block.name) + "\" has lists of different length");
  }
  return block;
}

FunctionGroup group_from(const Json& json, const Machine& machine, const ModelSpec& spec) {
  FunctionGroup group;
  group.axis = axis_name(json.at("axis"));
  group.offset = json.at("offset").get<int>();
  for (const Json& symbol : json.at("symbols")) group.symbols.push_back(error_symbol(symbol));
  if (group.symbols.empty()) throw std::invalid_argument("a group has no functions");
  const FunctionSpec& function = spec.function(group.symbols.front());
  group.basis = find_basis(function.basis)->make(function, machine.axis(group.axis));
  return group;
}

void require_inside(long offset, long count, const ParameterLayout& layout) {
  if (offset < 0 || count < 0 || offset + count > layout.size)
    throw std::invalid_argument("the layout has a hole");
}

}  // namespace

void require_no_control(const Json& json) {
  const auto check = [](std::string text) {
    std::erase(text, '\n');
    if (holds_control(text))
      throw std::invalid_argument("the text \"" + text + "\" holds a control character");
  };
  if (json.is_string()) check(json.get<std::string>());
  if (!json.is_structured()) return;
  for (const auto& [key, value] : json.items()) {
    if (json.is_object()) check(key);
    if (!value.is_number()) require_no_control(value);
  }
}

Json number(double value) { return number_json(value); }

double number(const Json& json) { return number_from(json); }

Json vector(const Eigen::Ref<const Eigen::VectorXd>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(number(value));
  return json;
}

Eigen::VectorXd vector_from(const Json& json) {
  if (!json.is_array()) throw std::invalid_argument("a list of numbers is expected");
  Eigen::VectorXd values(static_cast<Eigen::Index>(json.size()));
  for (std::size_t i = 0; i < json.size(); ++i) values[static_cast<Eigen::Index>(i)] = number(json[i]);
  return values;
}

ErrorSymbol error_symbol(const Json& json) {
  const auto name = json.get<std::string>();
  const auto symbol = ErrorSymbol::parse(name);
  if (!symbol) throw std::invalid_argument("\"" + printable(name) + "\" is not an error motion");
  return *symbol;
}

Json effect(const EffectSpec& effect) {
  Json options = Json::array();
  for (const auto& [key, value] : effect.options.all()) {
    options.push_back({{"key", key.first}, {"value", option_json(value)}});
  }
  return {{"kind", effect.kind}, {"options", options}};
}

EffectSpec effect_from(const Json& json) {
  EffectSpec effect;
  effect.kind = json.at("kind").get<std::string>();
  for (const Json& option : json.at("options")) {
    effect.options.set(option.at("key").get<std::string>(), option_from(option.at("value")));
  }
  return effect;
}

Json machine(const Machine& machine) {
  Json axes = Json::array();
  for (const Axis& axis : machine.axes) axes.push_back(axis_json(axis));
  Json tools = Json::array();
  for (const Tool& tool : machine.tools) {
    tools.push_back(
        {{"name", tool.name}, {"offset", vector(tool.offset)}, {"offset_sigma", number(tool.offset_sigma)}});
  }
  return {{"name", machine.name},
          {"file", machine.file},
          {"structure", machine.structure.code},
          {"datum",
           {std::string(1, letter_of(machine.datum.primary)),
            std::string(1, letter_of(machine.datum.secondary))}},
          {"axes", axes},
          {"tools", tools}};
}

Machine machine_from(const Json& json) {
  Machine machine;
  machine.name = json.at("name").get<std::string>();
  machine.file = json.at("file").get<std::string>();
  machine.structure = Structure::parse(json.at("structure").get<std::string>());
  machine.datum = {axis_name(json.at("datum").at(0)), axis_name(json.at("datum").at(1))};
  for (const Json& axis : json.at("axes")) machine.axes.push_back(axis_from(axis));
  for (const Json& tool : json.at("tools")) {
    machine.tools.push_back({tool.at("name").get<std::string>(), vector3_from(tool.at("offset")),
                             number(tool.at("offset_sigma"))});
  }
  const auto same_axis = [](const Joint& joint, const Axis& axis) { return joint.axis == axis.name; };
  if (!std::ranges::equal(machine.structure.joints, machine.axes, same_axis)) {
    throw std::invalid_argument("the axes do not fit the structure");
  }
  return machine;
}

Json model(const ModelSpec& spec) {
  Json functions = Json::object();
  for (const auto& [symbol, function] : spec.functions) functions[symbol.name()] = function_json(function);
  Json locations = Json::object();
  for (const auto& [symbol, value] : spec.locations) locations[symbol.name()] = number(value);
  Json off = Json::array();
  for (const LocationSymbol& symbol : spec.locations_off) off.push_back(symbol.name());
  Json effects = Json::array();
  for (const EffectSpec& each : spec.effects) effects.push_back(effect(each));
  Json json = {{"file", spec.file},      {"default_function", function_json(spec.default_function)},
               {"functions", functions}, {"locations", locations},
               {"locations_off", off},   {"effects", effects}};
  const auto add_prior = [&json](const char* key, const std::optional<double>& width) {
    if (width) json["priors"][key] = number(*width);
  };
  add_prior("displacement", spec.priors.displacement);
  add_prior("rotation", spec.priors.rotation);
  add_prior("squareness", spec.priors.squareness);
  for (const auto& [tool, error] : spec.tool_errors) json["tool_errors"][tool] = vector(error);
  for (const auto& [axis, per_kelvin] : spec.expansions)
    json["expansions"][std::string(1, letter_of(axis))] = number(per_kelvin);
  return json;
}

ModelSpec model_from(const Json& json) {
  ModelSpec spec;
  spec.file = json.at("file").get<std::string>();
  spec.default_function = function_from(json.at("default_function"));
  for (const auto& [name, function] : json.at("functions").items()) {
    spec.functions[error_symbol(name)] = function_from(function);
  }
  for (const auto& [name, value] : json.at("locations").items()) {
    spec.locations[location_symbol(name)] = number(value);
  }
  for (const Json& name : json.at("locations_off")) spec.locations_off.push_back(location_symbol(name));
  for (const Json& effect : json.at("effects")) spec.effects.push_back(effect_from(effect));
  if (json.contains("tool_errors")) {
    for (const auto& [tool, error] : json.at("tool_errors").items())
      spec.tool_errors[tool] = vector3_from(error);
  }
  if (json.contains("expansions")) {
    for (const auto& [axis, per_kelvin] : json.at("expansions").items())
      spec.expansions[axis_name(axis)] = number(per_kelvin);
  }
  if (!json.contains("priors")) return spec;
  const Json& priors = json.at("priors");
  const auto width = [&priors](const char* key) {
    return priors.contains(key) ? std::optional(number(priors.at(key))) : std::nullopt;
  };
  spec.priors = {width("displacement"), width("rotation"), width("squareness")};
  return spec;
}

Json layout(const ParameterLayout& layout) {
  Json groups = Json::array();
  for (const FunctionGroup& group : layout.groups) {
    Json symbols = Json::array();
    for (const ErrorSymbol& symbol : group.symbols) symbols.push_back(symbol.name());
    groups.push_back(
        {{"axis", std::string(1, letter_of(group.axis))}, {"symbols", symbols}, {"offset", group.offset}});
  }
  Json blocks = Json::array();
  for (const ParameterBlock& block : layout.blocks) blocks.push_back(block_json(block));
  return {
      {"size", layout.size}, {"function_size", layout.function_size}, {"groups", groups}, {"blocks", blocks}};
}

ParameterLayout layout_from(const Json& json, const Machine& machine, const ModelSpec& spec) {
  ParameterLayout layout;
  layout.size = json.at("size").get<int>();
  layout.function_size = json.at("function_size").get<int>();
  require_inside(0, layout.function_size, layout);
  for (const Json& group : json.at("groups")) {
    layout.groups.push_back(group_from(group, machine, spec));
    require_inside(layout.groups.back().offset, layout.groups.back().size(), layout);
  }
  for (const Json& block : json.at("blocks")) {
    layout.blocks.push_back(block_from(block));
    require_inside(layout.blocks.back().offset, layout.blocks.back().size(), layout);
  }
  return layout;
}

std::string covariance_text(const Eigen::MatrixXd& covariance) {
  std::string text = "[";
  for (Eigen::Index row = 0; row < covariance.rows(); ++row) {
    const Eigen::VectorXd lower = covariance.row(row).head(row + 1);
    text += (row ? ",\n  " : "\n  ") + vector(lower).dump();
  }
  return text + "]";
}

Eigen::MatrixXd covariance_from(const Json& json) {
  const auto size = static_cast<Eigen::Index>(json.size());
  if (!json.is_array()) throw std::invalid_argument("the covariance is not a list");
  for (std::size_t row = 0; row < json.size(); ++row) {
    if (!json[row].is_array() || json[row].size() != row + 1)
      throw std::invalid_argument("the covariance is cut off");
  }
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    const Json& lower = json[static_cast<std::size_t>(row)];
    for (Eigen::Index column = 0; column <= row; ++column) {
      covariance(row, column) = covariance(column, row) = number(lower[static_cast<std::size_t>(column)]);
    }
  }
  return covariance;
}

}  // namespace volcal::json_parts
