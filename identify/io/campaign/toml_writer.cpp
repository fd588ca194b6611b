#include "volcal/identify/io/campaign/toml_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <sstream>

#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

template <class Range>
std::string array(const Range& values, double si_per_unit) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + edge_number(value, si_per_unit);
  return text + "]";
}

std::string key_text(const std::string& key) {
  const auto bare = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  return !key.empty() && std::ranges::all_of(key, bare) ? key : toml_text(key);
}

std::string axis_toml(const Axis& axis) {
  const bool rotary = is_rotary(axis.name);
  const auto [unit, factor] = position_unit(axis.name);
  std::string text = fmt::format("\n[axes.{}]\n", letter_of(axis.name));
  text += fmt::format("travel_{} = {}\n", unit, array(std::array{axis.travel_min, axis.travel_max}, factor));
  text += fmt::format("home_{} = {}\n", unit, edge_number(axis.home, factor));
  if (!rotary) text += "reference_point_mm = " + array(axis.reference_point, kMetrePerMillimetre) + "\n";
  if (rotary && !axis.centre_is_assumed)
    text += "centre_mm = " + array(axis.centre, kMetrePerMillimetre) + "\n";
  if (axis.endless) text += fmt::format("endless = {}\n", *axis.endless);
  if (axis.expansion) {
    text += fmt::format("expansion_um_per_m_K = {}\nexpansion_sigma_um_per_m_K = {}\ntemperature = {}\n",
                        edge_number(axis.expansion->per_kelvin, kMicro),
                        edge_number(axis.expansion->per_kelvin_sigma, kMicro),
                        toml_text(axis.expansion->channel));
  }
  return text;
}

std::string knots_toml(const FunctionSpec& spec, std::optional<AxisName> axis) {
  switch (spec.knots) {
    case KnotChoice::Automatic:
      return ", knots = \"auto\"";
    case KnotChoice::IntervalCount:
      return fmt::format(", knots = {}", spec.intervals);
    case KnotChoice::Explicit:
      break;
  }
  const Unit unit = position_unit(axis.value_or(AxisName::X));
  return fmt::format(", knots_{} = {}", unit.suffix, array(spec.breakpoints, unit.si_per_unit));
}

std::string function_toml(const FunctionSpec& spec, std::optional<ErrorSymbol> symbol) {
  const BasisKind* kind = find_basis(spec.basis);
  std::string text = "{ basis = " + toml_text(spec.basis);
  if (spec.automatic_degree) {
    text += ", degree = \"auto\"";
  } else if (kind && kind->degree_max > 0) {
    text += fmt::format(", degree = {}", spec.degree);
  }
  if (kind && kind->uses_knots) text += knots_toml(spec, symbol ? std::optional(symbol->axis) : std::nullopt);
  if (symbol && !spec.coefficients.empty()) {
    text +=
        fmt::format(", coefficients_{} = {}", edge_unit(symbol->component), array(spec.coefficients, kMicro));
  }
  if (spec.smoothed) text += ", smoothed = true";
  return text + " }";
}

/// Two keys of an effect may share a stem (amplitude_um, amplitude_urad): the one that the effect names as
/// its amplitude's counts.
bool key_applies(const KeySchema& key, const EffectSchema& schema, const Effect& effect) {
  const auto shares = [&](const KeySchema& other) {
    return other.type == key.type && stem_of_key(other.key) == stem_of_key(key.key);
  };
  if (std::ranges::count_if(schema.keys, shares) < 2) return true;
  return std::ranges::find(effect.amplitudes(), key.key, &EffectAmplitude::key) != effect.amplitudes().end();
}

std::string priors_toml(const PriorWidths& priors) {
  std::string text;
  const auto add = [&text](const char* key, const std::optional<double>& width, double si_per_unit) {
    if (!width) return;
    text +=
        fmt::format("{}{} = {}\n", text.empty() ? "\n[priors]\n" : "", key, edge_number(*width, si_per_unit));
  };
  add("displacement_um", priors.displacement, kMicro);
  add("rotation_urad", priors.rotation, kMicro);
  add("squareness_mrad", priors.squareness, kRadianPerMilliradian);
  return text;
}

std::string measured_toml(const ModelSpec& spec) {
  std::string text;
  for (const auto& [axis, ends] : spec.measured) {
    const Unit unit = position_unit(axis);
    text += fmt::format("{}_{} = {}\n", letter_of(axis), unit.suffix,
                        array(std::vector<double>{ends.first, ends.second}, unit.si_per_unit));
  }
  const auto add = [&text](const Variable& variable, const RecordedRange& range) {
    const std::string column = variable.column();
    const bool plain = channel_variable(column) == "T_" + column;
    text += fmt::format(
        "{} = {}  # least, mean, greatest\n", plain ? column : toml_text(column),
        array(std::vector<double>{range.min, range.mean, range.max}, unit_of_key(column).si_per_unit));
  };
  for (const auto& [channel, range] : spec.conditions.temperature_degC) add(temperature_of(channel), range);
  if (spec.conditions.time) add({Variable::Kind::Time}, *spec.conditions.time);
  if (spec.conditions.feed) add({Variable::Kind::Feed}, *spec.conditions.feed);
  return text.empty() ? text : "\n[measured]\n" + text;
}

std::string axes_toml(const ModelSpec& spec) {
  std::string text;
  for (const auto& [axis, per_kelvin] : spec.expansions)
    text += fmt::format("\n[axes.{}]\nexpansion_um_per_m_K = {}\n", letter_of(axis),
                        edge_number(per_kelvin, kMicro));
  return text;
}

std::string tools_toml(const ModelSpec& spec) {
  std::string text;
  for (const auto& [tool, error] : spec.tool_errors)
    text += fmt::format("\n[tools.{}]\noffset_error_um = {}\n", key_text(tool),
                        array(error, kMetrePerMicrometre));
  return text;
}

}  // namespace

std::string effect_toml(const EffectSpec& effect) {
  std::string text = "\n[[effects]]\nkind = " + toml_text(effect.kind) + "\n";
  const EffectKind* kind = find_effect(effect.kind);
  if (!kind) return text;
  const std::unique_ptr<Effect> made = kind->make(effect, {});
  for (const KeySchema& key : kind->schema().keys) {
    if (!key_applies(key, kind->schema(), *made)) continue;
    const std::string stem(stem_of_key(key.key));
    const double factor = unit_of_key(key.key).si_per_unit;
    std::optional<std::string> value;
    if (const auto number = effect.options.number(stem); number && key.type == KeyType::Number) {
      const bool is_none = std::abs(*number) < key.plausible_min * factor;  // the reader believes 0 instead
      value = edge_number(is_none ? 0.0 : *number, factor);
    } else if (const auto words = effect.options.text(stem); words && key.type == KeyType::Text) {
      value = toml_text(*words);
    } else if (const auto flag = effect.options.boolean(stem); flag && key.type == KeyType::Boolean) {
      value = *flag ? "true" : "false";
    } else if (const auto vector = effect.options.vector(stem); vector && key.type == KeyType::Vector3) {
      value = array(*vector, factor);
    } else if (const auto list = effect.options.numbers(stem); list && key.type == KeyType::Numbers) {
      value = array(*list, factor);
    }
    if (value) text += key.key + " = " + *value + "\n";
  }
  return text;
}

std::string edge_number(double si, double si_per_unit) {
  const double edge = si / si_per_unit;
  for (int digits = 6; digits < 17; ++digits) {
    std::string text = fmt::format("{:.{}g}", edge, digits);
    const double read = std::strtod(text.c_str(), nullptr) * si_per_unit;
    if (std::abs(read - si) <= std::numeric_limits<double>::epsilon() * std::abs(si)) return text;
  }
  return fmt::format("{:.17g}", edge);
}

std::string toml_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : utf8_text(text)) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string machine_toml(const Machine& machine) {
  std::string text = fmt::format("format = \"{}\"\nname = {}\nstructure = {}\n", kMachineFormat,
                                 toml_text(machine.name), toml_text(machine.structure.code));
  text += fmt::format("\n[datum]\nprimary = \"{}\"\nsecondary = \"{}\"\n", letter_of(machine.datum.primary),
                      letter_of(machine.datum.secondary));
  for (const Axis& axis : machine.axes) text += axis_toml(axis);
  for (const Tool& tool : machine.tools) {
    text += fmt::format("\n[tools.{}]\noffset_mm = {}\n", key_text(tool.name),
                        array(tool.offset, kMetrePerMillimetre));
    if (tool.offset_sigma > 0.0) {
      text += fmt::format("offset_sigma_um = {}\n", edge_number(tool.offset_sigma, kMetrePerMicrometre));
    }
  }
  return text;
}

std::string model_toml(const ModelSpec& spec, const std::string& machine_path, const std::string& comment) {
  std::string text;
  std::istringstream lines(utf8_text(comment));
  for (std::string line; std::getline(lines, line);) {
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
    std::ranges::replace_if(line, is_control, '?');
    text += "# " + line + "\n";
  }
  text += fmt::format("format = \"{}\"\nmachine = {}\n\n[functions]\ndefault = {}\n", kModelFormat,
                      toml_text(machine_path), function_toml(spec.default_function, std::nullopt));
  for (const auto& [symbol, function] : spec.functions) {
    text += symbol.name() + " = " + function_toml(function, symbol) + "\n";
  }
  if (!spec.locations.empty() || !spec.locations_off.empty()) text += "\n[locations]\n";
  for (const auto& [symbol, value] : spec.locations) {
    text +=
        fmt::format("{}_{} = {}\n", symbol.name(), edge_unit(symbol.component), edge_number(value, kMicro));
  }
  for (const LocationSymbol& symbol : spec.locations_off) text += symbol.name() + " = \"zero\"\n";
  text += priors_toml(spec.priors) + measured_toml(spec) + axes_toml(spec) + tools_toml(spec);
  for (const EffectSpec& effect : spec.effects) text += effect_toml(effect);
  return text;
}

}  // namespace volcal
