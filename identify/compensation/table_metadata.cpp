#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/rotary/rotary_grid.h"
#include "volcal/identify/text/csv_cell.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr std::string_view kMetadataFormat = "volcal-tables-1";
constexpr std::string_view kNotRecorded = "not recorded";
constexpr std::string_view kEffectConditions = "effects.conditions";
constexpr std::string_view kAsIdentified = "as identified";
constexpr std::string_view kNone = "none", kBetween = "; ", kYes = "yes", kNo = "no";
constexpr std::array<char, 3> kCoordinates = {'x', 'y', 'z'};

class MetadataWriter {
 public:
  void add(std::string_view key, std::string_view value) {
    fmt::format_to(std::back_inserter(text_), "{},{}\n", csv_cell(std::string(key)),
                   csv_cell(std::string(value)));
  }
  void add_number(const std::string& key, double value) {
    add(key, std::isfinite(value) ? fmt::format("{:.12g}", value) : std::string("not available"));
  }
  void add_point_mm(const std::string& key, const Eigen::Vector3d& point) {
    add_vector(key, point / kMetrePerMillimetre, "mm");
  }
  void add_vector(const std::string& key, const Eigen::Vector3d& vector, const char* unit) {
    for (std::size_t i = 0; i < 3; ++i)
      add_number(fmt::format("{}.{}_{}", key, kCoordinates[i], unit), vector[static_cast<Eigen::Index>(i)]);
  }
  std::string text() const { return fmt::to_string(text_); }

 private:
  fmt::memory_buffer text_;
};

void add_machine(MetadataWriter& out, const Machine& machine) {
  out.add("machine", machine.name);
  out.add("structure", machine.structure.code);
  out.add("datum.primary", std::string(1, letter_of(machine.datum.primary)));
  out.add("datum.secondary", std::string(1, letter_of(machine.datum.secondary)));
  for (const Axis& axis : machine.axes) {
    const std::string key = fmt::format("axis.{}", letter_of(axis.name));
    const auto [unit, factor] = position_unit(axis.name);
    out.add_number(fmt::format("{}.travel_min_{}", key, unit), axis.travel_min / factor);
    out.add_number(fmt::format("{}.travel_max_{}", key, unit), axis.travel_max / factor);
    out.add_number(fmt::format("{}.home_{}", key, unit), axis.home / factor);
    if (is_rotary(axis.name)) {
      out.add_point_mm(key + ".centre", axis.centre);
      if (axis.endless) out.add(key + ".endless", *axis.endless ? kYes : kNo);
    } else {
      out.add_point_mm(key + ".reference_point", axis.reference_point);
    }
  }
  for (const Tool& tool : machine.tools) out.add_point_mm("tools." + tool.name + ".offset", tool.offset);
}

std::string tool_error_key(const std::string& tool) { return "tools." + tool + ".offset_error"; }

/// Of tools whose offset was estimated: no function of an axis holds it.
void add_tool_errors(MetadataWriter& out, const FitResult& result) {
  for (const Tool& tool : result.machine.tools) {
    const ParameterBlock* block = result.layout.find_block(tool_parameter(tool.name));
    if (block == nullptr) continue;
    const Eigen::Vector3d error = result.parameters.segment<3>(block->offset);
    out.add_vector(tool_error_key(tool.name), error / kMetrePerMicrometre, "um");
  }
}

std::string tool_effects_key(const std::string& tool) { return "tools." + tool + ".displaced_by_effects"; }

/// With all axes at home: no function of an axis holds that of every tool.
void add_tool_effects(MetadataWriter& out, const FitResult& result, const TableFormatOptions& options) {
  for (const Tool& tool : result.machine.tools) {
    const Eigen::Vector3d displaced = ErrorField(result, tool, conditions_of(result, options))
                                          .tool_displacement(home_of(result.machine), kTowardsPlus);
    if (!displaced.isZero(0.0))
      out.add_vector(tool_effects_key(tool.name), displaced / kMetrePerMicrometre, "um");
  }
}

/// Of axes of which a part was measured.
void add_measured(MetadataWriter& out, const FitResult& result) {
  for (const auto& [axis, ends] : model_of_result(result).measured) {
    const auto [unit, factor] = position_unit(axis);
    out.add_number(fmt::format("axis.{}.measured_from_{}", letter_of(axis), unit), ends.first / factor);
    out.add_number(fmt::format("axis.{}.measured_to_{}", letter_of(axis), unit), ends.second / factor);
  }
}

/// What is decided beyond the names of ISO 230-1 (ISO/TR 16907, 9.1).
void add_rotary_types(MetadataWriter& out, const FitResult& result, const TableFormatOptions& options) {
  out.add("rotary.error_motions",
          "tool relative to workpiece, in the stator of the axis, not in its rotor; of tables as of heads");
  out.add("rotary.location_errors",
          "of the physical axis average line, relative to the carrying body, machine coordinates");
  out.add("rotary.positioning",
          "rotations about the axis itself, EAA EBB ECC and EA0A EB0B EC0C: actual minus commanded");
  out.add("rotary.tilt_error_motions_act_on", "the functional point, R-VOL: no reference point is needed");
  const std::string no_grid = no_rotary_grid(result);
  out.add("rotary.grid", no_grid.empty() ? "one of every side of the bed, twist at the reference point that "
                                           "the file states"
                                         : "none: " + no_grid);
  if (no_grid.empty()) out.add_number("rotary.grid_step_at_most_deg", grid_step(options) / kRadianPerDegree);
}

std::string listed(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : std::string(kBetween)) + text;
  return list.empty() ? std::string(kNone) : list;
}

std::vector<std::string> texts_of_list(const std::string& list) {
  std::vector<std::string> texts;
  if (list == kNone) return texts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(kBetween, begin), list.size());
    texts.push_back(list.substr(begin, end - begin));
    begin = end + kBetween.size();
  }
  return texts;
}

/// What the error tables hold of effects, and what they hold it for.
void add_effects(MetadataWriter& out, const TablesMadeFor& made_for) {
  std::vector<std::string> conditions;
  for (const Variable& variable : made_for.conditions) conditions.push_back(variable.column());
  out.add(kEffectConditions, listed(conditions));
  out.add("effects.tool", made_for.tool.empty() ? kNone : std::string_view(made_for.tool));
  out.add("effects.as_nearest_rigid_body", listed(made_for.shared_effects));
  out.add("effects.in_no_table", listed(made_for.left_out));
}

void add_run(MetadataWriter& out, const FitResult& result, const TableFormatOptions& options) {
  out.add("alignment", result.alignment.empty() ? kAsIdentified : std::string_view(result.alignment));
  std::size_t readings = 0;
  std::string setups;
  for (const SetupSummary& setup : result.setups) {
    readings += setup.observations;
    setups += fmt::format("{}{} ({}, tool {})", setups.empty() ? "" : "; ", setup.name, setup.instrument,
                          setup.tool);
  }
  out.add("identification.result", options.record.run.empty() ? kNotRecorded : options.record.run);
  if (!result.provenance.version.empty()) {
    out.add("identification.version", result.provenance.version);
    out.add("identification.date", result.provenance.date);
    out.add("identification.command", result.provenance.command);
  }
  out.add("identification.status", to_string(result.status));
  out.add_number("identification.sigma0", result.sigma0);
  out.add("identification.readings", std::to_string(readings));
  out.add("identification.setups", setups);
  out.add_number("coverage_factor", result.coverage_factor);
  const bool of_tables = !findings_of_tables(result).empty();
  const Conditions conditions = of_tables ? default_conditions(result) : conditions_of(result, options);
  out.add_number("reference_temperature_degC", stated_reference_temperature(result, conditions));
  out.add("reference_temperature_is", reference_temperature_origin(result));
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    out.add_number("conditions." + condition.name(), condition.value);
    out.add("conditions." + condition.name() + ".is", condition.origin);
  }
  add_effects(out, tables_made_for(result, tool_of(result.machine, options), conditions));
}

class MetadataReader {
 public:
  explicit MetadataReader(const TableFile& file) : file_(file) {
    for (const CsvRow& row : csv_rows(file, "key,value")) {
      if (!rows_.emplace(row.cells[0], row).second)
        throw InputError(row.place, "key " + row.cells[0].substr(0, 40) + " is given twice", "delete one");
    }
  }

  TableMetadata read() const {
    if (text("format") != kMetadataFormat)
      fail("format", fmt::format("write the tables again: this reader knows {}", kMetadataFormat));
    TableMetadata metadata;
    metadata.machine = machine();
    metadata.tool = text("tool");
    const bool has_none = metadata.machine.tools.empty() && metadata.tool.empty();
    if (!has_none && !metadata.machine.tool_index(metadata.tool))
      fail("tool", "name one of the tools listed below it");
    metadata.type = compensation_type();
    for (const auto& [key, row] : rows_) metadata.entries[key] = row.cells[1];
    if (rows_.contains("alignment") && text("alignment") != kAsIdentified)
      metadata.alignment = text("alignment");
    if (metadata.entries.contains(std::string(kEffectConditions))) read_effects(metadata);
    for (const Axis& axis : metadata.machine.axes) read_measured(axis, metadata);
    for (const Tool& tool : metadata.machine.tools) {
      const auto read = [&](const std::string& key, auto& displacements) {
        if (rows_.contains(key + ".x_um")) displacements[tool.name] = vector(key, "um", kMetrePerMicrometre);
      };
      read(tool_error_key(tool.name), metadata.tool_errors);
      read(tool_effects_key(tool.name), metadata.tool_effects);
    }
    return metadata;
  }

 private:
  const CsvRow& row(const std::string& key) const {
    const auto found = rows_.find(key);
    if (found == rows_.end())
      throw InputError({file_.name, 0}, "key " + key + " is missing", "write the tables again");
    return found->second;
  }
  const std::string& text(const std::string& key) const { return row(key).cells[1]; }
  double number(const std::string& key) const { return csv_number(row(key), 1, key); }
  [[noreturn]] void fail(const std::string& key, const std::string& remedy) const {
    throw InputError(row(key).place, key + " is \"" + text(key).substr(0, 40) + "\"", remedy);
  }

  void read_measured(const Axis& axis, TableMetadata& metadata) const {
    const auto [unit, factor] = position_unit(axis.name);
    const std::string from = fmt::format("axis.{}.measured_from_{}", letter_of(axis.name), unit);
    const std::string to = fmt::format("axis.{}.measured_to_{}", letter_of(axis.name), unit);
    if (!rows_.contains(from) && !rows_.contains(to)) return;
    const std::pair ends(number(from) * factor, number(to) * factor);
    if (!(ends.first <= ends.second)) fail(to, "give an end that is not below " + from);
    metadata.measured[axis.name] = ends;
  }

  void read_effects(TableMetadata& metadata) const {
    TablesMadeFor& made_for = metadata.made_for;
    if (const std::string& tool = text("effects.tool"); tool != kNone) {
      if (!metadata.machine.tool_index(tool)) fail("effects.tool", "name one of the tools of the file");
      made_for.tool = tool;
    }
    made_for.shared_effects = texts_of_list(text("effects.as_nearest_rigid_body"));
    made_for.left_out = texts_of_list(text("effects.in_no_table"));
    for (const std::string& column : texts_of_list(text(std::string(kEffectConditions)))) {
      const auto variable = Variable::parse_column(column);
      const bool is_condition = variable && variable->changes_at_rest();
      if (!is_condition) fail(std::string(kEffectConditions), "name temperatures, time_s or feed_mm_min");
      made_for.conditions.push_back(*variable);
      const double value = number("conditions." + column) * variable->unit().si_per_unit;
      const RecordedRange range{value, value, value, ConditionOrigin::Tables};
      if (variable->kind == Variable::Kind::Temperature) {
        metadata.conditions.temperature_degC[variable->subject] = range;
      } else {
        (variable->kind == Variable::Kind::Time ? metadata.conditions.time : metadata.conditions.feed) =
            range;
      }
    }
  }

  CompensationType compensation_type() const {
    const std::string key = "compensation_type";
    if (rows_.find(key) == rows_.end()) return CompensationType::volumetric();
    try {
      return CompensationType::parse(text(key));
    } catch (const InputError& error) {
      fail(key, error.remedy());
    }
  }

  Eigen::Vector3d point(const std::string& key) const { return vector(key, "mm", kMetrePerMillimetre); }
  Eigen::Vector3d vector(const std::string& key, const char* unit, double si_per_unit) const {
    Eigen::Vector3d result;
    for (std::size_t i = 0; i < 3; ++i)
      result[static_cast<Eigen::Index>(i)] =
          number(fmt::format("{}.{}_{}", key, kCoordinates[i], unit)) * si_per_unit;
    return result;
  }

  /// Absent where it does not stand there.
  std::optional<bool> yes_or_no(const std::string& key) const {
    if (!rows_.contains(key)) return std::nullopt;
    const std::string& word = text(key);
    if (word != kYes && word != kNo) fail(key, "write yes or no");
    return word == kYes;
  }

  AxisName linear_axis(const std::string& key) const {
    const std::string& letter = text(key);
    const auto axis = letter.size() == 1 ? axis_from_letter(letter[0]) : std::nullopt;
    if (!axis || is_rotary(*axis) || is_parallel(*axis)) fail(key, "write X, Y or Z");
    return *axis;
  }

  Axis axis(AxisName name) const {
    Axis axis;
    axis.name = name;
    const std::string key = fmt::format("axis.{}", letter_of(name));
    const auto [unit, factor] = position_unit(name);
    const std::string travel_max = fmt::format("{}.travel_max_{}", key, unit);
    axis.travel_min = number(fmt::format("{}.travel_min_{}", key, unit)) * factor;
    axis.travel_max = number(travel_max) * factor;
    axis.home = number(fmt::format("{}.home_{}", key, unit)) * factor;
    if (axis.travel_max <= axis.travel_min) fail(travel_max, "the travel must end beyond its start");
    (is_rotary(name) ? axis.centre : axis.reference_point) =
        point(key + (is_rotary(name) ? ".centre" : ".reference_point"));
    axis.endless = yes_or_no(key + ".endless");
    return axis;
  }

  Machine machine() const {
    Machine machine;
    machine.name = text("machine");
    machine.structure = Structure::parse(text("structure"), file_.name, row("structure").place.line);
    machine.datum = {linear_axis("datum.primary"), linear_axis("datum.secondary")};
    if (machine.datum.primary == machine.datum.secondary)
      fail("datum.secondary", "primary and secondary axis differ");
    for (const Joint& joint : machine.structure.joints) machine.axes.push_back(axis(joint.axis));
    for (const std::string& name : tool_names())
      machine.tools.push_back({name, point(offset_key(name)), 0.0});
    return machine;
  }

  static std::string offset_key(const std::string& tool) { return "tools." + tool + ".offset"; }

  /// That of the tables first, which is the one that is taken where none is named; the others as they stand.
  std::vector<std::string> tool_names() const {
    constexpr std::string_view kPrefix = "tools.", kSuffix = ".offset.x_mm";
    std::map<std::int64_t, std::string> by_line;
    for (const auto& [key, row] : rows_) {
      if (!key.starts_with(kPrefix) || !key.ends_with(kSuffix)) continue;
      if (key.size() < kPrefix.size() + kSuffix.size()) continue;
      by_line[row.place.line] = key.substr(kPrefix.size(), key.size() - kPrefix.size() - kSuffix.size());
    }
    std::vector<std::string> names;
    for (const auto& [line, name] : by_line) names.push_back(name);
    const auto own = std::ranges::find(names, text("tool"));
    if (own != names.end()) std::rotate(names.begin(), own, own + 1);
    return names;
  }

  const TableFile& file_;
  std::map<std::string, CsvRow> rows_;
};

}  // namespace

std::string table_metadata_csv(const FitResult& result, const TableFormatOptions& options) {
  MetadataWriter out;
  out.add("key", "value");
  out.add("format", kMetadataFormat);
  out.add("errors", "actual minus nominal, tool relative to workpiece (ISO/TR 16907)");
  out.add("compensations", "minus the errors, added to the command; absolute values");
  out.add("signs", "ISO 841 and ISO 230-1");
  out.add("compensation_type", options.type.name());
  out.add("tool", tool_of(result.machine, options).name);
  out.add("zero", options.functions.zero_plus ? "home approached towards +"
                                              : "home, mean of both directions of approach");
  const AxisPosition lines = lines_of(result.machine, options);
  out.add_point_mm("specific_lines", {lines[0], lines[1], lines[2]});
  if (!options.type.rotary().empty()) add_rotary_types(out, result, options);
  add_machine(out, result.machine);
  add_tool_errors(out, result);
  add_tool_effects(out, result, options);
  add_measured(out, result);
  add_run(out, result, options);
  for (const std::string_view key : recordable_conditions()) {
    const auto recorded = options.record.conditions.find(std::string(key));
    const bool known = key == "active_compensations" && !result.active_compensations.empty();
    const std::string_view otherwise = known ? std::string_view(result.active_compensations) : kNotRecorded;
    out.add(key, recorded == options.record.conditions.end() ? otherwise : recorded->second);
  }
  out.add(kSuperimposedOn, options.active ? kSuperimposedOnFormer : kSuperimposedOnNone);
  return out.text();
}

Eigen::Vector3d TableMetadata::tool_offset() const {
  const auto index = machine.tool_index(tool);
  return index ? machine.tools[*index].offset : Eigen::Vector3d::Zero();
}

Eigen::Vector3d TableMetadata::tool_effect() const {
  const auto found = tool_effects.find(tool);
  return found == tool_effects.end() ? Eigen::Vector3d(0.0, 0.0, 0.0) : found->second;
}

TableMetadata read_table_metadata(const TableFile& file) { return MetadataReader(file).read(); }

}  // namespace volcal
