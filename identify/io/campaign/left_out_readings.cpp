#include "volcal/identify/io/campaign/left_out_readings.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

std::vector<std::string> reading_columns(const Setup& setup) {
  std::vector<std::string> names;
  const auto& sets = find_instrument(setup.instrument)->schema().column_sets;
  for (const ColumnSchema& column : sets.at(setup.readings.column_set)) names.push_back(column.column);
  return names;
}

std::size_t row_of(const LeaveOut& entry, double line, const Setup& setup) {
  const auto& lines = setup.readings.source_line;
  const auto as_number = [](std::int64_t each) { return static_cast<double>(each); };
  const auto found = std::ranges::lower_bound(lines, line, {}, as_number);
  if (found == lines.end() || as_number(*found) != line) {
    throw InputError(entry.rows_place,
                     "setup \"" + setup.name + "\" leaves out row " + number_text(line) + ", but " +
                         setup.data + " has no reading in that line",
                     "rows are lines of the file, its header included: " + std::to_string(lines.front()) +
                         " to " + std::to_string(lines.back()));
  }
  return static_cast<std::size_t>(found - lines.begin());
}

std::vector<std::size_t> channels_of(const LeaveOut& entry, const Setup& setup) {
  const std::vector<std::string> known = reading_columns(setup);
  std::vector<std::size_t> channels;
  for (const std::string& column : entry.columns) {
    const auto found = std::ranges::find(known, column);
    if (found == known.end()) {
      throw InputError(
          entry.columns_place,
          "setup \"" + setup.name + "\" leaves out readings of the unknown column " + printable(column),
          suggest_name(column, known, "columns of readings"));
    }
    channels.push_back(static_cast<std::size_t>(found - known.begin()));
  }
  if (channels.empty()) {
    for (std::size_t channel = 0; channel < known.size(); ++channel) channels.push_back(channel);
  }
  return channels;
}

}  // namespace

std::vector<LeaveOut> read_leave_out(const TomlTable& setup) {
  std::vector<LeaveOut> entries;
  for (const TomlTable& table : setup.tables("leave_out")) {
    LeaveOut entry;
    entry.rows = table.required_numbers("rows");
    entry.rows_place = table.place("rows");
    if (entry.rows.empty()) table.fail("rows", table.path() + ".rows is empty", "name lines of the file");
    entry.columns = table.texts("columns").value_or(std::vector<std::string>{});
    entry.columns_place = table.place("columns");
    entry.reason = table.required_text("reason");
    if (entry.reason.empty()) {
      table.fail("reason", table.path() + ".reason is empty",
                 "say why these readings are left out: it is shown with every result");
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<LeftOutReading> left_out_readings(const std::vector<LeaveOut>& entries, const Setup& setup) {
  std::vector<LeftOutReading> readings;
  for (const LeaveOut& entry : entries) {
    const std::vector<std::size_t> channels = channels_of(entry, setup);
    for (const double line : entry.rows) {
      const std::size_t row = row_of(entry, line, setup);
      for (const std::size_t channel : channels) readings.push_back({row, channel, entry.reason});
    }
  }
  const auto place = [](const LeftOutReading& reading) { return std::pair(reading.row, reading.channel); };
  std::ranges::stable_sort(readings, {}, place);
  if (const auto twice = std::ranges::adjacent_find(readings, {}, place); twice != readings.end()) {
    throw InputError(entries.front().rows_place,
                     "setup \"" + setup.name + "\" leaves out row " +
                         std::to_string(setup.readings.source_line[twice->row]) + " twice",
                     "name every reading once");
  }
  if (!readings.empty() && readings.size() == setup.readings.size() * setup.readings.channels()) {
    throw InputError(entries.front().rows_place, "setup \"" + setup.name + "\" leaves out all its readings",
                     "remove the setup instead");
  }
  return readings;
}

}  // namespace volcal
