#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "volcal/identify/compensation/formats/sinumerik_program.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& sinumerik_format();

namespace {

constexpr std::string_view kEncFile = "AX_EEC.INI";
constexpr std::string_view kEncHeader = "%_N_AX_EEC_INI";
constexpr std::string_view kEnc = "$AA_ENC_COMP";
constexpr int kDecimalsOfMillimetres = 6;
constexpr int kDecimalsOfDegrees = 8;  // 0.0002 urad

/// One table. A positive value moves the axis in the negative direction: values are errors, mm or deg.
std::string enc_table(AxisName name, const AxisTable& table, double step) {
  const std::string axis = sinumerik_axis_name(letter_of(name));
  const double unit = position_unit(name).si_per_unit;
  std::string text = fmt::format("; MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,{}] must be at least {}\n", axis,
                                 table.position.size());
  for (std::size_t i = 0; i < table.position.size(); ++i)
    text +=
        fmt::format("{}[0,{},{}]={:.{}f}\n", kEnc, i, axis, without_negative_zero(-table.forward[i]) / unit,
                    is_rotary(name) ? kDecimalsOfDegrees : kDecimalsOfMillimetres);
  return text + fmt::format(
                    "{0}_STEP[0,{1}]={2:.6f}\n{0}_MIN[0,{1}]={3:.6f}\n{0}_MAX[0,{1}]={4:.6f}\n"
                    "{0}_IS_MODULO[0,{1}]={5}\n",
                    kEnc, axis, step / unit, table.position.front() / unit, table.position.back() / unit,
                    table.beyond == BeyondEnds::Repeat ? 1 : 0);
}

std::vector<TableFile> write_enc_comp(const FitResult& result, const TableFormatOptions& options) {
  std::string text = fmt::format("{}\nCHANDATA(1)\n", kEncHeader);
  for (const SampledTable& sampled : sample_axis_tables(sinumerik_format(), result, options))
    text += enc_table(sampled.output, sampled.table, options.step);
  if (options.type.has(CompensationPart::RotaryPositioning)) {
    for (const SampledTable& sampled : sample_rotary_positioning(sinumerik_format(), result, options)) {
      const AxisTable table = turn_from_zero(sampled.table);
      text += enc_table(sampled.output, table, table.position[1] - table.position[0]);
    }
  }
  return {{std::string(kEncFile), text + "M17\n"}};
}

void read_enc_assignment(const SinumerikAssignment& assignment, std::map<AxisName, SinumerikValues>& tables) {
  const std::string_view name =
      std::string_view(assignment.variable).substr(std::min(kEnc.size(), assignment.variable.size()));
  if (!assignment.variable.starts_with(kEnc))
    throw InputError(assignment.place, "the variable is not $AA_ENC_COMP", "delete the line");
  if (sinumerik_index(assignment, 0) != 0)
    throw InputError(assignment.place, "the encoder is not 0", "tables are for the first encoder");
  if (assignment.indices.size() < 2)
    throw InputError(assignment.place, "the machine axis is missing",
                     "write X1, Y1, Z1, A1, B1 or C1 as the last index");
  const AxisName axis = sinumerik_axis(assignment.indices.back(), assignment.place);
  SinumerikValues& table = tables[axis];
  table.place = assignment.place;
  const double value = sinumerik_number(assignment) * position_unit(axis).si_per_unit;
  if (name.empty()) {
    table.value[sinumerik_index(assignment, 1)] = value;
  } else if (name == "_STEP") {
    table.step = value;
  } else if (name == "_MIN") {
    table.low = value;
  } else if (name == "_MAX") {
    table.high = value;
  } else if (name == "_IS_MODULO" && (value == 0.0 || (is_rotary(axis) && assignment.value == "1"))) {
    table.is_modulo = value != 0.0;
  } else {
    throw InputError(assignment.place, assignment.variable.substr(0, 60) + " is not read here",
                     "tables have STEP, MIN, MAX and IS_MODULO = 0, of rotary axes 0 or 1");
  }
}

/// A table that repeats is a turn of the axis and ends with the value that it begins with.
void require_turn(AxisName axis, const SinumerikValues& values) {
  constexpr double kSamePlace = 1e-6, kSameValue = 1e-9;  // deg
  const double turn = (*values.high - *values.low) / position_unit(axis).si_per_unit;
  const double step_over = (values.value.rbegin()->second - values.value.begin()->second) / kRadianPerDegree;
  if (std::abs(turn - 360.0) > kSamePlace || std::abs(step_over) > kSameValue)
    throw InputError(values.place, "a table with IS_MODULO = 1 is not a turn that ends as it begins",
                     "MAX - MIN must be 360, the last value the first one");
}

AxisTable encoder_table(AxisName axis, const SinumerikValues& values) {
  AxisTable table{.input = axis, .position = sinumerik_positions(values), .forward = {}, .backward = {}};
  for (const auto& [index, value] : values.value) table.forward.push_back(-value);
  table.backward = table.forward;
  if (values.is_modulo) {
    require_turn(axis, values);
    table.beyond = BeyondEnds::Repeat;
  }
  return table;
}

CompensationTables read_enc_comp(std::span<const TableFile> files) {
  std::map<AxisName, SinumerikValues> tables;
  const TableFile& file = file_named(files, kEncFile);
  for (const SinumerikAssignment& assignment : sinumerik_assignments(file, kEncHeader))
    read_enc_assignment(assignment, tables);
  CompensationTables result;
  for (const auto& [axis, table] : tables)
    result.terms.push_back(axis_term(axis, encoder_table(axis, table)));
  return result;
}

}  // namespace

const TableFormat& sinumerik_format() {
  static const TableFormat format = {
      .name = "sinumerik",
      .summary =
          "SINUMERIK leadscrew and measuring system error compensation: AX_EEC.INI with $AA_ENC_COMP of the "
          "machine axes X1, Y1, Z1, and A1, B1, C1 in deg (R-POS)",
      .source =
          "Siemens, SINUMERIK Function Manual Extended Functions, K3 Compensations, 03/2013, Interpolatory "
          "compensation: linear between points, a positive value moves the axis in the negative direction",
      .verified =
          "read back by volcal; not tried on a controller. Tables of rotary axes are in deg, of a turn with "
          "IS_MODULO = 1: their unit and repetition are inferred from those of linear axes, so move the axis "
          "over one large value first",
      .supported = CompensationPart::Positioning,
      .rotary = CompensationPart::RotaryPositioning,
      .refusal =
          "encoder tables act on their own axis only; sinumerik-cec has tables from axis to axis, and no "
          "public grammar of VCS is known",
      .limits = {.resolution = 1e-9, .equidistant = true},
      .settings = {},
      .write = write_enc_comp,
      .read = read_enc_comp};
  return format;
}

}  // namespace volcal
