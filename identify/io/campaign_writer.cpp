#include "volcal/identify/io/campaign_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

const InstrumentSchema& schema_of(const Setup& setup) {
  const Instrument* instrument = find_instrument(setup.instrument);
  if (!instrument) throw std::invalid_argument("instrument " + setup.instrument + " is not registered");
  return instrument->schema();
}

/// Decimals that resolve 0.1 nm or 0.1 nrad in a column's unit.
int decimals_of(const std::string& column) {
  const std::string_view unit = unit_of_key(column).suffix;
  if (unit == "deg") return 10;
  if (unit == "mm") return 7;
  if (unit == "um" || unit == "urad" || unit == "s" || unit == "degC" || unit == "mm_min") return 4;
  return 10;
}

ReadingColumn measured_column(const std::string& name, const std::vector<double>& values) {
  return {name, unit_of_key(name).si_per_unit, decimals_of(name), values};
}

template <class Integer>
ReadingColumn integer_column(const std::string& name, const std::vector<Integer>& values) {
  return {name, 1.0, 0, std::vector<double>(values.begin(), values.end())};
}

/// Fixed decimals without the zeros at their end.
void append_number(double value, int decimals, std::string& text) {
  std::string number = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
  }
  text += number == "-0" ? "0" : number;
}

template <class Range>
std::string list_text(const Range& values, double si_per_unit) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + edge_number(value, si_per_unit);
  return "[" + text + "]";
}

/// One `key = value` of a schema; empty when the options do not hold it.
std::string option_toml(const KeySchema& key, const Options& options) {
  const std::string stem(stem_of_key(key.key));
  const double factor = unit_of_key(key.key).si_per_unit;
  switch (key.type) {
    case KeyType::Number:
      if (const auto value = options.number(stem)) return key.key + " = " + edge_number(*value, factor);
      break;
    case KeyType::Vector3:
      if (const auto value = options.vector(stem)) return key.key + " = " + list_text(*value, factor);
      break;
    case KeyType::Numbers:
      if (const auto value = options.numbers(stem)) return key.key + " = " + list_text(*value, factor);
      break;
    case KeyType::Text:
      if (const auto value = options.text(stem)) return key.key + " = " + toml_text(*value);
      break;
    case KeyType::Boolean:
      if (const auto value = options.boolean(stem)) return key.key + (*value ? " = true" : " = false");
      break;
  }
  return {};
}

std::string noise_toml(const Setup& setup, const InstrumentSchema& schema) {
  std::string inside;
  for (const KeySchema& key : schema.noise_keys) {
    const std::string entry = option_toml(key, setup.noise);
    if (!entry.empty()) inside += (inside.empty() ? "" : ", ") + entry;
  }
  return inside.empty() ? "" : "noise = { " + inside + " }\n";
}

/// One entry per reason and column.
std::string leave_out_toml(const Setup& setup, const InstrumentSchema& schema) {
  if (setup.left_out.empty()) return {};
  constexpr std::size_t kHeaderLines = 1;
  std::map<std::pair<std::string, std::size_t>, std::string> rows;
  for (const LeftOutReading& reading : setup.left_out) {
    std::string& list = rows[{reading.reason, reading.channel}];
    list += (list.empty() ? "" : ", ") + std::to_string(reading.row + 1 + kHeaderLines);
  }
  std::string text;
  for (const auto& [entry, list] : rows) {
    const auto& [reason, channel] = entry;
    const std::string& column = schema.column_sets.at(setup.readings.column_set).at(channel).column;
    text += fmt::format("{}{{ rows = [{}], columns = [{}], reason = {} }}", text.empty() ? "" : ", ", list,
                        toml_text(column), toml_text(reason));
  }
  return "leave_out = [" + text + "]\n";
}

bool records_directions(const Setup& setup) {
  return std::ranges::any_of(setup.readings.direction, [](const auto& column) { return !column.empty(); });
}

std::string setup_toml(const Setup& setup, const Machine& machine) {
  const InstrumentSchema& schema = schema_of(setup);
  std::string text = "\n[[setups]]\n";
  text += "name = " + toml_text(setup.name) + "\n";
  text += "instrument = " + toml_text(setup.instrument) + "\n";
  text += "data = " + toml_text(readings_file_name(setup)) + "\n";
  text += "tool = " + toml_text(machine.tools.at(setup.tool).name) + "\n";
  for (const KeySchema& key : schema.keys) {
    const std::string entry = option_toml(key, setup.options);
    if (!entry.empty()) text += entry + "\n";
  }
  if (setup.has_noise) text += noise_toml(setup, schema);
  text += leave_out_toml(setup, schema);
  return text + "repeatability_um = " + edge_number(setup.repeatability, kMetrePerMicrometre) + "\n";
}

}  // namespace

std::vector<ReadingColumn> reading_columns(const Setup& setup, const Machine& machine) {
  const Readings& readings = setup.readings;
  const InstrumentSchema& schema = schema_of(setup);
  std::vector<ReadingColumn> columns;
  if (!readings.time.empty()) columns.push_back(measured_column("time_s", readings.time));
  if (!readings.line.empty()) columns.push_back(integer_column("line", readings.line));
  if (!readings.run.empty()) columns.push_back(integer_column("run", readings.run));
  for (const Axis& axis : machine.axes) {
    columns.push_back(measured_column(position_column(axis.name), readings.position[index_of(axis.name)]));
  }
  for (const Axis& axis : machine.axes) {
    const auto& direction = readings.direction[index_of(axis.name)];
    if (!direction.empty())
      columns.push_back(integer_column(direction_of_approach(axis.name).column(), direction));
  }
  if (!readings.feed.empty()) columns.push_back(measured_column("feed_mm_min", readings.feed));
  for (const auto& [channel, values] : readings.temperature) {
    columns.push_back(measured_column(temperature_of(channel).column(), values));
  }
  if (!readings.sigma.empty()) columns.push_back(measured_column(sigma_column(schema), readings.sigma));
  const auto& set = schema.column_sets.at(readings.column_set);
  for (std::size_t k = 0; k < set.size(); ++k) {
    if (!set[k].derived) columns.push_back(measured_column(set[k].column, readings.value.at(k)));
  }
  const auto& given = schema.given_of(readings.column_set);
  for (std::size_t k = 0; k < given.size(); ++k) {
    columns.push_back(measured_column(given[k].column, readings.given.at(k)));
  }
  return columns;
}

std::string readings_file_name(const Setup& setup) {
  std::string name = setup.name;
  const auto awkward = [](unsigned char c) {
    return std::isalnum(c) == 0 && c != '_' && c != '-' && c != '.';
  };
  std::ranges::replace_if(name, awkward, '_');
  return name + ".csv";
}

std::string campaign_toml(const Campaign& campaign, const std::string& machine_path) {
  std::string text = fmt::format("format = \"{}\"\nmachine = {}\n", kCampaignFormat, toml_text(machine_path));
  if (!campaign.active_compensations.empty())
    text += "active_compensations = " + toml_text(campaign.active_compensations) + "\n";
  if (std::ranges::none_of(campaign.setups, records_directions)) text += "directions = \"as-recorded\"\n";
  std::set<std::string> files;
  for (const Setup& setup : campaign.setups) {
    if (!files.insert(readings_file_name(setup)).second) {
      throw std::invalid_argument("two setups would be written to " + readings_file_name(setup));
    }
    text += setup_toml(setup, campaign.machine);
  }
  return text;
}

std::string readings_csv(const Setup& setup, const Machine& machine) {
  const std::vector<ReadingColumn> columns = reading_columns(setup, machine);
  std::string text;
  for (const ReadingColumn& column : columns) text += (text.empty() ? "" : ",") + column.name;
  text += '\n';
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (k > 0) text += ',';
      append_number(columns[k].values.at(row) / columns[k].si_per_unit, columns[k].decimals, text);
    }
    text += '\n';
  }
  return text;
}

void write_campaign(const Campaign& campaign, const std::string& folder, const std::string& machine_path) {
  write_text_file(folder + "/campaign.toml", campaign_toml(campaign, machine_path));
  for (const Setup& setup : campaign.setups) {
    write_text_file(folder + "/" + readings_file_name(setup), readings_csv(setup, campaign.machine));
  }
}

}  // namespace volcal
