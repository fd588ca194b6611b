#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& heidenhain_format();

namespace {

constexpr std::string_view kCmaFile = "CONFIG.CMA.txt";
constexpr std::string_view kTypedSuffix = ".txt";  // behind the name that the table has in the control
constexpr std::string_view kComSign = "; VOLCAL VALUES ARE ";
constexpr double kComDigit = 1e-7;  // m, of positions and values, and unit of a spacing
constexpr double kComRotaryDigit = 1e-4 * kRadianPerDegree;
constexpr double kSteepestCom = 64.0;  // spacing over the largest difference of neighbouring values
constexpr int kLargestSpacing = 23;    // exponent
constexpr std::size_t kMostComPoints = 256;
constexpr std::size_t kMostComDependencies = 10, kMostPointsOfAll = 640;

constexpr std::array<TableSetting, 2> kComSettings = {
    {{"sign",
      "error or compensation: what a positive value means on this control. The manuals show an error curve "
      "that is entered and call its values corrections; the sign is not confirmed: enter one table with one "
      "large value and look which way the axis moves; towards - means error",
      "", "error"},
     {"rows",
      "axispos: every row has its position, as in MANUALplus 620; spacing: a datum and a spacing of 2^n x "
      "0.1 um, as in TNC 407, 415, 425, for which --step is rounded down",
      "axispos", "axispos"}}};

double com_digit(AxisName axis) { return is_rotary(axis) ? kComRotaryDigit : kComDigit; }
/// m of a mm, rad of a degree.
double com_unit(AxisName axis) { return is_rotary(axis) ? kRadianPerDegree : kMetrePerMillimetre; }

/// What one axis does to others, values as they are typed, m; what a rotary axis does to itself, rad.
struct ComTable {
  AxisName input = AxisName::X;
  std::vector<double> position;
  std::vector<std::pair<AxisName, std::vector<double>>> columns;
};

std::string com_name(AxisName input) { return std::string(1, letter_of(input)) + ".COM"; }

/// Neighbouring values differ by a 64th of their distance at most.
void check_com_slope(const ComTable& table, std::size_t row, const SourcePlace& place) {
  if (row == 0) return;
  const double most = (table.position[row] - table.position[row - 1]) / kSteepestCom;
  for (const auto& [output, values] : table.columns) {
    if (std::abs(values[row] - values[row - 1]) <= most) continue;
    throw InputError(place,
                     fmt::format("{} = F({}) changes by more than {:.4f} {} between neighbouring points",
                                 letter_of(output), letter_of(table.input), most / com_unit(output),
                                 is_rotary(output) ? "deg" : "mm"),
                     "HEIDENHAIN controls take a 64th of the spacing at most; correct the machine first");
  }
}

/// Those of all tables together are limited where the spacing is a power of two.
void check_com_limits(const std::vector<ComTable>& tables, bool spacing, const SourcePlace& place) {
  std::size_t dependencies = 0, points = 0;
  for (const ComTable& table : tables) {
    dependencies += table.columns.size();
    points += table.columns.size() * table.position.size();
  }
  if (!spacing || (dependencies <= kMostComDependencies && points <= kMostPointsOfAll)) return;
  throw InputError(place,
                   fmt::format("heidenhain: {} dependencies with {} points are needed, the control has {} "
                               "with {}",
                               dependencies, points, kMostComDependencies, kMostPointsOfAll),
                   "give a larger --step or leave a type out");
}

// ---- Writing

double com_sign(const TableFormatOptions& options) {
  return is_first_word(kComSettings, options, "sign", "compensation", "error") ? 1.0 : -1.0;
}

bool has_spacing(const TableFormatOptions& options) {
  return is_first_word(kComSettings, options, "rows", "spacing", "axispos");
}

int spacing_below(double step) {
  const int exponent = static_cast<int>(std::floor(std::log2(step / kComDigit) + 1e-9));
  return std::clamp(exponent, 0, kLargestSpacing);
}

double com_step(const TableFormatOptions& options) {
  return has_spacing(options) ? std::ldexp(kComDigit, spacing_below(options.step)) : options.step;
}

/// mm or deg; 0.0 in place of what would be written as -0.0000.
double com_value(double value, AxisName axis) {
  const double digit = com_digit(axis);
  return without_negative_zero(std::round(value / digit) * digit) / com_unit(axis);
}

/// With a spacing the curve begins with 0 at the datum, which moves the zero of the axis.
std::vector<double> com_column(const AxisTable& table, AxisName output, double sign, bool spacing) {
  std::vector<double> values;
  for (const double correction : table.forward) {
    const double from_datum = correction - (spacing ? table.forward.front() : 0.0);
    values.push_back(com_value(sign * from_datum, output) * com_unit(output));
  }
  return values;
}

/// R-POS: each rotary axis by its own position, a turn from 0 to 360.
void add_com_rotary(const FitResult& result, const TableFormatOptions& options, double sign,
                    std::vector<ComTable>& tables) {
  if (!options.type.has(CompensationPart::RotaryPositioning)) return;
  if (has_spacing(options))
    throw InputError({}, "heidenhain: rows of a spacing of 2^n x 0.0001 deg do not divide a turn evenly",
                     "give --set rows=axispos where the control has the column, or leave R-POS out");
  for (const SampledTable& sampled : sample_rotary_positioning(heidenhain_format(), result, options)) {
    const AxisTable table = turn_from_zero(sampled.table);
    tables.push_back({table.input, table.position, {}});
    tables.back().columns.emplace_back(sampled.output, com_column(table, sampled.output, sign, false));
  }
}

std::vector<ComTable> com_tables(const FitResult& result, const TableFormatOptions& options) {
  const double sign = com_sign(options);
  const bool spacing = has_spacing(options);
  std::vector<ComTable> tables;
  for (const SampledTable& sampled : sample_axis_tables(heidenhain_format(), result, options)) {
    if (tables.empty() || tables.back().input != sampled.table.input)
      tables.push_back({sampled.table.input, sampled.table.position, {}});
    tables.back().columns.emplace_back(sampled.output,
                                       com_column(sampled.table, sampled.output, sign, spacing));
  }
  add_com_rotary(result, options, sign, tables);
  for (const ComTable& table : tables) {
    for (std::size_t row = 0; row < table.position.size(); ++row) check_com_slope(table, row, {});
  }
  check_com_limits(tables, spacing, {});
  return tables;
}

std::string com_text(const ComTable& table, double sign, bool spacing, int exponent) {
  std::string text = fmt::format("{}{}\n", kComSign, sign > 0.0 ? "COMPENSATIONS" : "ERRORS");
  if (spacing)
    text +=
        fmt::format("DATUM {:.4f}\nSPACING {}\n", com_value(table.position.front(), table.input), exponent);
  text += spacing ? "NR" : "AXISPOS";
  for (const auto& [output, values] : table.columns) text += fmt::format(" {}", letter_of(output));
  text += '\n';
  for (std::size_t row = 0; row < table.position.size(); ++row) {
    text +=
        spacing ? fmt::format("{}", row) : fmt::format("{:.4f}", com_value(table.position[row], table.input));
    for (const auto& [output, values] : table.columns)
      text += fmt::format(" {:.4f}", com_value(values[row], output));
    text += '\n';
  }
  return text;
}

std::vector<TableFile> write_com(const FitResult& result, const TableFormatOptions& given) {
  TableFormatOptions options = given;
  const bool spacing = has_spacing(options);
  const int exponent = spacing_below(options.step);
  options.step = com_step(options);
  std::vector<TableFile> files;
  std::string causes = "ACTIVE", names = "*";
  for (const ComTable& table : com_tables(result, options)) {
    files.push_back({com_name(table.input) + std::string(kTypedSuffix),
                     com_text(table, com_sign(options), spacing, exponent)});
    causes += fmt::format(" {}", letter_of(table.input));
    names += " " + com_name(table.input);
  }
  files.push_back({std::string(kCmaFile), causes + "\n" + names + "\n"});
  return files;
}

// ---- Reading

/// Axes that the columns behind the first one are for, each once. `cause`: the axis that causes what they
/// hold; a rotary axis causes something in itself alone, and nothing else does.
std::vector<AxisName> com_columns(const TableLines& lines, std::span<const std::string_view> words,
                                  std::optional<AxisName> cause = {}) {
  std::vector<AxisName> axes;
  for (const std::string_view word : words) {
    const auto axis = word.size() == 1 ? axis_from_letter(word[0]) : std::nullopt;
    const bool right = axis && !is_parallel(*axis) &&
                       (!cause || *axis == *cause || (!is_rotary(*axis) && !is_rotary(*cause)));
    if (!right || std::ranges::find(axes, *axis) != axes.end())
      lines.fail("a column is named \"" + std::string(word.substr(0, 40)) + "\"",
                 "columns are for the axes X, Y and Z, each once; a rotary axis has its own alone");
    axes.push_back(*axis);
  }
  if (axes.empty()) lines.fail("no column is for an axis", "write the tables again");
  return axes;
}

/// Lines of a typed table; those that begin with ; are for people.
class ComReader {
 public:
  ComReader(const TableFile& file, AxisName input) : lines_(file) { table_.input = input; }

  ComTable read() {
    read_head();
    while (lines_.advance_to_content()) read_row(words_of(lines_.current()));
    if (table_.position.size() < 2) lines_.fail("the table has less than two rows", "write the tables again");
    return std::move(table_);
  }
  double sign() const { return sign_; }
  bool has_datum() const { return exponent_.has_value(); }

 private:
  void read_sign() {
    const std::string_view line = lines_.current();
    if (line == std::string(kComSign) + "COMPENSATIONS") sign_ = 1.0;
    if (line == std::string(kComSign) + "ERRORS") sign_ = -1.0;
    if (sign_ == 0.0)
      lines_.fail("the first line does not say what the values are",
                  "write " + std::string(kComSign) + "ERRORS or COMPENSATIONS there");
  }

  void read_head() {
    if (!lines_.advance_to_content()) lines_.fail("the file is empty", "write the tables again");
    read_sign();
    for (std::vector<std::string_view> words; lines_.advance_to_content();) {
      words = words_of(lines_.current());
      if (words.size() == 2 && words[0] == "DATUM") {
        datum_ = lines_.number(words[1], "the datum") * com_unit(table_.input);
      } else if (words.size() == 2 && words[0] == "SPACING") {
        exponent_ = lines_.integer(words[1], "the spacing");
        if (*exponent_ < 0 || *exponent_ > kLargestSpacing)
          lines_.fail("the spacing is out of range", "write an exponent of 2 from 0 to 23");
      } else {
        if (datum_.has_value() != exponent_.has_value())
          lines_.fail("DATUM and SPACING do not stand together", "write both above NR, or neither");
        if (words[0] != (has_datum() ? "NR" : "AXISPOS"))
          lines_.fail("the first column is neither AXISPOS nor, below DATUM and SPACING, NR",
                      "write the names of the columns above the rows");
        for (const AxisName axis : com_columns(lines_, std::span(words).subspan(1), table_.input))
          table_.columns.emplace_back(axis, std::vector<double>());
        return;
      }
    }
    lines_.fail("the line with the names of the columns is missing", "write the tables again");
  }

  double position_in(std::string_view word) {
    if (!has_datum()) return lines_.number(word, "the position") * com_unit(table_.input);
    const auto row = static_cast<int>(table_.position.size());
    if (lines_.integer(word, "the number") != row)
      lines_.fail(fmt::format("the row is not number {}", row), "number the rows from 0");
    return *datum_ + row * std::ldexp(com_digit(table_.input), *exponent_);
  }

  void read_row(const std::vector<std::string_view>& words) {
    if (words.size() != table_.columns.size() + 1)
      lines_.fail(
          fmt::format("the row has {} cells, the columns are {}", words.size(), table_.columns.size() + 1),
          "complete or delete the row");
    if (table_.position.size() == kMostComPoints)
      lines_.fail(fmt::format("a table holds {} rows", kMostComPoints), "write fewer rows");
    const double position = position_in(words[0]);
    require_ascending(table_.position, position, lines_.place());
    table_.position.push_back(position);
    for (std::size_t i = 0; i < table_.columns.size(); ++i)
      table_.columns[i].second.push_back(lines_.number(words[i + 1], "the value") *
                                         com_unit(table_.columns[i].first));
    check_com_slope(table_, table_.position.size() - 1, lines_.place());
  }

  TableLines lines_;
  double sign_ = 0.0;
  std::optional<double> datum_;
  std::optional<int> exponent_;
  ComTable table_;
};

void add_com_terms(const ComTable& table, double sign, CompensationTables& tables) {
  for (const auto& [output, values] : table.columns) {
    AxisTable axis_table{.input = table.input, .position = table.position, .forward = {}, .backward = {}};
    for (const double value : values) axis_table.forward.push_back(sign * value);
    axis_table.backward = axis_table.forward;
    if (is_rotary(table.input) && make_a_turn(table.position)) axis_table.beyond = BeyondEnds::Repeat;
    tables.terms.push_back(axis_term(output, std::move(axis_table)));
  }
}

/// Names of the tables of the active line, by the axis that causes what they hold.
std::vector<std::pair<AxisName, std::string>> active_com_tables(const TableFile& file) {
  TableLines lines(file);
  std::vector<std::pair<AxisName, std::string>> active;
  if (!lines.advance_to_content() || words_of(lines.current())[0] != "ACTIVE")
    lines.fail("the first column is not ACTIVE", "write ACTIVE and the axes above the rows");
  const std::string head(lines.current());
  const auto names = words_of(head);
  const std::vector<AxisName> causes = com_columns(lines, std::span(names).subspan(1));
  while (lines.advance_to_content()) {
    const auto words = words_of(lines.current());
    if (words[0] != "*") continue;
    if (!active.empty()) lines.fail("two lines are active", "leave the * at one of them");
    if (words.size() != causes.size() + 1)
      lines.fail("the active line has another number of cells than columns", "name a table for every axis");
    for (std::size_t i = 0; i < causes.size(); ++i) active.emplace_back(causes[i], std::string(words[i + 1]));
  }
  if (active.empty()) lines.fail("no line is active", "write a * in the column ACTIVE");
  return active;
}

CompensationTables read_com(std::span<const TableFile> files) {
  const TableFile& assignment = file_named(files, kCmaFile);
  CompensationTables result;
  std::vector<ComTable> tables;
  bool spacing = false;
  for (const auto& [cause, name] : active_com_tables(assignment)) {
    ComReader reader(file_named(files, name + std::string(kTypedSuffix)), cause);
    tables.push_back(reader.read());
    spacing = spacing || reader.has_datum();
    add_com_terms(tables.back(), reader.sign(), result);
  }
  check_com_limits(tables, spacing, {assignment.name, 0});
  return result;
}

}  // namespace

const TableFormat& heidenhain_format() {
  static const TableFormat format = {
      .name = "heidenhain",
      .summary =
          "HEIDENHAIN nonlinear axis error compensation: compensation value tables (.COM) from axis to axis "
          "and their assignment (.CMA), of rotary axes their own positioning, as rows of the control's table "
          "editor",
      .source =
          "HEIDENHAIN, TNC 407/415/425 Technical Manual, 01.98, pages 4-27, 4-28, 4-31: datum, spacing 2^n x "
          "0.1 um, linear between points, 256 points a dependency, 10 dependencies, 640 points; MANUALplus "
          "620 Technical Manual, 01/2012, pages 713 to 718: AXISPOS, a column per axis, ACTIVE; TNC 306, "
          "03.97, page 4-21: 1/64 of the spacing; TNC 360, 08.95, page 4-24: zero at the datum; iTNC 530 "
          "HSCI, "
          "page 680: positioning of rotary axes in .COM",
      .verified =
          "read back by volcal; not tried on a controller. The sign of the values is NOT confirmed: it must "
          "be given. The text of .COM and .CMA files is not public: the rows are to be entered in the table "
          "editor. One value for both directions: what BACKLASH does to columns of other axes is not stated. "
          "Of "
          "rotary axes the unit, deg, and rows from 0 to 360 for a turn are inferred",
      .supported = CompensationType(CompensationPart::Positioning) | CompensationPart::Straightness |
                   CompensationPart::Squareness,
      .rotary = CompensationPart::RotaryPositioning,
      .refusal =
          "a compensation value table depends on one axis; angular errors take KinematicsComp, whose chain "
          "of transformations is the machine builder's",
      .limits = {.points_per_table = static_cast<int>(kMostComPoints),
                 .resolution = kComDigit,
                 .equidistant = true},
      .settings = kComSettings,
      .write = write_com,
      .read = read_com,
      .step_of = com_step};
  return format;
}

}  // namespace volcal
