#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "volcal/identify/compensation/formats/sinumerik_program.h"
#include "volcal/identify/compensation/product_tables.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& sinumerik_cec_format();

namespace {

constexpr std::string_view kCecFile = "NC_CEC.INI";
constexpr std::string_view kCecHeader = "%_N_NC_CEC_INI";
constexpr std::string_view kCec = "$AN_CEC";
constexpr double kMostCecTables = 1000.0;
constexpr std::string_view kSignComment = ";VOLCAL VALUES ARE ";

constexpr std::array<TableSetting, 2> kCecSettings = {
    {{"cec_sign",
      "error or compensation: what a positive value means on this control. Manuals do not agree: load one "
      "table "
      "with one large value and look which way the axis moves; towards - means error",
      "", "error"},
     {"max_tables", "tables that the control has", "8", "62"}}};

bool vanishes(const AxisTable& table) {
  const auto is_zero = [](double value) { return std::abs(value) < 0.5e-9; };
  return std::ranges::all_of(table.forward, is_zero) && std::ranges::all_of(table.backward, is_zero);
}

bool same_in_both_directions(const AxisTable& table) {
  for (std::size_t i = 0; i < table.position.size(); ++i) {
    if (std::abs(table.forward[i] - table.backward[i]) > 0.5e-9) return false;
  }
  return true;
}

/// Corrections as values of $AN_CEC.
class CecWriter {
 public:
  CecWriter(double sign, double step) : sign_(sign), step_(step) {}

  /// `multiplied_by`: number of the other table, 0 = none.
  void add(const SampledTable& sampled, int multiplied_by = 0) {
    if (same_in_both_directions(sampled.table)) {
      add_table(sampled, sampled.table.forward, 0, multiplied_by);
    } else {
      add_table(sampled, sampled.table.forward, 1, multiplied_by);
      add_table(sampled, sampled.table.backward, -1, multiplied_by);
    }
  }
  int tables() const { return tables_; }
  const std::string& text() const { return text_; }

 private:
  void add_table(const SampledTable& sampled, const std::vector<double>& corrections, int direction,
                 int multiplied_by) {
    const auto& positions = sampled.table.position;
    for (std::size_t i = 0; i < positions.size(); ++i)
      text_ += fmt::format("{}[{},{}]={:.6f}\n", kCec, tables_, i,
                           without_negative_zero(sign_ * corrections[i]) / kMetrePerMillimetre);
    text_ += fmt::format(
        "{0}_INPUT_AXIS[{1}]=({2})\n{0}_OUTPUT_AXIS[{1}]=({3})\n{0}_STEP[{1}]={4:.6f}\n"
        "{0}_MIN[{1}]={5:.6f}\n{0}_MAX[{1}]={6:.6f}\n{0}_DIRECTION[{1}]={7}\n"
        "{0}_MULT_BY_TABLE[{1}]={8}\n{0}_IS_MODULO[{1}]=0\n",
        kCec, tables_, sinumerik_axis_name(letter_of(sampled.table.input)),
        sinumerik_axis_name(letter_of(sampled.output)), step_ / kMetrePerMillimetre,
        positions.front() / kMetrePerMillimetre, positions.back() / kMetrePerMillimetre, direction,
        multiplied_by);
    ++tables_;
  }

  double sign_;
  double step_;
  int tables_ = 0;
  std::string text_;
};

/// Tables and products as $AN_CEC adds them up: a product of two tables' values, mm, counts in addition to
/// the values themselves, which the tables of one axis take back.
class CecProducts {
 public:
  CecProducts(ProductTables sampled, double sign) : sampled_(std::move(sampled)), sign_(sign) {
    for (const LeverProduct& product : sampled_.products) {
      if (!levers_.contains(product.lever)) add_lever(product.lever);
    }
  }

  void write(CecWriter& writer) {
    std::map<AxisName, int> number;
    for (const auto& [axis, lever] : levers_) {
      writer.add({axis, lever.table});
      number[axis] = writer.tables();
    }
    for (const LeverProduct& product : sampled_.products) {
      const SampledTable turned = at_reach(product);
      subtract(turned);
      writer.add(turned, number.at(product.lever));
    }
    for (const SampledTable& table : sampled_.tables) {
      if (!vanishes(table.table)) writer.add(table);
    }
  }

 private:
  struct Lever {
    double reach = 0.0;  ///< m, where the table has 1 mm
    AxisTable table;     ///< corrections, so that values come out as distances
  };

  void add_lever(AxisName axis) {
    Lever lever{0.0,
                {.input = axis, .position = table_of(axis, axis).position, .forward = {}, .backward = {}}};
    const double line = sampled_.lines[index_of(axis)];
    for (const double q : lever.table.position) lever.reach = std::max(lever.reach, std::abs(q - line));
    for (const double q : lever.table.position)
      lever.table.forward.push_back(sign_ * (q - line) / lever.reach * kMetrePerMillimetre);
    lever.table.backward = lever.table.forward;
    subtract({axis, lever.table});
    levers_.emplace(axis, std::move(lever));
  }

  SampledTable at_reach(const LeverProduct& product) const {
    SampledTable table{product.output, product.angle};
    const double reach = levers_.at(product.lever).reach;
    for (double& value : table.table.forward) value *= reach;
    for (double& value : table.table.backward) value *= reach;
    return table;
  }

  AxisTable& table_of(AxisName input, AxisName output) {
    return std::ranges::find_if(sampled_.tables,
                                [&](const SampledTable& sampled) {
                                  return sampled.output == output && sampled.table.input == input;
                                })
        ->table;
  }

  void subtract(const SampledTable& other) {
    AxisTable& table = table_of(other.table.input, other.output);
    for (std::size_t i = 0; i < table.position.size(); ++i) {
      table.forward[i] -= other.table.forward[i];
      table.backward[i] -= other.table.backward[i];
    }
  }

  ProductTables sampled_;
  double sign_;
  std::map<AxisName, Lever> levers_;
};

/// +1 where values are corrections, -1 where they are errors.
double cec_sign(const TableFormatOptions& options) {
  return is_first_word(kCecSettings, options, "cec_sign", "compensation", "error") ? 1.0 : -1.0;
}

std::vector<TableFile> write_cec(const FitResult& result, const TableFormatOptions& options) {
  const double sign = cec_sign(options);
  const double most = table_setting_number(kCecSettings, options, "max_tables");
  CecWriter writer(sign, options.step);
  if (options.type.is_separable()) {
    for (const SampledTable& sampled : sample_axis_tables(sinumerik_cec_format(), result, options))
      writer.add(sampled);
  } else {
    CecProducts(sample_product_tables(sinumerik_cec_format(), result, options), sign).write(writer);
  }
  if (writer.tables() > most)
    throw InputError(
        {}, fmt::format("sinumerik-cec: {} tables are needed, the control has {:g}", writer.tables(), most),
        "leave a type out (positioning fits sinumerik), or give --set max_tables=N as the control "
        "has");
  return {{std::string(kCecFile), fmt::format("{}\nCHANDATA(1)\n{}{}\n{}M17\n", kCecHeader, kSignComment,
                                              sign > 0.0 ? "COMPENSATIONS" : "ERRORS", writer.text())}};
}

struct CecTable {
  SinumerikValues values;  ///< as written
  std::map<std::string, SinumerikAssignment> settings;
};

const SinumerikAssignment& cec_setting(const CecTable& table, const std::string& name) {
  const auto found = table.settings.find(name);
  if (found == table.settings.end())
    throw InputError(table.values.place, std::string(kCec) + name + " is missing", "every table needs it");
  return found->second;
}

AxisName cec_axis(const CecTable& table, const std::string& name) {
  const SinumerikAssignment& assignment = cec_setting(table, name);
  return sinumerik_linear_axis(assignment.value, assignment.place);
}

double cec_length(const CecTable& table, const std::string& name) {
  return sinumerik_number(cec_setting(table, name)) * kMetrePerMillimetre;
}

/// Values as written, of the direction that the table is for, times `factor`.
AxisTable cec_values(CecTable table, double factor) {
  table.values.step = cec_length(table, "_STEP");
  table.values.low = cec_length(table, "_MIN");
  table.values.high = cec_length(table, "_MAX");
  if (sinumerik_number(cec_setting(table, "_IS_MODULO")) != 0.0)
    throw InputError(cec_setting(table, "_IS_MODULO").place, std::string(kCec) + "_IS_MODULO is not 0",
                     "modulo axes are not read here");
  const double direction = sinumerik_number(cec_setting(table, "_DIRECTION"));
  if (direction != 0.0 && std::abs(direction) != 1.0)
    throw InputError(cec_setting(table, "_DIRECTION").place, "DIRECTION is neither 0, 1 nor -1",
                     "0 = both directions, 1 = towards +, -1 = towards -");
  AxisTable values{.input = cec_axis(table, "_INPUT_AXIS"),
                   .position = sinumerik_positions(table.values),
                   .forward = {},
                   .backward = {}};
  for (const auto& [index, value] : table.values.value) {
    values.forward.push_back(direction < 0.0 ? 0.0 : factor * value);
    values.backward.push_back(direction > 0.0 ? 0.0 : factor * value);
  }
  return values;
}

/// Own values, and their product with those of another table, both in mm.
void add_cec_terms(const std::map<int, CecTable>& tables, const CecTable& table, double sign,
                   CompensationTables& result) {
  const AxisName output = cec_axis(table, "_OUTPUT_AXIS");
  result.terms.push_back(axis_term(output, cec_values(table, sign)));
  const SinumerikAssignment& multiplied = cec_setting(table, "_MULT_BY_TABLE");
  const double number = sinumerik_number(multiplied);
  if (number == 0.0) return;
  const auto other = number == std::floor(number) && std::abs(number) < kMostCecTables
                         ? tables.find(static_cast<int>(number) - 1)
                         : tables.end();
  if (other == tables.end())
    throw InputError(multiplied.place, fmt::format("there is no table number {:g}", number),
                     "MULT_BY_TABLE is 0 or the index of a table plus 1");
  result.terms.push_back(
      product_term(output, cec_values(table, sign), cec_values(other->second, 1.0 / kMetrePerMillimetre)));
}

/// The sign that the file was written for stands in a comment: the control does not know it.
double written_sign(const TableFile& file) {
  TableLines lines(file);
  while (lines.advance()) {
    if (!lines.current().starts_with(kSignComment)) continue;
    const std::string_view content = trimmed_text(lines.current().substr(kSignComment.size()));
    if (content == "COMPENSATIONS") return 1.0;
    if (content == "ERRORS") return -1.0;
    lines.fail("the sign comment is neither ERRORS nor COMPENSATIONS", "write the tables again");
  }
  lines.fail("the comment with the sign of the values is missing",
             "write " + std::string(kSignComment) + "ERRORS or COMPENSATIONS below CHANDATA(1)");
}

CompensationTables read_cec(std::span<const TableFile> files) {
  const TableFile& file = file_named(files, kCecFile);
  const double sign = written_sign(file);
  std::map<int, CecTable> tables;
  for (const SinumerikAssignment& assignment : sinumerik_assignments(file, kCecHeader)) {
    if (!assignment.variable.starts_with(kCec))
      throw InputError(assignment.place, "the variable is not $AN_CEC", "delete the line");
    CecTable& table = tables[sinumerik_index(assignment, 0)];
    table.values.place = assignment.place;
    if (assignment.variable == kCec) {
      table.values.value[sinumerik_index(assignment, 1)] = sinumerik_number(assignment) * kMetrePerMillimetre;
    } else {
      table.settings[assignment.variable.substr(kCec.size())] = assignment;
    }
  }
  CompensationTables result;
  for (const auto& [index, table] : tables) add_cec_terms(tables, table, sign, result);
  return result;
}

}  // namespace

const TableFormat& sinumerik_cec_format() {
  static const TableFormat format = {
      .name = "sinumerik-cec",
      .summary =
          "SINUMERIK sag and angularity compensation: NC_CEC.INI with $AN_CEC tables from machine axis to "
          "machine axis, by direction where there is reversal, multiplied for angular errors",
      .source =
          "Siemens, SINUMERIK Function Manual Extended Functions, K3 Compensations, 03/2013, Interpolatory "
          "compensation: a product of tables is added to the total of the compensation axis (rule 8, "
          "MULT_BY_TABLE); 828D: 8 tables of 200 points",
      .verified =
          "read back by volcal; not tried on a controller, and the sign of the values is NOT confirmed: it "
          "must be given; that the two tables of a product also count by themselves follows from the words "
          "of the manual",
      .supported = CompensationType::volumetric(),
      .rigid = true,
      .refusal = "it holds every type of the linear axes",
      .limits = {.points_per_table = 200, .resolution = 1e-9, .both_directions = true, .equidistant = true},
      .settings = kCecSettings,
      .write = write_cec,
      .read = read_cec};
  return format;
}

}  // namespace volcal
