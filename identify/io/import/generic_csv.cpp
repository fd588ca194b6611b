#include <algorithm>
#include <cmath>
#include <set>

#include "volcal/identify/io/campaign/column_choice.h"
#include "volcal/identify/io/campaign/column_names.h"
#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/io/import/column_meaning.h"
#include "volcal/identify/io/import/import_format.h"
#include "volcal/identify/io/import/table_layout.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

constexpr double kRoundDirection = 1e9;

/// Standard columns that any instrument or machine understands.
std::vector<std::string> all_standard_columns(const Machine& machine) {
  std::set<std::string> names;
  for (const Instrument* instrument : instruments()) {
    for (const std::string& name : known_columns(machine, instrument->schema())) names.insert(name);
  }
  return {names.begin(), names.end()};
}

/// A column of readings that the words of a header mean; empty = none.
std::string meant_reading(const HeaderWords& header) {
  for (const char* component : {"ex", "ey", "ez"}) {
    if (header.has({component})) return std::string(component) + "_um";
  }
  const bool angle = angle_unit(header.unit).has_value();
  const bool deviation =
      header.has({"deviation", "deviations", "dev", "error", "abweichung", "fehler", "ecart", "delta"});
  if (header.has({"angle", "winkel", "pitch", "yaw", "roll"}) || (deviation && angle)) return "angle_urad";
  if (deviation) return "deviation_um";
  if (header.has({"displacement", "weg", "verschiebung"})) return "displacement_mm";
  if (header.has({"length", "distance", "range", "distanz", "strecke", "l\u00E4nge", "laenge"}))
    return "length_mm";
  return "";
}

bool says_position(const HeaderWords& header) {
  return header.has({"pos", "position", "target", "targets", "commanded", "nominal", "soll", "sollposition",
                     "sollwert", "cmd", "axis", "achse"});
}

class GenericCsv {
 public:
  GenericCsv(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
             std::size_t tool)
      : source_(source),
        answers_(answers),
        machine_(machine),
        tool_(tool),
        layout_(guess_table_layout(source)) {}

  ImportedReadings read() {
    if (layout_.header.empty())
      throw InputError({source_.path, layout_.rows.front().line},
                       "no header above the numbers names the columns",
                       "add a line of names, e.g. x_mm;y_mm;z_mm;deviation_um");
    add_fact("delimiter", delimiter_name(layout_.delimiter), layout_.delimiter == ',' ? "the rows" : "");
    add_fact("decimal sign", layout_.decimal == ',' ? "comma" : "point",
             source_.decimal          ? "--decimal"
             : layout_.decimal == '.' ? "the numbers"
                                      : "");
    if (const std::string beside = lines_beside(layout_); !beside.empty())
      add_fact("beside the table", beside, "not read");
    for (const TableRow& row : layout_.rows) readings_.source_line.push_back(row.line);
    for (std::size_t k = 0; k < layout_.header.size(); ++k) take_column(k);
    choose_instrument();
    for (const AxisName axis : listed_) shift_positions(axis);
    add_standing_axes(source_, answers_, machine_, listed_, readings_);
    if (const auto axis = read_along()) add_direction(*axis);
    return std::move(readings_);
  }

 private:
  /// Said by nobody: guessed.
  void add_fact(const std::string& what, const std::string& value, const std::string& said_by) {
    readings_.guessed = readings_.guessed || said_by.empty();
    readings_.facts.push_back({what, value, said_by.empty() ? "guessed" : said_by});
  }

  SourcePlace header_place() const { return {source_.path, layout_.header_line}; }

  void take_column(std::size_t k) {
    const std::string shown = "column \"" + printable(layout_.header[k]) + "\"";
    const std::string column = layout_.numeric[k] ? meaning(layout_.header[k]) : "";
    if (column.empty()) {
      leave_out(k, shown);
      return;
    }
    const auto twin = std::ranges::find(readings_.columns, column, &ImportedColumn::name);
    if (twin != readings_.columns.end())
      throw InputError(header_place(), shown + " and another one both seem to be " + column,
                       "rename one of the two");
    const double factor = factor_of(layout_.header[k], column);
    std::vector<double> values;
    for (const TableRow& row : layout_.rows) values.push_back(layout_.number(row, k) * factor);
    readings_.columns.push_back({column, std::move(values)});
    const bool standard = layout_.header[k] == column;
    add_fact(shown, column + (standard ? "" : unit_words(layout_.header[k], column)),
             standard ? "its name" : "");
    for (const AxisName axis : kAllAxes) {
      if (position_column(axis) == column) listed_.push_back(axis);
    }
  }

  /// Positions by `--at` beside a column that may hold them are for the user to confirm.
  void leave_out(std::size_t k, const std::string& shown) {
    const char letter = header_words(layout_.header[k]).letter();
    const auto axis = letter == 0 ? std::nullopt : axis_from_letter(static_cast<char>(letter - 'a' + 'A'));
    if (axis && answers_.at.contains(*axis))
      return add_fact(shown, std::string("not read: ") + letter_of(*axis) + " stands where --at says", "");
    add_fact(shown, "not read", "no instrument or axis needs it");
  }

  std::string meaning(const std::string& header) {
    const auto standard = all_standard_columns(machine_);
    if (std::ranges::find(standard, header) != standard.end() || !temperature_channel(header).empty())
      return header;
    const HeaderWords words = header_words(header);
    if (words.words.empty()) return "";
    if (const std::string reading = meant_reading(words); !reading.empty()) return reading;
    if (const auto axis = meant_axis(words)) return position_column(*axis);
    std::vector<std::string> optional;
    for (const Instrument* instrument : instruments()) {
      for (const std::string& name : optional_columns(machine_, instrument->schema()))
        optional.push_back(name);
    }
    return meant_column(header, optional, machine_);
  }

  std::optional<AxisName> meant_axis(const HeaderWords& words) const {
    const char letter = words.letter();
    const bool alone = words.words.size() == 1 && letter != 0;
    if (!alone && !says_position(words)) return std::nullopt;
    if (words.has({"dir", "direction", "richtung"})) return std::nullopt;
    if (letter != 0) {
      const auto axis = axis_from_letter(static_cast<char>(letter - 'a' + 'A'));
      return axis && machine_.has_axis(*axis) ? axis : std::nullopt;
    }
    if (!answers_.axis)
      ask_for(source_, "of which axis the positions are (line " + std::to_string(layout_.header_line) + ")",
              "--axis X");
    const auto axis = answers_.axis->size() == 1 ? axis_from_letter((*answers_.axis)[0]) : std::nullopt;
    if (!axis || !machine_.has_axis(*axis))
      throw InputError({}, "--axis " + printable(*answers_.axis) + " is not an axis of the machine",
                       "give one letter, as --axis X");
    return axis;
  }

  /// Unit that a column's numbers have: its header's, for readings the answer's, or that of the standard
  /// name.
  std::string unit_of(const std::string& header, const std::string& column) const {
    const HeaderWords words = header_words(header);
    if (!words.unit.empty()) return words.unit;
    return answers_.unit && !meant_reading(words).empty() ? *answers_.unit
                                                          : std::string(unit_of_key(column).suffix);
  }

  std::string unit_words(const std::string& header, const std::string& column) const {
    const std::string unit = unit_of(header, column);
    if (unit.empty()) return "";
    return ", in " + (unit == "mm_min" ? "mm/min" : unit) +
           (header_words(header).unit.empty() && !answers_.unit ? " (not stated)" : "");
  }

  double factor_of(const std::string& header, const std::string& column) const {
    const std::string_view own = unit_of_key(column).suffix;
    const std::string unit = unit_of(header, column);
    if (header == column || own.empty() || unit == own) return 1.0;
    const auto factor = factor_to_unit(unit, own);
    if (!factor && own == "degC")
      throw InputError(header_place(),
                       "the unit \"" + printable(unit) + "\" of column \"" + printable(header) +
                           "\" is not the degree Celsius",
                       "give it in degC, and name it " + column);
    if (!factor)
      throw InputError(
          header_place(),
          "the unit \"" + printable(unit) + "\" of column \"" + printable(header) + "\" does not fit " +
              column,
          "units of length: mm um nm m inch; of angles: deg gon rad mrad urad arcsec; s, degC, mm/min");
    return *factor;
  }

  const std::vector<double>& column(const std::string& name) const {
    return std::ranges::find(readings_.columns, name, &ImportedColumn::name)->values;
  }

  void shift_positions(AxisName axis) {
    const auto found = std::ranges::find(readings_.columns, position_column(axis), &ImportedColumn::name);
    const double shift = shift_of(axis, found->values, {source_.path, layout_.rows.front().line}, answers_);
    if (shift == 0.0) return;
    for (double& value : found->values) value += shift;
    add_fact(std::string(1, letter_of(axis)), shift_text(axis, shift), "--at");
  }

  /// The linear axis along which deviations of position are read: the only one that moves.
  std::optional<AxisName> read_along() const {
    const bool deviations = readings_.instrument->traits.line_reading == LineReading::Along &&
                            std::ranges::any_of(readings_.columns, [](const ImportedColumn& one) {
                              return one.name == "deviation_um";
                            });
    std::vector<AxisName> moving;
    for (const AxisName axis : listed_) {
      if (varies(column(position_column(axis)))) moving.push_back(axis);
    }
    const bool one = deviations && moving.size() == 1 && !is_rotary(moving[0]);
    return one && !answers_.keys.contains("direction") ? std::optional(moving[0]) : std::nullopt;
  }

  AxisPosition position_of_row(std::size_t row) const {
    AxisPosition position{};
    for (const Axis& axis : machine_.axes)
      position[index_of(axis.name)] =
          column(position_column(axis.name))[row] * position_unit(axis.name).si_per_unit;
    return position;
  }

  /// A deviation is measured minus target, in whatever order the targets were approached.
  void add_direction(AxisName axis) {
    const auto& positions = column(position_column(axis));
    const auto [low, high] = std::ranges::minmax_element(positions);
    const KinematicChain chain(machine_);
    const auto point_w = [&](auto place) {
      return chain.nominal_point_w(position_of_row(static_cast<std::size_t>(place - positions.begin())),
                                   machine_.tools.at(tool_).offset);
    };
    const Eigen::Vector3d beam_w = (point_w(high) - point_w(low)).normalized();
    std::string text;
    for (const double x : beam_w)
      text +=
          (text.empty() ? "" : ", ") + number_text(std::round(x * kRoundDirection) / kRoundDirection + 0.0);
    readings_.keys["direction"] = "[" + text + "]";
    add_fact("direction", std::string("along + of ") + letter_of(axis),
             "a deviation is measured minus target");
  }

  void choose_instrument() {
    std::vector<std::string> fitting;
    for (const Instrument* instrument : instruments()) {
      const InstrumentSchema& schema = instrument->schema();
      if (answers_.instrument && schema.name != *answers_.instrument) continue;
      const bool fits = has_a_set(schema);
      if (!fits && !answers_.instrument) continue;
      fitting.push_back(schema.name);
      readings_.instrument = &schema;
    }
    if (answers_.instrument && fitting.empty()) {
      std::vector<std::string> names;
      for (const Instrument* instrument : instruments()) names.push_back(instrument->schema().name);
      throw InputError({}, "instrument \"" + printable(*answers_.instrument) + "\" is not known",
                       suggest_name(*answers_.instrument, names, "instruments"));
    }
    if (fitting.empty())
      throw InputError(header_place(),
                       "no column is understood as a reading: " + printable(join_names(layout_.header)),
                       "name it as campaigns do, e.g. deviation_um, displacement_mm, length_mm, angle_urad, "
                       "or ex_um, ey_um, ez_um");
    if (fitting.size() > 1)
      ask_for(source_, "which instrument measured", "--instrument NAME: " + join_names(fitting));
    add_fact("instrument", fitting.front(), answers_.instrument ? "--instrument" : "its columns");
  }

  bool has_a_set(const InstrumentSchema& schema) const {
    for (std::size_t set = 0; set < schema.column_sets.size(); ++set) {
      if (has_all(schema.file_columns(set))) return true;
    }
    return false;
  }

  bool has_all(const std::vector<ColumnSchema>& set) const {
    return std::ranges::all_of(set, [&](const ColumnSchema& column) {
      return std::ranges::find(readings_.columns, column.column, &ImportedColumn::name) !=
             readings_.columns.end();
    });
  }

  const ImportSource& source_;
  const ImportAnswers& answers_;
  const Machine& machine_;
  std::size_t tool_;
  TableLayout layout_;
  std::vector<AxisName> listed_;  ///< whose positions stand in the table
  ImportedReadings readings_;
};

class GenericCsvFormat final : public ImportFormat {
 public:
  std::string_view name() const override { return "csv"; }
  std::string_view summary() const override {
    return "tables of numbers below a header; what columns mean is guessed, shown and confirmed";
  }
  bool recognises(const ImportSource& source) const override {
    try {
      return !guess_table_layout(source).header.empty();
    } catch (const InputError&) {
      return false;
    }
  }
  ImportedReadings read(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
                        std::size_t tool) const override {
    return GenericCsv(source, answers, machine, tool).read();
  }
};

}  // namespace

const ImportFormat& generic_csv_format() {
  static const GenericCsvFormat format;
  return format;
}

}  // namespace volcal
