#include <fmt/format.h>

#include <map>
#include <utility>

#include "volcal/identify/compensation/formats/sinumerik_program.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& sinumerik_format();

namespace {

constexpr std::string_view kEncFile = "AX_EEC.INI";
constexpr std::string_view kEncHeader = "%_N_AX_EEC_INI";
constexpr std::string_view kEnc = "$AA_ENC_COMP";

/// A positive value moves the axis in the negative direction: values are errors.
std::vector<TableFile> write_enc_comp(const FitResult& result, const TableFormatOptions& options) {
  std::string text = fmt::format("{}\nCHANDATA(1)\n", kEncHeader);
  for (const SampledTable& sampled : sample_axis_tables(sinumerik_format(), result, options)) {
    const std::string axis = sinumerik_axis_name(letter_of(sampled.output));
    const auto& positions = sampled.table.position;
    text += fmt::format("; MD38000 $MA_MM_ENC_COMP_MAX_POINTS[0,{}] must be at least {}\n", axis,
                        positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
      text += fmt::format("{}[0,{},{}]={:.6f}\n", kEnc, i, axis,
                          without_negative_zero(-sampled.table.forward[i]) / kMetrePerMillimetre);
    text += fmt::format(
        "{0}_STEP[0,{1}]={2:.6f}\n{0}_MIN[0,{1}]={3:.6f}\n{0}_MAX[0,{1}]={4:.6f}\n"
        "{0}_IS_MODULO[0,{1}]=0\n",
        kEnc, axis, options.step / kMetrePerMillimetre, positions.front() / kMetrePerMillimetre,
        positions.back() / kMetrePerMillimetre);
  }
  return {{std::string(kEncFile), text + "M17\n"}};
}

void read_enc_assignment(const SinumerikAssignment& assignment, std::map<AxisName, SinumerikValues>& tables) {
  const std::string_view name =
      std::string_view(assignment.variable).substr(std::min(kEnc.size(), assignment.variable.size()));
  if (!assignment.variable.starts_with(kEnc))
    throw InputError(assignment.place, "the variable is no $AA_ENC_COMP", "delete the line");
  if (sinumerik_index(assignment, 0) != 0)
    throw InputError(assignment.place, "the encoder is not 0", "tables are for the first encoder");
  if (assignment.indices.size() < 2)
    throw InputError(assignment.place, "the machine axis is missing", "write X1, Y1 or Z1 as the last index");
  SinumerikValues& table = tables[sinumerik_axis(assignment.indices.back(), assignment.place)];
  table.place = assignment.place;
  const double value = sinumerik_number(assignment) * kMetrePerMillimetre;
  if (name.empty()) {
    table.value[sinumerik_index(assignment, 1)] = value;
  } else if (name == "_STEP") {
    table.step = value;
  } else if (name == "_MIN") {
    table.low = value;
  } else if (name == "_MAX") {
    table.high = value;
  } else if (name != "_IS_MODULO" || value != 0.0) {
    throw InputError(assignment.place, assignment.variable.substr(0, 60) + " is not read here",
                     "linear axes have STEP, MIN, MAX and IS_MODULO = 0");
  }
}

AxisTable encoder_table(AxisName axis, const SinumerikValues& values) {
  AxisTable table{.input = axis, .position = sinumerik_positions(values), .forward = {}, .backward = {}};
  for (const auto& [index, value] : values.value) table.forward.push_back(-value);
  table.backward = table.forward;
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
          "machine axes X1, Y1, Z1",
      .source =
          "Siemens, SINUMERIK Function Manual Extended Functions, K3 Compensations, 03/2013, Interpolatory "
          "compensation: linear between points, a positive value moves the axis in the negative direction",
      .verified = "read back by volcal; not tried on a controller",
      .supported = CompensationPart::Positioning,
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
