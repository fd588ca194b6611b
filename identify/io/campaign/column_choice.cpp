#include "volcal/identify/io/campaign/column_choice.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "volcal/identify/io/campaign/column_names.h"
#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_encoding.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Names that differ in one letter of an axis are no slips of each other: Ex and Ez, dir_x and dir_a.
bool differ_in_axis(const std::string& one, const std::string& other) {
  if (one.size() != other.size()) return false;
  const std::string a = in_lower_case(one), b = in_lower_case(other);
  std::size_t differing = 0;
  bool axes = true;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    ++differing;
    axes = axes && std::string_view("xyzabcuvw").find(a[i]) != std::string_view::npos &&
           std::string_view("xyzabcuvw").find(b[i]) != std::string_view::npos;
  }
  return differing == 1 && axes;
}

std::optional<std::string> nearest_column(const std::string& name, std::vector<std::string> candidates) {
  std::erase_if(candidates, [&](const std::string& candidate) { return differ_in_axis(name, candidate); });
  return nearest_name(name, candidates);
}

double si_of_column(const std::string& column) { return unit_of_key(column).si_per_unit; }

class ColumnChooser {
 public:
  ColumnChooser(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                const InstrumentSchema& instrument)
      : table_(table), mapping_(mapping), machine_(machine), instrument_(instrument) {}

  ColumnChoice choose() {
    check_encoding();
    check_mapping();
    choose_all();
    reject_control();
    reject_near_misses();
    reject_scale_of_nothing();
    list_unused();
    return std::move(choice_);
  }

 private:
  void check_encoding() const {
    for (const std::string& name : table_.header()) {
      if (is_utf8(name)) continue;
      throw InputError(
          table_.header_place(), "the name of column " + printable(name) + " is not UTF-8 text",
          "add encoding = \"cp1252\" to the setup (Windows, western Europe), or \"latin1\"; or save "
          "the file as UTF-8");
    }
  }

  /// Channels of temperatures become names of variables and effects.
  void reject_control() const {
    for (const std::string& column : choice_.name) {
      if (!holds_control(column)) continue;
      throw InputError(table_.header_place(),
                       "the name of column " + printable(column) + " holds a control character",
                       "rename it in the file");
    }
  }

  void check_mapping() const {
    const auto known = known_columns(machine_, instrument_);
    const auto check = [&](const std::string& column, const SourcePlace& place, const std::string& key) {
      if (std::ranges::find(known, column) != known.end() || !temperature_channel(column).empty()) return;
      throw InputError(place, key + " names the unknown column " + printable(column),
                       suggest_name(column, known, "columns"));
    };
    for (const auto& [column, name] : mapping_.file_name) check(column, mapping_.place, "columns");
    for (const auto& [column, factor] : mapping_.scale) check(column, mapping_.scale_place, "scale");
    for (const auto& [column, value] : mapping_.constant) {
      check(column, mapping_.constant_place, "constants");
      if (is_reading(column)) {
        throw InputError(mapping_.constant_place, "constants gives the reading " + column,
                         "a reading comes from the file; constants are for what stood still");
      }
    }
  }

  bool is_reading(const std::string& column) const {
    for (std::size_t s = 0; s < instrument_.column_sets.size(); ++s) {
      const auto set = instrument_.file_columns(s);
      if (std::ranges::find(set, column, &ColumnSchema::column) != set.end()) return true;
    }
    return false;
  }

  std::string file_name(const std::string& column) const {
    const auto found = mapping_.file_name.find(column);
    return found == mapping_.file_name.end() ? column : found->second;
  }

  /// A column under its standard name counts only when the mapping does not use that name for another one.
  std::optional<std::size_t> find(const std::string& column) const {
    const std::string name = file_name(column);
    const auto found = table_.find(name);
    if (found && mapping_.constant.contains(column)) {
      throw InputError(mapping_.constant_place,
                       "constants gives " + column + ", but " + table_.file() + " has the column \"" +
                           printable(name) + "\"",
                       "remove the constant, or the column");
    }
    if (!found && mapping_.file_name.contains(column)) fail_mapped(column, name);
    return found;
  }

  [[noreturn]] void fail_mapped(const std::string& column, const std::string& name) const {
    throw InputError(mapping_.place,
                     "columns reads " + column + " from \"" + printable(name) + "\", but " + table_.file() +
                         " has no such column" + delimiter_hint(),
                     file_name_remedy(name));
  }

  std::string file_name_remedy(const std::string& name) const {
    if (const auto near = nearest_column(name, table_.header())) return "did you mean " + quoted(*near) + "?";
    return "known columns of the file: " + printable(join_names(table_.header()));
  }

  static std::string quoted(const std::string& name) { return "\"" + printable(name) + "\""; }

  std::string delimiter_hint() const {
    const auto other = table_.other_delimiter();
    if (!other) return "";
    return std::string("; its header is separated by ") +
           (*other == '\t' ? "tabs" : std::string("'") + *other + "'");
  }

  void take(const std::string& column, std::size_t index) {
    const auto taken = std::ranges::find(choice_.index, index);
    if (taken != choice_.index.end()) {
      throw InputError(mapping_.place,
                       "columns reads both " +
                           choice_.name[static_cast<std::size_t>(taken - choice_.index.begin())] + " and " +
                           column + " from \"" + printable(table_.header()[index]) + "\"",
                       "give each its own column of the file");
    }
    choice_.name.push_back(column);
    choice_.index.push_back(index);
  }

  void require(const std::string& column) {
    const auto index = find(column);
    if (!index && mapping_.constant.contains(column)) return;
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
    const std::vector<std::string> others = other_names();
    for (const std::string& present : others) {
      const Unit unit = unit_of_key(present);
      if (unit.suffix.empty() || stem_of_key(present) != stem_of_key(column)) continue;
      return "the file has " + present + "; add columns = { " + column + " = \"" + present +
             "\" } and scale = { " + column + " = " + number_text(unit.si_per_unit / si_of_column(column)) +
             " } to the setup";
    }
    if (const auto near = nearest_column(column, others)) {
      return "the file has \"" + printable(*near) + "\"; rename it or add columns = { " + column + " = \"" +
             printable(*near) + "\" } to the setup";
    }
    std::string remedy = "the file has " + printable(join_names(table_.header())) + "; add columns = { " +
                         column + " = \"NAME IN THE FILE\" } to the setup if it is there under another name";
    if (is_position(column)) remedy += ", or constants = { " + column + " = 0.0 } if the axis stood still";
    return remedy;
  }

  /// Names of the file that are not standard names themselves: a height never becomes a position, nor one
  /// component another one.
  std::vector<std::string> other_names() const {
    const auto known = known_columns(machine_, instrument_);
    std::vector<std::string> names;
    for (const std::string& name : table_.header()) {
      if (std::ranges::find(known, name) == known.end() && temperature_channel(name).empty())
        names.push_back(name);
    }
    return names;
  }

  bool is_position(const std::string& column) const {
    return std::ranges::any_of(machine_.axes,
                               [&](const Axis& axis) { return axis_column(axis.name) == column; });
  }

  void choose_all() {
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
    return std::ranges::any_of(choice_.index,
                               [&](std::size_t i) { return table_.header()[i] == header_name; }) ||
           std::ranges::find(choice_.name, header_name) != choice_.name.end();
  }

  void choose_reading() {
    std::vector<std::size_t> complete;
    std::size_t fullest = 0;
    std::size_t most = 0;
    for (std::size_t s = 0; s < instrument_.column_sets.size(); ++s) {
      const auto set = instrument_.file_columns(s);
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
    choice_.column_set = complete.front();
    for (const ColumnSchema& column : instrument_.file_columns(choice_.column_set)) require(column.column);
  }

  /// Of the sets found, those whose columns all belong to another set found as well say nothing new.
  void drop_parts_of_larger_sets(std::vector<std::size_t>& complete) const {
    const auto is_part_of = [&](std::size_t part, std::size_t whole) {
      const auto columns = instrument_.file_columns(whole);
      return part != whole &&
             std::ranges::all_of(instrument_.file_columns(part), [&](const ColumnSchema& column) {
               return std::ranges::find(columns, column.column, &ColumnSchema::column) != columns.end();
             });
    };
    const std::vector<std::size_t> all = complete;
    std::erase_if(complete, [&](std::size_t part) {
      return std::ranges::any_of(all, [&](std::size_t whole) { return is_part_of(part, whole); });
    });
  }

  [[noreturn]] void fail_reading(std::size_t set, std::size_t present) const {
    for (const ColumnSchema& column : instrument_.file_columns(set)) {
      if (find(column.column)) continue;
      if (present > 0 || instrument_.column_sets.size() == 1) fail_missing(column.column);
      std::vector<std::string> names;
      for (std::size_t s = 0; s < instrument_.column_sets.size(); ++s) {
        const std::string first = instrument_.file_columns(s).front().column;
        if (std::ranges::find(names, first) == names.end()) names.push_back(first);
      }
      throw InputError(table_.header_place(),
                       "the reading column is missing: " + instrument_.name + " reads " + join_names(names) +
                           delimiter_hint(),
                       missing_remedy(column.column));
    }
    fail_missing(instrument_.file_columns(set).front().column);
  }

  [[noreturn]] void fail_two_readings(const std::vector<std::size_t>& complete) const {
    const std::string first = instrument_.file_columns(complete[0]).front().column;
    const std::string second = instrument_.file_columns(complete[1]).front().column;
    throw InputError(table_.header_place(), "the file has both " + first + " and " + second,
                     "keep one of them; " + instrument_.name + " takes one kind of reading per setup");
  }

  /// A factor that would act on nothing must not be dropped in silence.
  void reject_scale_of_nothing() const {
    for (const auto& [column, factor] : mapping_.scale) {
      if (std::ranges::find(choice_.name, column) != choice_.name.end()) continue;
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
        if (std::ranges::find(choice_.name, standard) != choice_.name.end()) continue;
        const bool other_case = in_lower_case(column) == in_lower_case(standard) && column != standard;
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
    for (std::size_t s = 0; s < instrument_.column_sets.size(); ++s) {
      const auto set = instrument_.file_columns(s);
      if (set.size() <= instrument_.file_columns(choice_.column_set).size()) continue;
      for (const ColumnSchema& part : set) {
        if (std::ranges::find(choice_.name, part.column) == choice_.name.end())
          missing.push_back(part.column);
      }
    }
    const auto same_stem = std::ranges::find_if(missing, [&](const std::string& name) {
      return in_lower_case(std::string(stem_of_key(column))) == stem_of_key(name);
    });
    return same_stem != missing.end() ? std::optional(*same_stem) : nearest_column(column, missing);
  }

  static std::string near_miss_remedy(const std::string& column, const std::string& standard,
                                      bool other_unit) {
    std::string remedy = "rename it or add columns = { " + standard + " = \"" + printable(column) + "\" }";
    if (other_unit) {
      remedy += " and scale = { " + standard + " = " +
                number_text(si_of_column(column) / si_of_column(standard)) + " }";
    }
    return remedy + " to the setup";
  }

  void list_unused() {
    std::vector<std::string> missing;
    for (const std::string& column : optional_columns(machine_, instrument_)) {
      const bool there =
          std::ranges::find(choice_.name, column) != choice_.name.end() || mapping_.constant.contains(column);
      if (!there) missing.push_back(column);
    }
    for (const std::string& name : table_.header()) {
      if (!is_taken(name) && !name.empty())
        choice_.unused.push_back({name, meant_column(name, missing, machine_)});
    }
  }

  const CsvTable& table_;
  const ColumnMapping& mapping_;
  const Machine& machine_;
  const InstrumentSchema& instrument_;
  ColumnChoice choice_;
};

}  // namespace

std::vector<std::string> optional_columns(const Machine& machine, const InstrumentSchema& instrument) {
  std::vector<std::string> names;
  for (const Axis& axis : machine.axes) names.push_back(direction_column(axis.name));
  for (const char* column : {"time_s", "line", "run", "feed_mm_min"}) names.emplace_back(column);
  names.push_back(sigma_column(instrument));
  return names;
}

std::vector<std::string> known_columns(const Machine& machine, const InstrumentSchema& instrument) {
  std::vector<std::string> names;
  for (const Axis& axis : machine.axes) names.push_back(axis_column(axis.name));
  for (std::size_t s = 0; s < instrument.column_sets.size(); ++s) {
    for (const ColumnSchema& column : instrument.file_columns(s)) {
      if (std::ranges::find(names, column.column) == names.end()) names.push_back(column.column);
    }
  }
  for (const std::string& column : optional_columns(machine, instrument)) names.push_back(column);
  return names;
}

ColumnChoice choose_columns(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                            const InstrumentSchema& instrument) {
  return ColumnChooser(table, mapping, machine, instrument).choose();
}

}  // namespace volcal
