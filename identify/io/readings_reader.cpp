#include "volcal/identify/io/readings_reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "volcal/identify/io/nearest_name.h"
#include "volcal/identify/io/text_file.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kTravelMargin = 0.05;  // share of the travel that commanded positions may lie outside
constexpr double kUnitSlip = 20.0;      // a position this many times beyond the travel may be in another unit
constexpr double kLatestTime_s = 1e10;  // of a clock that begins with the campaign or in 1970
constexpr double kColdest_degC = -60.0;
constexpr double kHottest_degC = 300.0;
constexpr double kShopColdest_degC = -20.0;  // some value of a channel lies between these two
constexpr double kShopHottest_degC = 60.0;

std::string direction_column(AxisName axis) {
  const char letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter_of(axis))));
  return std::string("dir_") + letter;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Columns that a file may lack, in the order in which they are looked for.
std::vector<std::string> optional_columns(const Machine& machine, const InstrumentSchema& instrument) {
  std::vector<std::string> names;
  for (const Axis& axis : machine.axes) names.push_back(direction_column(axis.name));
  for (const char* column : {"time_s", "line", "run", "feed_mm_min"}) names.emplace_back(column);
  names.push_back(sigma_column(instrument));
  return names;
}

double si_factor(const std::string& column) { return unit_of_key(column).si_per_unit; }

class ReadingsReader {
 public:
  ReadingsReader(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                 const InstrumentSchema& instrument)
      : table_(table), mapping_(mapping), machine_(machine), instrument_(instrument) {}

  Readings read() {
    check_mapping();
    choose_columns();
    reject_near_misses();
    reject_scale_of_nothing();
    CsvColumns columns = table_.numbers(index_);
    line_ = std::move(columns.source_line);
    for (std::size_t i = 0; i < name_.size(); ++i) {
      store(name_[i], std::move(columns.values[i]));
    }
    readings_.source_line = std::move(line_);
    return std::move(readings_);
  }

 private:
  void check_mapping() const {
    const auto known = known_columns(machine_, instrument_);
    const auto check = [&](const std::string& column, const SourcePlace& place, const std::string& key) {
      if (std::ranges::find(known, column) != known.end() || !temperature_channel(column).empty()) return;
      throw InputError(place, key + " names the unknown column " + printable(column),
                       suggest_name(column, known, "columns"));
    };
    for (const auto& [column, name] : mapping_.file_name) check(column, mapping_.place, "columns");
    for (const auto& [column, factor] : mapping_.scale) check(column, mapping_.scale_place, "scale");
  }

  std::string file_name(const std::string& column) const {
    const auto found = mapping_.file_name.find(column);
    return found == mapping_.file_name.end() ? column : found->second;
  }

  /// A column under its standard name counts only when the mapping does not use that name for another one.
  std::optional<std::size_t> find(const std::string& column) const {
    const std::string name = file_name(column);
    const auto found = table_.find(name);
    if (!found && mapping_.file_name.contains(column)) fail_mapped(column, name);
    return found;
  }

  [[noreturn]] void fail_mapped(const std::string& column, const std::string& name) const {
    throw InputError(mapping_.place,
                     "columns reads " + column + " from \"" + printable(name) + "\", but " + table_.file() +
                         " has no such column" + delimiter_hint(),
                     suggest_name(name, table_.header(), "columns of the file"));
  }

  std::string delimiter_hint() const {
    const auto other = table_.other_delimiter();
    if (!other) return "";
    return std::string("; its header is separated by ") +
           (*other == '\t' ? "tabs" : std::string("'") + *other + "'");
  }

  void take(const std::string& column, std::size_t index) {
    const auto taken = std::ranges::find(index_, index);
    if (taken != index_.end()) {
      throw InputError(mapping_.place,
                       "columns reads both " + name_[static_cast<std::size_t>(taken - index_.begin())] +
                           " and " + column + " from \"" + printable(table_.header()[index]) + "\"",
                       "give each its own column of the file");
    }
    name_.push_back(column);
    index_.push_back(index);
  }

  void require(const std::string& column) {
    const auto index = find(column);
    if (!index) fail_missing(column);
    take(column, *index);
  }

  bool take_if_present(const std::string& column) {
    const auto index = find(column);
    if (index) take(column, *index);
    return index.has_value();
  }

  [[noreturn]] void fail_missing(const std::string& column) const {
    throw InputError(table_.header_place(), "column " + column + " is missing" + delimiter_hint(),
                     missing_remedy(column));
  }

  std::string missing_remedy(const std::string& column) const {
    if (const auto other = table_.other_delimiter()) {
      return std::string("add delimiter = \"") + (*other == '\t' ? "\\t" : std::string(1, *other)) +
             "\" to the setup";
    }
    for (const std::string& present : table_.header()) {
      const Unit unit = unit_of_key(present);
      if (unit.suffix.empty() || stem_of_key(present) != stem_of_key(column)) continue;
      return "the file has " + present + "; add columns = { " + column + " = \"" + present +
             "\" } and scale = { " + column + " = " + number_text(unit.si_per_unit / si_factor(column)) +
             " } to the setup";
    }
    if (const auto near = nearest_name(column, table_.header())) {
      return "the file has \"" + printable(*near) + "\"; rename it or add columns = { " + column + " = \"" +
             printable(*near) + "\" } to the setup";
    }
    return "the file has " + printable(join_names(table_.header())) + "; add columns = { " + column +
           " = \"NAME IN THE FILE\" } to the setup if it is there under another name";
  }

  void choose_columns() {
    for (const Axis& axis : machine_.axes) require(axis_column(axis.name));
    choose_reading();
    for (const std::string& column : optional_columns(machine_, instrument_)) take_if_present(column);
    choose_temperatures();
    for (const AxisName axis : kAllAxes) {
      if (!machine_.has_axis(axis)) take_if_present(axis_column(axis));
    }
  }

  void choose_temperatures() {
    for (const auto& [column, name] : mapping_.file_name) {
      if (!temperature_channel(column).empty()) take_if_present(column);
    }
    for (const std::string& column : table_.header()) {
      if (!temperature_channel(column).empty() && !is_taken(column)) take_if_present(column);
    }
  }

  bool is_taken(const std::string& header_name) const {
    return std::ranges::any_of(index_, [&](std::size_t i) { return table_.header()[i] == header_name; }) ||
           std::ranges::find(name_, header_name) != name_.end();
  }

  void choose_reading() {
    std::vector<std::size_t> complete;
    std::size_t fullest = 0;
    std::size_t most = 0;
    for (std::size_t s = 0; s < instrument_.column_sets.size(); ++s) {
      const auto& set = instrument_.column_sets[s];
      const auto present = [&](const ColumnSchema& column) { return find(column.column).has_value(); };
      const auto count = static_cast<std::size_t>(std::ranges::count_if(set, present));
      if (count == set.size()) complete.push_back(s);
      if (count > most) {
        most = count;
        fullest = s;
      }
    }
    if (complete.empty()) fail_reading(fullest, most);
    drop_parts_of_larger_sets(complete);
    if (complete.size() > 1) fail_two_readings(complete);
    readings_.column_set = complete.front();
    const auto& set = instrument_.column_sets[complete.front()];
    readings_.value.resize(set.size());
    for (const ColumnSchema& column : set) require(column.column);
  }

  /// Of the sets found, those whose columns all belong to another set found as well say nothing new.
  void drop_parts_of_larger_sets(std::vector<std::size_t>& complete) const {
    const auto is_part_of = [&](std::size_t part, std::size_t whole) {
      const auto& columns = instrument_.column_sets[whole];
      return part != whole &&
             std::ranges::all_of(instrument_.column_sets[part], [&](const ColumnSchema& column) {
               return std::ranges::find(columns, column.column, &ColumnSchema::column) != columns.end();
             });
    };
    const std::vector<std::size_t> all = complete;
    std::erase_if(complete, [&](std::size_t part) {
      return std::ranges::any_of(all, [&](std::size_t whole) { return is_part_of(part, whole); });
    });
  }

  [[noreturn]] void fail_reading(std::size_t set, std::size_t present) const {
    for (const ColumnSchema& column : instrument_.column_sets[set]) {
      if (find(column.column)) continue;
      if (present > 0 || instrument_.column_sets.size() == 1) fail_missing(column.column);
      std::vector<std::string> names;
      for (const auto& alternative : instrument_.column_sets) names.push_back(alternative.front().column);
      throw InputError(table_.header_place(),
                       "the reading column is missing: " + instrument_.name + " reads " + join_names(names) +
                           delimiter_hint(),
                       missing_remedy(column.column));
    }
    fail_missing(instrument_.column_sets[set].front().column);
  }

  [[noreturn]] void fail_two_readings(const std::vector<std::size_t>& complete) const {
    const std::string first = instrument_.column_sets[complete[0]].front().column;
    const std::string second = instrument_.column_sets[complete[1]].front().column;
    throw InputError(table_.header_place(), "the file has both " + first + " and " + second,
                     "keep one of them; " + instrument_.name + " takes one kind of reading per setup");
  }

  /// A factor that would act on nothing must not be dropped in silence.
  void reject_scale_of_nothing() const {
    for (const auto& [column, factor] : mapping_.scale) {
      if (std::ranges::find(name_, column) != name_.end()) continue;
      throw InputError(
          mapping_.scale_place,
          "scale has a factor for " + printable(column) + ", but " + table_.file() + " has no such column",
          "remove the factor, or add columns = { " + printable(column) +
              " = \"NAME IN THE FILE\" } to the setup");
    }
  }

  /// Columns that nobody reads and that look like a slip of a standard name must not be dropped in silence.
  void reject_near_misses() const {
    const auto known = optional_columns(machine_, instrument_);
    for (const std::string& column : table_.header()) {
      if (is_taken(column)) continue;
      if (const auto meant = missing_component(column)) {
        const std::string_view unit = unit_of_key(column).suffix;
        const bool other_unit = !unit.empty() && unit != unit_of_key(*meant).suffix;
        throw InputError(table_.header_place(), "column " + printable(column) + " is not " + *meant,
                         near_miss_remedy(column, *meant, other_unit));
      }
      if (column.starts_with("T_")) {
        throw InputError(table_.header_place(), "column " + printable(column) + " looks like a temperature",
                         "name it T_<channel>_degC, or map it with columns = { T_CHANNEL_degC = \"" +
                             printable(column) + "\" }");
      }
      for (const std::string& standard : known) {
        if (std::ranges::find(name_, standard) != name_.end()) continue;
        const bool other_case = lower(column) == lower(standard) && column != standard;
        const bool other_unit = !unit_of_key(column).suffix.empty() && column != standard &&
                                stem_of_key(column) == stem_of_key(standard) && stem_of_key(column) != column;
        if (!other_case && !other_unit) continue;
        throw InputError(table_.header_place(),
                         "column " + printable(column) + " is not " + standard +
                             (other_case ? ": names are case-sensitive" : ": the unit differs"),
                         near_miss_remedy(column, standard, other_unit));
      }
    }
  }

  /// The column of a larger set than the one found that `column` may be meant to be.
  std::optional<std::string> missing_component(const std::string& column) const {
    std::vector<std::string> missing;
    for (const auto& set : instrument_.column_sets) {
      if (set.size() <= instrument_.column_sets[readings_.column_set].size()) continue;
      for (const ColumnSchema& part : set) {
        if (std::ranges::find(name_, part.column) == name_.end()) missing.push_back(part.column);
      }
    }
    const auto same_stem = std::ranges::find_if(missing, [&](const std::string& name) {
      return lower(std::string(stem_of_key(column))) == stem_of_key(name);
    });
    return same_stem != missing.end() ? std::optional(*same_stem) : nearest_name(column, missing);
  }

  static std::string near_miss_remedy(const std::string& column, const std::string& standard,
                                      bool other_unit) {
    std::string remedy = "rename it or add columns = { " + standard + " = \"" + printable(column) + "\" }";
    if (other_unit) {
      remedy +=
          " and scale = { " + standard + " = " + number_text(si_factor(column) / si_factor(standard)) + " }";
    }
    return remedy + " to the setup";
  }

  void store(const std::string& column, std::vector<double> values) {
    if (const auto factor = mapping_.scale.find(column); factor != mapping_.scale.end()) {
      for (double& value : values) value *= factor->second;
    }
    if (const auto channel = temperature_channel(column); !channel.empty()) {
      check_temperatures(column, values);
      readings_.temperature[channel] = std::move(values);
    } else if (column == "line") {
      readings_.line = integers(column, values);
    } else if (column == "run") {
      readings_.run = integers(column, values);
    } else if (column == "time_s") {
      check_range(column, values, -kLatestTime_s, kLatestTime_s,
                  "seconds of the campaign's clock, or since 1970, are expected; if the file is in "
                  "milliseconds add scale = { time_s = 0.001 } to the setup");
      readings_.time = std::move(values);
    } else if (column == "feed_mm_min") {
      check_range(column, values, 0.0, 1e6, "a feed is not negative; 0 to 1000000 mm/min is believed");
      readings_.feed = in_si(column, std::move(values));
    } else if (column == sigma_column(instrument_)) {
      store_sigma(column, std::move(values));
    } else if (!store_axis(column, values)) {
      store_reading(column, std::move(values));
    }
  }

  bool store_axis(const std::string& column, std::vector<double>& values) {
    for (const AxisName axis : kAllAxes) {
      if (column == direction_column(axis)) {
        readings_.direction[index_of(axis)] = directions(column, values);
        return true;
      }
      if (column != axis_column(axis)) continue;
      if (!machine_.has_axis(axis)) {
        reject_movement(column, axis, values);
        return true;
      }
      values = in_si(column, std::move(values));
      check_travel(column, machine_.axis(axis), values);
      readings_.position[index_of(axis)] = std::move(values);
      return true;
    }
    return false;
  }

  void store_reading(const std::string& column, std::vector<double> values) {
    const auto& set = instrument_.column_sets[readings_.column_set];
    const auto schema = std::ranges::find(set, column, &ColumnSchema::column);
    const double most = schema->plausible_max;
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (std::abs(values[row]) <= most) continue;
      const std::string_view unit = unit_of_key(column).suffix;
      std::string remedy = "at most " + number_text(most) + " " + std::string(unit) + " is believed";
      const bool thousand = std::ranges::all_of(values, [&](double v) { return std::abs(v) <= most * 1e3; });
      if (thousand) {
        remedy += "; if the file is in a unit 1000 times smaller add scale = { " + column +
                  " = 0.001 } to the setup";
      }
      fail(row, column + " = " + number_text(values[row]) + " is too large", remedy);
    }
    readings_.value[static_cast<std::size_t>(schema - set.begin())] = in_si(column, std::move(values));
  }

  void store_sigma(const std::string& column, std::vector<double> values) {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] > 0.0) continue;
      fail(row, column + " = " + number_text(values[row]) + " is not a standard deviation",
           "every sigma must be positive; remove the column to use the setup's noise table");
    }
    readings_.sigma = in_si(column, std::move(values));
  }

  static std::vector<double> in_si(const std::string& column, std::vector<double> values) {
    const double factor = si_factor(column);
    for (double& value : values) value *= factor;
    return values;
  }

  [[noreturn]] void fail(std::size_t row, const std::string& problem, const std::string& remedy) const {
    throw InputError({table_.file(), static_cast<int>(line_[row])}, problem, remedy);
  }

  void check_range(const std::string& column, const std::vector<double>& values, double min, double max,
                   const std::string& remedy) const {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] < min || values[row] > max)
        fail(row, column + " = " + number_text(values[row]), remedy);
    }
  }

  /// A hot spindle leaves the range of a shop now and then, degF and K always.
  void check_temperatures(const std::string& column, const std::vector<double>& values) const {
    check_range(column, values, kColdest_degC, kHottest_degC, "a temperature of the shop is expected");
    const auto [coldest, hottest] = std::ranges::minmax(values);
    if (coldest <= kShopHottest_degC && hottest >= kShopColdest_degC) return;
    fail(0,
         column + " is " + number_text(coldest) + " to " + number_text(hottest) + ": no value lies within " +
             number_text(kShopColdest_degC) + " to " + number_text(kShopHottest_degC) + " degC",
         hottest > 200.0 ? "in K? write degC: subtract 273.15" : "in degF? write degC: (F - 32) / 1.8");
  }

  void check_travel(const std::string& column, const Axis& axis, const std::vector<double>& values) const {
    const double margin = kTravelMargin * axis.travel();
    const auto outside = [&](double q) {
      return q < axis.travel_min - margin || q > axis.travel_max + margin;
    };
    const auto first = std::ranges::find_if(values, outside);
    if (first == values.end()) return;
    const double factor = si_factor(column);
    const std::string unit(unit_of_key(column).suffix);
    std::string remedy = "check travel_" + unit + " of the machine and the unit and sign of the column";
    const double reach = std::max(std::abs(axis.travel_min), std::abs(axis.travel_max));
    for (const double scale : {1e-3, 1e3}) {
      if (scale < 1.0 && std::abs(*first) < kUnitSlip * reach) continue;
      const bool fits = std::ranges::none_of(values, [&](double q) { return outside(q * scale); });
      if (fits)
        remedy =
            "wrong unit by 1000? add scale = { " + column + " = " + number_text(scale) + " } to the setup";
    }
    fail(static_cast<std::size_t>(first - values.begin()),
         column + " = " + number_text(*first / factor) + " lies outside the travel of " +
             letter_of(axis.name) + ", " + number_text(axis.travel_min / factor) + " to " +
             number_text(axis.travel_max / factor) + " " + unit,
         remedy);
  }

  void reject_movement(const std::string& column, AxisName axis, const std::vector<double>& values) const {
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] == values.front()) continue;
      fail(row, column + " moves, but the machine has no axis " + std::string(1, letter_of(axis)),
           "add the axis to the machine or take the column out of the file");
    }
  }

  std::vector<std::int8_t> directions(const std::string& column, const std::vector<double>& values) const {
    std::vector<std::int8_t> read(values.size());
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (values[row] != -1.0 && values[row] != 0.0 && values[row] != 1.0) {
        fail(row, column + " = " + number_text(values[row]) + " is no direction of approach",
             "use -1, 1, or 0 when unknown");
      }
      read[row] = static_cast<std::int8_t>(values[row]);
    }
    return read;
  }

  std::vector<std::int32_t> integers(const std::string& column, const std::vector<double>& values) const {
    std::vector<std::int32_t> read(values.size());
    for (std::size_t row = 0; row < values.size(); ++row) {
      const bool fits = values[row] == std::round(values[row]) &&
                        std::abs(values[row]) <= std::numeric_limits<std::int32_t>::max();
      if (!fits)
        fail(row, column + " = " + number_text(values[row]) + " is no " + column + " number", "use integers");
      read[row] = static_cast<std::int32_t>(values[row]);
    }
    return read;
  }

  const CsvTable& table_;
  const ColumnMapping& mapping_;
  const Machine& machine_;
  const InstrumentSchema& instrument_;
  std::vector<std::string> name_;  // standard names of the columns taken, in step with index_
  std::vector<std::size_t> index_;
  std::vector<std::int64_t> line_;
  Readings readings_;
};

}  // namespace

std::vector<std::string> known_columns(const Machine& machine, const InstrumentSchema& instrument) {
  std::vector<std::string> names;
  for (const Axis& axis : machine.axes) names.push_back(axis_column(axis.name));
  for (const auto& set : instrument.column_sets) {
    for (const ColumnSchema& column : set) names.push_back(column.column);
  }
  for (const std::string& column : optional_columns(machine, instrument)) names.push_back(column);
  return names;
}

Readings read_readings(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                       const InstrumentSchema& instrument) {
  return ReadingsReader(table, mapping, machine, instrument).read();
}

}  // namespace volcal
