#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "volcal/identify/tables/sampled_tables.h"
#include "volcal/identify/tables/sinumerik_program.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& sinumerik_cec_format();

namespace {

constexpr std::string_view kCecFile = "NC_CEC.INI";
constexpr std::string_view kCecHeader = "%_N_NC_CEC_INI";
constexpr std::string_view kCec = "$AN_CEC";
constexpr std::string_view kSignComment = ";VOLCAL VALUES ARE ";

constexpr std::array<TableSetting, 2> kCecSettings = {
    {{"cec_sign",
      "error or compensation: what a positive value means on this control. Manuals do not agree: load one "
      "table "
      "with one large value and look which way the axis moves; towards - means error",
      "", "error"},
     {"max_tables", "tables that the control has", "8", "62"}}};

bool same_in_both_directions(const AxisTable& table) {
  for (std::size_t i = 0; i < table.position.size(); ++i) {
    if (std::abs(table.forward[i] - table.backward[i]) > 0.5e-9) return false;
  }
  return true;
}

class CecWriter {
 public:
  CecWriter(double sign, double step) : sign_(sign), step_(step) {}

  void add(const SampledTable& sampled) {
    if (same_in_both_directions(sampled.table)) {
      add_table(sampled, sampled.table.forward, 0);
    } else {
      add_table(sampled, sampled.table.forward, 1);
      add_table(sampled, sampled.table.backward, -1);
    }
  }
  int tables() const { return tables_; }
  const std::string& text() const { return text_; }

 private:
  void add_table(const SampledTable& sampled, const std::vector<double>& corrections, int direction) {
    const auto& positions = sampled.table.position;
    for (std::size_t i = 0; i < positions.size(); ++i)
      text_ += fmt::format("{}[{},{}]={:.6f}\n", kCec, tables_, i,
                           without_negative_zero(sign_ * corrections[i]) / kMetrePerMillimetre);
    text_ += fmt::format(
        "{0}_INPUT_AXIS[{1}]=({2})\n{0}_OUTPUT_AXIS[{1}]=({3})\n{0}_STEP[{1}]={4:.6f}\n"
        "{0}_MIN[{1}]={5:.6f}\n{0}_MAX[{1}]={6:.6f}\n{0}_DIRECTION[{1}]={7}\n"
        "{0}_MULT_BY_TABLE[{1}]=0\n{0}_IS_MODULO[{1}]=0\n",
        kCec, tables_, sinumerik_axis_name(letter_of(sampled.table.input)),
        sinumerik_axis_name(letter_of(sampled.output)), step_ / kMetrePerMillimetre,
        positions.front() / kMetrePerMillimetre, positions.back() / kMetrePerMillimetre, direction);
    ++tables_;
  }

  double sign_;
  double step_;
  int tables_ = 0;
  std::string text_;
};

/// +1 where values are corrections, -1 where they are errors.
double cec_sign(const TableFormatOptions& options) {
  const std::string sign = table_setting(kCecSettings, options, "cec_sign");
  if (sign == "compensation") return 1.0;
  if (sign == "error") return -1.0;
  throw InputError({}, "sinumerik-cec: the sign of $AN_CEC values is not confirmed",
                   "find it out on the machine (--list says how), then give --set cec_sign=error or "
                   "--set cec_sign=compensation");
}

std::vector<TableFile> write_cec(const FitResult& result, const TableFormatOptions& options) {
  const double sign = cec_sign(options);
  const double most = table_setting_number(kCecSettings, options, "max_tables");
  CecWriter writer(sign, options.step);
  for (const SampledTable& sampled : sample_axis_tables(sinumerik_cec_format(), result, options))
    writer.add(sampled);
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
  return sinumerik_axis(assignment.value, assignment.place);
}

double cec_length(const CecTable& table, const std::string& name) {
  return sinumerik_number(cec_setting(table, name)) * kMetrePerMillimetre;
}

CorrectionTerm cec_term(CecTable table, double sign) {
  table.values.step = cec_length(table, "_STEP");
  table.values.low = cec_length(table, "_MIN");
  table.values.high = cec_length(table, "_MAX");
  for (const char* name : {"_MULT_BY_TABLE", "_IS_MODULO"}) {
    if (sinumerik_number(cec_setting(table, name)) != 0.0)
      throw InputError(cec_setting(table, name).place, std::string(kCec) + name + " is not 0",
                       "neither products of tables nor modulo axes are read here");
  }
  const double direction = sinumerik_number(cec_setting(table, "_DIRECTION"));
  if (direction != 0.0 && std::abs(direction) != 1.0)
    throw InputError(cec_setting(table, "_DIRECTION").place, "DIRECTION is neither 0, 1 nor -1",
                     "0 = both directions, 1 = towards +, -1 = towards -");
  AxisTable axis_table{.input = cec_axis(table, "_INPUT_AXIS"),
                       .position = sinumerik_positions(table.values),
                       .forward = {},
                       .backward = {}};
  for (const auto& [index, value] : table.values.value) {
    axis_table.forward.push_back(direction < 0.0 ? 0.0 : sign * value);
    axis_table.backward.push_back(direction > 0.0 ? 0.0 : sign * value);
  }
  return axis_term(cec_axis(table, "_OUTPUT_AXIS"), std::move(axis_table));
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
      throw InputError(assignment.place, "the variable is no $AN_CEC", "delete the line");
    CecTable& table = tables[sinumerik_index(assignment, 0)];
    table.values.place = assignment.place;
    if (assignment.variable == kCec) {
      table.values.value[sinumerik_index(assignment, 1)] = sinumerik_number(assignment) * kMetrePerMillimetre;
    } else {
      table.settings[assignment.variable.substr(kCec.size())] = assignment;
    }
  }
  CompensationTables result;
  for (const auto& [number, table] : tables) result.terms.push_back(cec_term(table, sign));
  return result;
}

}  // namespace

const TableFormat& sinumerik_cec_format() {
  static const TableFormat format = {
      .name = "sinumerik-cec",
      .summary =
          "SINUMERIK sag and angularity compensation: NC_CEC.INI with $AN_CEC tables from machine axis to "
          "machine axis, by direction where there is reversal",
      .source =
          "Siemens, SINUMERIK Function Manual Extended Functions, K3 Compensations, 03/2013, Interpolatory "
          "compensation; 828D: 8 tables of 200 points",
      .verified =
          "read back by volcal; not tried on a controller, and the sign of the values is NOT confirmed: it "
          "must be given",
      .supported = CompensationType(CompensationPart::Positioning) | CompensationPart::Straightness |
                   CompensationPart::Squareness,
      .refusal =
          "a table has one input; products of tables (MULT_BY_TABLE) would give angular errors, but whether "
          "the factors then count by themselves is not stated publicly",
      .limits = {.points_per_table = 200, .resolution = 1e-9, .both_directions = true, .equidistant = true},
      .settings = kCecSettings,
      .write = write_cec,
      .read = read_cec};
  return format;
}

}  // namespace volcal
