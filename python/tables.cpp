#include "volcal/python/tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "volcal/identify/io/campaign/record_reader.h"
#include "volcal/identify/io/results/former_tables.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/compensation_text.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/today.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/findings.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

const TableFormat& format_named(const std::string& name) {
  const TableFormat* format = find_table_format(name);
  if (format != nullptr) return *format;
  for (const RefusedFormat& refused : refused_table_formats()) {
    if (refused.name == name)
      throw InputError({}, fmt::format("{} is not written: {}", name, refused.reason),
                       "choose another format");
  }
  throw InputError({}, name + " is not a table format",
                   fmt::format("there are {}", fmt::join(table_format_names(), ", ")));
}

Tables tables_of(const Result& result, const std::string& format_name, const std::string& type,
                 const std::string& tool, double step_mm, double rotary_step_deg, double tolerance_um,
                 const py::dict& settings, const py::dict& conditions, int positions, int grid,
                 const std::string& zero, const std::string& run, const py::dict& record,
                 const py::dict& lines, std::shared_ptr<Tables> superimpose) {
  if (zero != "mean" && zero != "plus")
    throw InputError({}, "zero \"" + zero + "\" is not known", "choose \"mean\" or \"plus\"");
  if (step_mm != 0.0 && tolerance_um != 0.0)
    throw InputError({}, "tolerance_um and step_mm are given, and each says where positions are",
                     "leave one of the two out");
  const TableFormat& format = format_named(format_name);
  TableFormatOptions options;
  options.functions.positions = positions;
  options.functions.zero_plus = zero == "plus";
  options.grid_per_axis = grid;
  options.type = type.empty() ? default_type(format, result.result) : CompensationType::parse(type);
  options.tool = tool;
  options.step = step_mm * kMetrePerMillimetre;
  options.rotary_step = rotary_step_deg * kRadianPerDegree;
  if (!lines.empty()) options.lines = position_of(result.result.machine, lines, "lines");
  options.settings = named_texts(settings);
  options.conditions = stated_conditions(result.result, named_texts(conditions));
  options.record = {run, named_texts(record)};
  if (superimpose != nullptr) options.active = superimpose->made.read_back;
  return without_lock([&] {
    return Tables{make_tables(format, result.result, options, tolerance_um * kMetrePerMicrometre),
                  std::move(superimpose), result.result.active_compensations};
  });
}

py::dict files_of(const Tables& tables) {
  py::dict files;
  for (const TableFile& file : tables.made.files) files[text_of(file.name)] = py::bytes(whole_content(file));
  return files;
}

void write_tables_folder(const Tables& tables, const std::filesystem::path& path) {
  without_lock([&] {
    AtomicFolder folder(path.string());
    for (const TableFile& file : tables.made.files) folder.write(file);
    if (tables.former != nullptr)
      keep_former_tables(tables.former->made.files, tables.active_compensations, folder);
    folder.commit();
  });
}

/// [record] of a campaign file, of a mapping, or, where nothing is given, of the file that the campaign is
/// of.
MeasurementRecord record_given(const py::object& given, const Campaign& campaign) {
  if (given.is_none()) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(campaign.file, ignored) ? read_campaign_record(campaign.file)
                                                                    : MeasurementRecord{};
  }
  if (!py::isinstance<py::dict>(given))
    return read_campaign_record(given.cast<std::filesystem::path>().string());
  return parse_record("[record]\n" + toml_lines(given), "record");
}

std::string certificate_of(const Result& result, const Tables& tables, const py::object& record,
                           const std::shared_ptr<Campaign>& verified) {
  if (result.campaign == nullptr)
    throw InputError({}, "the result was read from files, without its readings",
                     "fit the campaign again, or use volcal tables --certificate");
  const Campaign& campaign = *result.campaign;
  const MeasurementRecord recorded = record_given(record, campaign);
  return without_lock([&] {
    require_campaign_of(result.result, campaign);
    std::optional<MeasuredError> after;
    if (verified != nullptr) readings_for(*verified, result.result, {verified->file, 0});
    if (verified != nullptr) after = measured_error(*verified);
    return report_html(CertificateView{result.result, tables.made, recorded, measured_error(campaign), after},
                       {.date = today(), .provenance = provenance_of("volcal.certificate")});
  });
}

py::dict format_summaries() {
  py::dict formats;
  for (const TableFormat* format : table_formats())
    formats[py::str(std::string(format->name))] = py::str(std::string(format->summary));
  return formats;
}

}  // namespace

ActiveTables active_tables_of(const Tables& tables, const std::string& identified_with) {
  ActiveTables active{tables.made.read_back, {}, false};
  if (!names_compensations(identified_with)) return active;
  if (tables.former != nullptr) {
    active.is_doubtful = tables.active_compensations != identified_with;
    if (!active.is_doubtful) active.former = tables.former->made.read_back;
    return active;
  }
  const TableFile* metadata = find_file(tables.made.files, "metadata.csv");
  active.is_doubtful =
      metadata == nullptr || !stand_beside({metadata->name, whole_content(*metadata)}, identified_with);
  return active;
}

void define_tables(py::module_& module) {
  py::class_<Tables, std::shared_ptr<Tables>>(module, "Tables",
                                              "Tables for a controller, and what they leave of the errors.")
      .def_property_readonly("files", &files_of, "Content of every file by its name, bytes.")
      .def_property_readonly(
          "step_mm", [](const Tables& tables) { return tables.made.options.step / kMetrePerMillimetre; },
          "Step between the positions of a table, mm; 0 where the format has positions of its own.")
      .def_property_readonly(
          "rotary_step_deg",
          [](const Tables& tables) { return tables.made.options.rotary_step / kRadianPerDegree; },
          "Largest step between positions of rotary axes, deg; 0 where it is that of the format.")
      .def_property_readonly(
          "type", [](const Tables& tables) { return tables.made.options.type.name(); },
          "What is compensated (ISO/TR 16907, 8.2): \"L-VOL\".")
      .def_property_readonly(
          "error_left",
          [](const Tables& tables) { return from_json(json_text(volume_check_json(tables.made.check), -1)); },
          "Errors in the volume before, with the ideal compensation and with the tables as the controller "
          "reads them, "
          "um.")
      .def_property_readonly(
          "verified", [](const Tables& tables) { return text_of(std::string(tables.made.format->verified)); },
          "On what the format was verified.")
      .def_property_readonly(
          "effects_left_out", [](const Tables& tables) { return findings_of(tables.made.effects_left_out); },
          "What was identified but is in none of the tables.")
      .def_property_readonly(
          "cautions", [](const Tables& tables) { return findings_of(tables.made.cautions); },
          "What else there is to know before they are loaded.")
      .def_property_readonly(
          "rotary_error_left",
          [](const Tables& tables) -> py::object {
            if (!tables.made.rotary_check) return py::none();
            return from_json(json_text(rotary_check_json(*tables.made.rotary_check), -1));
          },
          "Errors of rotary axes before, with the ideal compensation and with the tables, um and urad; None "
          "without a type for rotary axes.")
      .def_property_readonly(
          "all_axes_error_left",
          [](const Tables& tables) -> py::object {
            if (!tables.made.all_axes) return py::none();
            return from_json(json_text(all_axes_json(*tables.made.all_axes), -1));
          },
          "Errors of all axes before and with the tables, over poses of all axes, um, and of the tool's "
          "axis, urad; None for a machine without rotary axes.")
      .def("write", &write_tables_folder, py::arg("path"),
           "Writes the files into a folder. Raises InputError.")
      .def("__repr__", [](const Tables& tables) {
        return text_of(fmt::format("<volcal.Tables {} {}, {} files>", tables.made.format->name,
                                   tables.made.options.type.name(), tables.made.files.size()));
      });
  module.def(
      "tables", &tables_of, py::arg("result"), py::kw_only(), py::arg("format") = "csv", py::arg("type") = "",
      py::arg("tool") = "", py::arg("step_mm") = 0.0, py::arg("rotary_step_deg") = 0.0,
      py::arg("tolerance_um") = 0.0, py::arg("settings") = py::dict(), py::arg("conditions") = py::dict(),
      py::arg("positions") = 0, py::arg("grid") = 5, py::arg("zero") = "mean", py::arg("run") = "",
      py::arg("record") = py::dict(), py::arg("lines") = py::dict(), py::arg("superimpose") = py::none(),
      "Tables of an identified machine for a controller, as `volcal tables`: the same bytes.\n\n"
      "format: a name of table_formats(). type: \"L-POS\", \"L-STR\", \"L-SQU\", \"L-ANG\" joined by +, or "
      "\"L-VOL\"; \"\" = all that the format can do. tool: \"\" = the machine's first. step_mm, "
      "rotary_step_deg: 0 = chosen "
      "so that "
      "the tables follow the ideal compensation within tolerance_um (0 = 0.2). settings: of the format, by "
      "name. "
      "conditions: {\"T_air\": 23.3, \"time_s\": 3600}. positions, grid, zero, run (which identification) "
      "and "
      "record: of csv tables. lines: where the specific lines of L-POS, L-STR and L-SQU cross, "
      "{\"x_mm\": 100.0}, axes not named at home; {} = the middle of the travel. superimpose: Tables that "
      "were "
      "active while the machine was measured; the new ones correct what these corrected, too, and keep them "
      "in their folder. Raises InputError.");
  module.def(
      "certificate", &certificate_of, py::arg("result"), py::arg("tables"), py::kw_only(),
      py::arg("record") = py::none(), py::arg("verified") = py::none(),
      "The certificate of a compensation as one HTML page: machine, operator, instruments, conditions and "
      "what else "
      "ISO/TR 16907:2015, 9.1, asks to be documented, the figures before and after, and fields to sign.\n\n"
      "record: the table [record] as a mapping, {\"serial_number\": \"4711\", \"instruments\": "
      "{\"laser-tracer\": "
      "\"No. 12\"}}, or the campaign.toml that has it; None = the file of the campaign. verified: a Campaign "
      "that was "
      "measured with the tables active. Raises InputError, and RuntimeError where volcal was built without "
      "the report.");
  module.def("table_formats", &format_summaries, "Table formats with a summary each.");
}

}  // namespace volcal::python
