#include "volcal/studies/files/study_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/result/identified_expansions.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal {
namespace {

constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();

void read_number(const TomlTable& table, const char* key, double& value, NumberLimits limits = kNotNegative) {
  if (const auto found = table.number(key, limits)) value = *found;
}

/// Table of `SYMBOL = number` in one unit, which the table's name ends in.
template <class Symbol, class Store>
void read_symbols(const TomlTable& parent, const std::string& name, bool rotations, const Machine& machine,
                  const Store& store) {
  const auto table = parent.table(name);
  if (!table) return;
  const double factor = unit_of_key(name).si_per_unit;
  for (const std::string& key : table->keys()) {
    const auto symbol = Symbol::parse(key);
    if (!symbol || !machine.has_axis(symbol->axis)) {
      table->fail(key, "\"" + printable(key) + "\" is not an error of this machine",
                  "write symbols of ISO 230-1, such as EXX, or EC0Y for a location error");
    }
    if (is_rotation(symbol->component) != rotations) {
      table->fail(key, key + " is not stated in " + std::string(unit_of_key(name).suffix),
                  "rotations go into the table in urad, displacements into the one in um");
    }
    store(*symbol, *table->raw_number(key) * factor);
  }
}

void check_location(const TomlTable& truth, const std::string& table_name, LocationSymbol symbol,
                    const Machine& machine) {
  const auto squareness = squareness_errors(machine);
  if (is_rotary(symbol.axis) || std::ranges::find(squareness, symbol) != squareness.end()) return;
  std::string names;
  for (const LocationSymbol& known : squareness) names += (names.empty() ? "" : ", ") + known.name();
  truth.required_table(table_name)
      .fail(symbol.name(), symbol.name() + " is not a squareness of the machine's datum",
            "with this datum they are " + names);
}

void read_truth_functions(const TomlTable& table, const Machine& machine, sim::TruthSettings& truth) {
  if (!table.has("functions")) return;
  truth.functions = read_function_specs(table, machine);
  const TomlTable functions = table.required_table("functions");
  for (const auto& [symbol, spec] : truth.functions) {
    if (!spec.coefficients.empty()) continue;
    const std::string key = symbol.name();
    functions.fail(key, functions.path() + "." + key + " states no value",
                   "add coefficients_" + std::string(edge_unit(symbol.component)) + " = [...]");
  }
}

void read_expansions(const TomlTable& truth, const Machine& machine, sim::TruthSettings& settings) {
  const auto tables = truth.table("expansions");
  if (!tables) return;
  for (const std::string& key : tables->keys()) {
    const auto axis = key.size() == 1 ? axis_from_letter(key[0]) : std::nullopt;
    if (!axis || is_rotary(*axis) || !machine.has_axis(*axis)) {
      tables->fail(key, "\"" + printable(key) + "\" is not a linear axis of the machine",
                   "name one of its axes");
    }
    const TomlTable table = tables->required_table(key);
    settings.expansions[*axis] = {table.required_number("expansion_um_per_m_K"), 0.0,
                                  table.required_text("temperature")};
  }
}

/// The truth is known errors: nothing else can be said of it.
sim::TruthSettings read_known_truth(const TomlTable& table, const std::string& file, const Machine& machine) {
  const std::string errors = table.required_text("errors");
  for (const std::string& key : table.keys()) {
    if (key != "errors")
      table.fail(key, "[truth] has errors and " + printable(key),
                 "known errors are the whole truth: keep one of the two");
  }
  return known_truth(resolve_path(file, errors), machine, table.place("errors"));
}

sim::TruthSettings read_truth(const TomlTable& table, const std::string& file, const Machine& machine) {
  if (table.has("errors")) return read_known_truth(table, file, machine);
  sim::TruthSettings truth;
  truth.perfect = table.choice("kind", {"random", "perfect"}).value_or("random") == "perfect";
  sim::RandomTruthOptions& random = truth.random;
  if (const auto range = table.numbers("volumetric_rms_um", kNotNegative)) {
    if (range->size() != 2 || (*range)[0] > (*range)[1]) {
      table.fail("volumetric_rms_um", "volumetric_rms_um is not a range", "give [smallest, largest]");
    }
    random.volumetric_rms_min = (*range)[0];
    random.volumetric_rms_max = (*range)[1];
  }
  read_number(table, "angular_scale", random.angular_scale);
  read_number(table, "squareness_scale", random.squareness_scale);
  read_number(table, "wave_scale", random.wave_scale);
  read_number(table, "reversal_max_um", random.reversal_max);
  read_number(table, "angular_reversal_max_urad", random.angular_reversal_max);
  for (const bool rotations : {true, false}) {
    const std::string unit = rotations ? "urad" : "um";
    read_symbols<LocationSymbol>(table, "locations_" + unit, rotations, machine,
                                 [&](LocationSymbol symbol, double value) {
                                   check_location(table, "locations_" + unit, symbol, machine);
                                   truth.locations[symbol] = value;
                                 });
    read_symbols<ErrorSymbol>(table, "reversals_" + unit, rotations, machine,
                              [&](ErrorSymbol symbol, double value) { truth.reversals[symbol] = value; });
  }
  read_truth_functions(table, machine, truth);
  read_expansions(table, machine, truth);
  return truth;
}

sim::TemperatureChannel read_channel(const TomlTable& table) {
  sim::TemperatureChannel channel;
  channel.name = table.required_name("channel");
  const NumberLimits any_temperature{-60.0, 300.0};
  const NumberLimits any_change{-300.0, 300.0};
  read_number(table, "start_degC", channel.start, any_temperature);
  if (const auto drift = table.number("drift_K_per_hour", any_change))
    channel.drift = *drift / kSecondsPerHour;
  read_number(table, "amplitude_K", channel.amplitude, any_change);
  if (const auto period = table.number("period_s", {1.0, 1e9})) channel.period = *period;
  read_number(table, "phase_deg", channel.phase, {-360.0, 360.0});
  read_number(table, "step_K", channel.step, any_change);
  read_number(table, "step_time_s", channel.step_time);
  return channel;
}

sim::ValidationSettings read_validation(const TomlTable& table, const Machine& machine) {
  sim::ValidationSettings validation;
  if (const auto points = table.integer("points", 3, 1000000)) validation.points = static_cast<int>(*points);
  if (const auto tools = table.texts("tools")) validation.tools = *tools;
  for (const std::string& tool : validation.tools) {
    if (machine.tool_index(tool)) continue;
    table.fail("tools", "tool \"" + printable(tool) + "\" is not in the machine file",
               "name tools of the machine file");
  }
  return validation;
}

void read_compensation(const TomlTable& table, const std::string& file, sim::Study& study) {
  double least_increment = 0.0;
  read_number(table, "least_increment_um", least_increment);
  read_number(table, "wrong_tool_length_mm", study.wrong_tool_length, {-0.09, 0.09});
  if (const auto tables = table.text("tables"))
    study.compensation = active_compensation(resolve_path(file, *tables), least_increment);
}

sim::Study read_document(const TomlDocument& document, const std::string& file, const Machine& machine) {
  const TomlTable root = document.root();
  sim::Study study;
  study.file = file;
  study.machine = machine;
  root.know("machine");
  root.text("name");
  study.seed = static_cast<std::uint64_t>(root.integer("seed", 0, kLargestSeed).value_or(1));
  read_number(root, "pause_s", study.pause_between_setups);
  if (const auto truth = root.table("truth")) study.truth = read_truth(*truth, file, machine);
  for (const TomlTable& table : root.tables("temperatures")) {
    study.environment.channels.push_back(read_channel(table));
  }
  if (const auto table = root.table("compensation")) read_compensation(*table, file, study);
  if (const auto table = root.table("validation")) study.validation = read_validation(*table, machine);
  for (const TomlTable& table : root.required_tables("measurements")) {
    study.measurements.push_back(read_measurement(table));
  }
  for (const TomlTable& table : root.tables("hidden")) study.hidden.push_back(read_hidden_effect(table));
  study.unseen = root.boolean("unseen").value_or(false);
  document.reject_unknown();
  return study;
}

}  // namespace

sim::TruthSettings known_truth(const std::string& path, const Machine& machine, const SourcePlace& named_at) {
  const FitResult known = read_known_errors(path, named_at);
  if (const std::string difference = machine_difference(known.machine, machine); !difference.empty())
    throw InputError({path, 0}, "the errors are those of another machine than the study's: " + difference,
                     "name the machine of these errors in the study (beside a result: its machine.toml)");
  sim::TruthSettings truth;
  truth.errors = model_of_result(known);
  truth.errors_file = path;
  if (truth.errors->file.empty()) truth.errors->file = path;
  truth.notes = findings_of_tables(known);
  for (const Axis& axis : machine.axes) {
    if (axis.expansion) truth.expansions[axis.name] = *axis.expansion;
  }
  for (const IdentifiedExpansion& identified : identified_expansions(known)) {
    const auto expansion = truth.expansions.find(identified.axis);
    if (expansion != truth.expansions.end()) expansion->second.per_kelvin = identified.per_kelvin;
  }
  for (const Tool& tool : machine.tools) {
    if (const auto* block = known.layout.find_block(tool_parameter(tool.name)))
      truth.tools[tool.name] = known.parameters.segment<3>(block->offset);
  }
  return truth;
}

sim::ActiveCompensation active_compensation(const std::string& folder, double least_increment) {
  const TablesFolder tables = read_tables_folder(folder);
  std::string description = fmt::format("{} tables of {}", tables.format->name, folder);
  if (least_increment > 0.0)
    description += fmt::format(", least increment {:g} um", least_increment / kMetrePerMicrometre);
  return {control_tables(*tables.format, tables.files), least_increment, description};
}

sim::Study read_study(const std::string& path) {
  const TomlDocument document = TomlDocument::read(path);
  document.require_format(kStudyFormat);
  const std::string machine = document.root().required_text("machine");
  return read_document(document, path,
                       read_machine(resolve_path(path, machine), document.root().place("machine")));
}

sim::Study parse_study(const std::string& text, const std::string& file, const Machine& machine) {
  const TomlDocument document = TomlDocument::parse(text, file);
  document.require_format(kStudyFormat);
  return read_document(document, file, machine);
}

}  // namespace volcal
