#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/axis_position.h"
#include "volcal/identify/cli/options/picture.h"
#include "volcal/identify/cli/options/superimposed_tables.h"
#include "volcal/identify/cli/options/tables_options.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/report/text/compensation_text.h"
#include "volcal/identify/report/text/correction_text.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/text/volumetric_text.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal::cli {
namespace {

/// All of them when none is named.
std::vector<Tool> chosen_tools(const Machine& machine, const std::string& name) {
  if (name.empty()) return machine.functional_tools();
  TableFormatOptions options;
  options.tool = name;
  return {tool_of(machine, options)};
}

std::vector<AxisPosition> points_of(const FitResult& result, const TablesArguments& arguments) {
  // A rotary axis that is not named and of which nothing was identified stands where its errors are known.
  Machine machine = result.machine;
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  for (Axis& axis : machine.axes) {
    if (is_rotary(axis.name) && std::ranges::find(identified, axis.name) == identified.end())
      axis.home = reference_of(result, axis.name);
  }
  std::vector<AxisPosition> points;
  for (const std::string& point : arguments.at) points.push_back(axis_position("--at", point, machine));
  return points;
}

std::vector<VolumetricError> errors_at_points(const FitResult& result, const TablesArguments& arguments) {
  std::vector<VolumetricError> errors;
  const Conditions conditions = conditions_of(result, arguments.conditions);
  const ApproachDirection direction = approach_direction("--approach", arguments.approach, result.machine);
  for (const Tool& tool : chosen_tools(result.machine, arguments.tool)) {
    const ErrorField field(result, tool, conditions);
    const std::size_t first = errors.size();
    for (const AxisPosition& position : points_of(result, arguments)) {
      require_identified_rotary_axes(result, position);
      errors.push_back(volumetric_error(result, field, position, tool, direction));
      if (arguments.conditions.no_extrapolation)
        require_measured("--at " + arguments.at[errors.size() - 1 - first], result.machine, field.measured(),
                         position, errors.back());
    }
  }
  return errors;
}

/// That these errors are used for: those of the tables and of --at.
std::vector<std::string> tools_asked_for(const FitResult& result, const TablesArguments& arguments,
                                         const std::optional<MadeTables>& made) {
  std::vector<std::string> names;
  if (made) names.push_back(tool_of(result.machine, made->options).name);
  if (arguments.at.empty()) return names;
  for (const Tool& tool : chosen_tools(result.machine, arguments.tool)) names.push_back(tool.name);
  return names;
}

/// Of the points of --at, where no tables say it.
std::vector<Finding> left_out_at_points(const FitResult& result, const std::optional<MadeTables>& made) {
  return made ? std::vector<Finding>{} : effects_in_no_figure(result);
}

bool makes_tables(const TablesArguments& arguments) { return !arguments.output.empty() || arguments.dry_run; }

void require_picture_of_tables(const TablesArguments& arguments) {
  if (!makes_tables(arguments))
    throw InputError({}, "--picture needs tables, and none are made", "give -o FOLDER or --dry-run");
  require_picture("--picture", arguments.picture);
}

/// Texts of --record, and of the certificate's campaign what --record does not say.
TableRecord record_of(const TablesArguments& arguments, const std::optional<CertificateSources>& sources) {
  TableRecord record{arguments.result, named_values("--record", arguments.records)};
  if (!sources) return record;
  for (const std::string_view key : recordable_conditions()) {
    const std::string text = sources->record.entry(key);
    if (!text.empty()) record.conditions.emplace(key, text);
  }
  return record;
}

TableFormatOptions table_options(const TableFormat& format, const FitResult& result,
                                 const TablesArguments& arguments) {
  TableFormatOptions options;
  options.functions.positions = arguments.positions.value_or(0);
  options.functions.zero_plus = arguments.zero == "plus";
  if (arguments.grid) options.grid_per_axis = *arguments.grid;
  options.type =
      arguments.type.empty() ? default_type(format, result) : CompensationType::parse(arguments.type);
  options.tool = arguments.tool;
  options.step = arguments.step_mm * kMetrePerMillimetre;
  options.rotary_step = arguments.rotary_step_deg * kRadianPerDegree;
  if (!arguments.lines.empty()) options.lines = axis_position("--lines", arguments.lines, result.machine);
  options.settings = named_values("--set", arguments.settings);
  options.conditions = conditions_of(result, arguments.conditions);
  if (!arguments.superimpose.empty()) options.active = active_tables(arguments.superimpose);
  return options;
}

MadeTables make_tables(const FitResult& result, const TablesArguments& arguments,
                       const std::optional<CertificateSources>& sources) {
  const TableFormat& format = *find_table_format(arguments.format);
  TableFormatOptions options = table_options(format, result, arguments);
  options.record = record_of(arguments, sources);
  return make_tables(format, result, options, arguments.tolerance_um * kMetrePerMicrometre);
}

std::vector<std::string> file_names(const MadeTables& made) {
  std::vector<std::string> names;
  for (const TableFile& file : made.files) names.push_back(file.name);
  return names;
}

/// The tables, and the certificate.
std::vector<std::string> written_names(const MadeTables& made, const TablesArguments& arguments) {
  std::vector<std::string> names = file_names(made);
  if (!arguments.certificate.campaign.empty()) names.emplace_back(kCertificatePage);
  if (arguments.certificate.pdf) names.emplace_back(kCertificatePdf);
  return names;
}

/// What --record says beside or instead of the campaign.
MeasurementRecord stated_record(const CertificateSources& sources, const MadeTables& made) {
  MeasurementRecord record = sources.record;
  for (const auto& [key, text] : made.options.record.conditions) record.entries[key] = text;
  return record;
}

void write_files(const FitResult& result, const MadeTables& made, const TablesArguments& arguments,
                 const std::optional<CertificateSources>& sources) {
  AtomicFolder folder(arguments.output);
  for (const TableFile& file : made.files) folder.write(file);
  if (!arguments.superimpose.empty())
    keep_former_folder(arguments.superimpose, result.active_compensations, folder);
  if (sources) {
    const MeasurementRecord record = stated_record(*sources, made);
    write_certificate(arguments.certificate, {result, made, record, sources->before, sources->after},
                      report_options(), folder);
  }
  folder.commit();
}

std::string step_text(const MadeTables& made) {
  std::string text;
  if (made.options.step > 0.0) {
    text += fmt::format(", step {:g} mm", made.options.step / kMetrePerMillimetre);
    if (made.tolerance > 0.0)
      text += fmt::format(", at most {:.2f} um off the ideal compensation", made.step.deviation / kMicro);
  }
  if (made.options.rotary_step > 0.0)
    text += fmt::format(", rotary axes at most {:g} deg", made.options.rotary_step / kRadianPerDegree);
  return text;
}

void print_tables(const MadeTables& made, const TablesArguments& arguments, const FitResult& result) {
  const Machine& machine = result.machine;
  fmt::print("{} {}, {}{}\n", made.format->name, made.options.type.name(),
             functional_point_words(tool_of(machine, made.options).name), step_text(made));
  fmt::print("{}", conditions_text(result, *made.options.conditions));
  fmt::print("{}", volume_check_text(made.check, made.options.type));
  if (made.rotary_check) fmt::print("{}", rotary_check_text(*made.rotary_check, made.options.type));
  if (made.all_axes) fmt::print("{}", all_axes_text(*made.all_axes));
  fmt::print("Verified: {}.\n", made.format->verified);
  if (made.tolerance > 0.0 && !made.step.reached) {
    const std::string why =
        made.step.refusal.empty()
            ? "give --step for a finer table, or --tolerance for a coarser one"
            : fmt::format("a finer step is refused ({}); give --tolerance for what is enough",
                          made.step.refusal);
    fmt::print("! the tables are up to {:.3g} um off the ideal compensation, more than {:g} um: {}\n",
               made.step.deviation / kMicro, made.tolerance / kMicro, why);
  }
  if (!arguments.superimpose.empty())
    fmt::print("They replace {} and correct what it corrected too; before = with it.\n",
               arguments.superimpose);
  fmt::print("{}{}", findings_text(made.effects_left_out), findings_text(made.cautions));
  fmt::print("{}", findings_text(unmeasured_travel(result)));
  fmt::print("{}: {}\n", arguments.dry_run ? "not written" : arguments.output,
             fmt::join(written_names(made, arguments), ", "));
}

nlohmann::ordered_json tables_json(const MadeTables& made, const TablesArguments& arguments,
                                   const Machine& machine) {
  nlohmann::ordered_json json = {{"format", arguments.format},
                                 {"files", file_names(made)},
                                 {"type", made.options.type.name()},
                                 {"tool", tool_of(machine, made.options).name},
                                 {"step_mm", made.options.step / kMetrePerMillimetre},
                                 {"error_left", volume_check_json(made.check)},
                                 {"verified", made.format->verified}};
  if (made.options.rotary_step > 0.0) json["rotary_step_deg"] = made.options.rotary_step / kRadianPerDegree;
  if (made.rotary_check) json["rotary_error_left"] = rotary_check_json(*made.rotary_check);
  if (made.all_axes) json["all_axes_error_left"] = all_axes_json(*made.all_axes);
  add_findings("effects_in_no_table", made.effects_left_out, json);
  add_findings("cautions", made.cautions, json);
  if (!arguments.dry_run) json["folder"] = arguments.output;
  if (!arguments.certificate.campaign.empty()) json["certificate"] = kCertificatePage;
  if (!arguments.superimpose.empty()) json["superimposed_on"] = arguments.superimpose;
  if (made.tolerance > 0.0) {
    json["tolerance_um"] = made.tolerance / kMicro;
    json["deviation_um"] = made.step.deviation / kMicro;
    json["tolerance_reached"] = made.step.reached;
  }
  return json;
}

int list_formats(bool json) {
  if (json) {
    fmt::print("{}\n", table_formats_json().dump(2));
  } else {
    fmt::print("{}", table_formats_text());
  }
  return kDone;
}

FitResult aligned_result(const TablesArguments& arguments) {
  if (!arguments.output.empty() && !arguments.dry_run) {
    require_output_folder(arguments.output,
                          {arguments.result, arguments.certificate.campaign, arguments.certificate.verified});
  }
  FitResult result = read_known_errors(arguments.result);
  if (!arguments.alignment.any()) return result;
  return align_result(result, alignment_of(result, arguments.alignment)).result;
}

/// About the size of a row of a grid file.
constexpr double kBytesOfGridRow = 150.0;
constexpr double kMostGridPoints = 1e7;

/// Throws InputError for a grid of more points than a table of it is read for.
void require_possible_grid(const Machine& machine, int per_axis) {
  const auto axes = static_cast<double>(machine.main_linear_axes().size());
  const auto tools = static_cast<double>(machine.functional_tools().size());
  const double points = tools * std::pow(per_axis, axes);
  if (points <= kMostGridPoints) return;
  throw InputError({},
                   fmt::format("--grid {} makes {:.3g} million points of {} tools, files of {:.2g} GB",
                               per_axis, points * 1e-6, tools, points * kBytesOfGridRow * 1e-9),
                   fmt::format("give at most {}: ten million points are the most that is written",
                               std::floor(std::pow(kMostGridPoints / tools, 1.0 / axes))));
}

int run_tables(const TablesArguments& arguments) {
  if (arguments.list) return list_formats(arguments.json);
  require_options_that_say_something(arguments);
  if (!arguments.picture.empty()) require_picture_of_tables(arguments);
  const FitResult result = aligned_result(arguments);
  if (makes_tables(arguments) && arguments.format == "csv")
    require_possible_grid(result.machine, arguments.grid.value_or(TableFormatOptions{}.grid_per_axis));
  if (arguments.conditions.no_extrapolation) {
    const Conditions conditions = conditions_of(result, arguments.conditions);
    require_conditions_of_readings(result, conditions);
    if (makes_tables(arguments)) require_within_readings(result, conditions);
  }
  const std::vector<VolumetricError> errors = errors_at_points(result, arguments);
  const bool written = !arguments.output.empty() && !arguments.dry_run;
  const auto sources = certificate_sources(arguments.certificate, result, written);
  std::optional<MadeTables> made;
  if (makes_tables(arguments)) made = make_tables(result, arguments, sources);
  if (made && written) write_files(result, *made, arguments, sources);
  if (made && !arguments.picture.empty())
    write_picture("--picture", tables_picture(result, *made, report_options()), arguments.picture);
  if (arguments.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    if (made) json = tables_json(*made, arguments, result.machine);
    add_findings("invisible", result.rank.invisible, json);
    add_findings("contradicted", contradictions(result), json);
    json["conditions"] = conditions_json(result, conditions_of(result, arguments.conditions));
    add_findings("beyond_readings", unmeasured_travel(result), json);
    if (!errors.empty()) json["volumetric_errors"] = volumetric_json(result, errors);
    add_findings("effects_in_no_figure", left_out_at_points(result, made), json);
    add_findings("of_tables", findings_of_tables(result, tools_asked_for(result, arguments, made)), json);
    if (made && !errors.empty())
      json["corrections"] = corrections_json(result.machine, made->read_back, points_of(result, arguments));
    fmt::print("{}\n", json_text(json, 2));
  } else {
    if (!made) fmt::print("{}", conditions_text(result, conditions_of(result, arguments.conditions)));
    fmt::print("{}", volumetric_text(result, errors));
    if (made) {
      fmt::print("{}", corrections_text(result.machine, made->read_back, points_of(result, arguments)));
      print_tables(*made, arguments, result);
    }
    fmt::print("{}{}", findings_text(left_out_at_points(result, made)),
               findings_text(findings_of_tables(result, tools_asked_for(result, arguments, made))));
    fmt::print("{}{}", findings_text(result.rank.invisible), findings_text(contradictions(result)));
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define_tables(CLI::App& app) {
  auto arguments = std::make_shared<TablesArguments>();
  add_tables_options(app, *arguments);
  return [arguments] { return run_tables(*arguments); };
}

}  // namespace

const Command& tables_command() {
  static const Command command = {
      "tables",
      "write the tables of an identified machine for a controller and say what they leave, or print its "
      "error at points",
      "  volcal tables --list\n"
      "  volcal tables result -o tables\n"
      "  volcal tables result --positions 101 --grid 9 -o tables\n"
      "  volcal tables result --format csv --tool side_x --dry-run\n"
      "  volcal tables result --align spindle --origin Z=0 -o tables\n"
      "  volcal tables again --format neutral-csv --superimpose tables -o tables-2\n"
      "  volcal tables result --format linuxcnc --certificate campaign.toml -o comp\n"
      "  volcal tables result --at X=100,Y=150,Z=-80 --tool short\n",
      define_tables};
  return command;
}

}  // namespace volcal::cli
