#include <algorithm>
#include <cmath>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/rigid_compromise.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/parallel_axes.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr std::array<std::string_view, 6> kConditions = {
    "machine_state", "load", "feed", "ambient_temperature", "component_temperatures", "active_compensations"};

constexpr int kSuperimposedCells = 5;
constexpr double kRoundingOfSteps = 1e-9;
constexpr double kLostBySuperimposing = 0.2e-6;  // m

template <class Names>
std::string listed(const Names& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

const TableSetting* find_setting(std::span<const TableSetting> settings, std::string_view name) {
  const auto found = std::ranges::find(settings, name, &TableSetting::name);
  return found == settings.end() ? nullptr : &*found;
}

void check_settings(const TableFormat& format, const TableFormatOptions& options) {
  for (const auto& [name, value] : options.settings) {
    if (find_setting(format.settings, name) != nullptr) continue;
    std::vector<std::string_view> known;
    for (const TableSetting& setting : format.settings) known.push_back(setting.name);
    throw InputError({}, "--set " + name + ": format " + std::string(format.name) + " has no such setting",
                     known.empty() ? "it has none; leave --set out" : "its settings are " + listed(known));
  }
  for (const auto& [name, value] : options.record.conditions) {
    if (std::ranges::find(kConditions, name) == kConditions.end())
      throw InputError({}, setting("record") + " " + name + ": no such condition",
                       "record one of " + listed(kConditions));
  }
}

/// Why a format has no tables of a rotary type; empty where it has.
std::string why_no_rotary_type(const TableFormat& format, const FitResult& result, CompensationType type) {
  if (type.rotary().empty()) return {};
  if (type.has(CompensationPart::Orientation))
    return "FOR moves rotary axes by what all axes do, which no table holds; a control or a program that "
           "computes with the machine's kinematics can (FiveAxisCompensation of the library)";
  if (format.rotary.empty()) return "it holds nothing of rotary axes";
  if (!format.rotary.contains(type.rotary())) return "of rotary axes it holds " + format.rotary.name();
  if (format.indivisible && type.rotary() != format.rotary)
    return "it holds " + format.rotary.name() + " as a whole";
  if (identified_rotary_axes(result).empty()) return "no error of a rotary axis was identified";
  return {};
}

void check_type(const TableFormat& format, const FitResult& result, CompensationType type) {
  const std::string rotary = why_no_rotary_type(format, result, type);
  const bool part = format.indivisible && type.linear() != format.supported;
  if (rotary.empty() && !part && !type.empty() && format.supported.contains(type.linear())) return;
  const CompensationType possible = default_type(format, result);
  throw InputError({},
                   std::string(format.name) + " cannot compensate " + type.name() + ": " +
                       std::string(format.refusal) + (rotary.empty() ? "" : "; " + rotary),
                   "it can do " + possible.name() + "; give --type, or another --format");
}

bool acts_on_rotary_axes(const CompensationTables& tables, const Machine& machine) {
  const AxisPosition middle = middle_of_travel(machine);
  const Eigen::Vector3d at_zero = tables.correction(middle, {}).linear;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    for (const double share : {0.0, 0.13, 0.31, 0.57, 0.79, 1.0}) {
      AxisPosition turned = middle;
      turned[index_of(axis.name)] = axis.travel_min + share * axis.travel();
      const Correction correction = tables.correction(turned, {});
      if (!correction.rotary.isZero(0.0) || correction.linear != at_zero) return true;
    }
  }
  return false;
}

/// What the active tables correct must be something that the new ones hold.
void check_active_tables(const TableFormat& format, const FitResult& result,
                         const TableFormatOptions& options) {
  if (!options.active) return;
  if (format.indivisible)
    throw InputError({},
                     std::string(format.name) + " cannot be superimposed: its tables are one identification",
                     "superimpose in neutral-csv or in the controller's format");
  const CompensationTables& active = *options.active;
  const Machine& machine = result.machine;
  if (acts_on_rotary_axes(active, machine))
    throw InputError({}, "the active tables move rotary axes or depend on them: they cannot be superimposed",
                     "measure with the tables of rotary axes switched off, or name those of the linear axes");
  const Compensation same(machine, lines_of(machine, options), options.type,
                          [&active](const AxisPosition& position, const ApproachDirection& direction) {
                            return Eigen::Vector3d(-active.correction(position, direction).linear);
                          });
  const Eigen::Vector3d at_home = active.correction(home_of(machine), kTowardsPlus).linear;
  double lost = 0.0;
  for (const AxisPosition& position : grid_positions(machine, kSuperimposedCells)) {
    for (const std::int8_t sign : {-1, 1}) {
      ApproachDirection direction{};
      direction.fill(sign);
      lost = std::max(lost, (same.correction(position, direction) -
                             active.correction(position, direction).linear + at_home)
                                .cwiseAbs()
                                .maxCoeff());
    }
  }
  if (lost > kLostBySuperimposing)
    throw InputError({},
                     "the active tables correct up to " + std::to_string(lost * 1e6) + " um that " +
                         options.type.name() + " does not hold",
                     format.supported.contains(CompensationType::volumetric())
                         ? "give --type with all that is active, L-VOL holds everything"
                         : "give --type with all that is active, or a format that holds L-VOL");
}

/// Positions and steps that are possible at all.
void check_positions(const TableFormatOptions& options) {
  check_table_rows(options.functions.positions);
  if (options.grid_per_axis < 1 || options.grid_per_axis > kMostGridPerAxis)
    throw InputError({}, setting("grid") + " " + std::to_string(options.grid_per_axis) + " is out of range",
                     "give 1 to " + std::to_string(kMostGridPerAxis));
  if (!std::isfinite(options.step) || options.step < 0.0)
    throw InputError(
        {}, setting("step") + " " + number_text(options.step / kMetrePerMillimetre) + " is out of range",
        "give a positive number of mm");
  const double rotary_step = options.rotary_step / kRadianPerDegree;
  const bool fits = rotary_step >= kFinestRotaryStep_deg * (1.0 - kRoundingOfSteps) &&
                    rotary_step <= kCoarsestRotaryStep_deg * (1.0 + kRoundingOfSteps);
  if (!fits && options.rotary_step != 0.0)
    throw InputError({}, setting("rotary-step") + " " + number_text(rotary_step) + " is out of range",
                     "give " + number_text(kFinestRotaryStep_deg) + " to " +
                         number_text(kCoarsestRotaryStep_deg) + " deg");
}

}  // namespace

std::span<const std::string_view> recordable_conditions() { return kConditions; }

CompensationType default_type(const TableFormat& format, const FitResult& result) {
  return identified_rotary_axes(result).empty() ? format.supported : format.supported | format.rotary;
}

void check_table_options(const TableFormat& format, const FitResult& result,
                         const TableFormatOptions& options) {
  if (!format.parallel_axes)
    require_no_parallel_axes(
        result.machine, "the format " + std::string(format.name),
        "write --format csv, which holds the errors of every axis; or leave the axis out "
        "of the structure where it stands still");
  check_type(format, result, options.type);
  if (result.machine.main_linear_axes().empty())
    throw InputError(
        {},
        "the machine has no linear axis, and tables of rotary axes are written beside those of "
        "linear ones",
        "take the errors of its rotary axes from error_tables.csv of the result: EAA, EBB and ECC "
        "with the opposite sign are R-POS");
  check_positions(options);
  check_settings(format, options);
  tool_of(result.machine, options);
  check_active_tables(format, result, options);
}

std::vector<TableFile> write_tables(const TableFormat& format, const FitResult& result,
                                    const TableFormatOptions& options) {
  check_table_options(format, result, options);
  return format.write(result, options);
}

std::size_t bytes_of(std::span<const TableFile> files) {
  std::size_t bytes = 0;
  for (const TableFile& file : files) bytes += file.content.size();
  return bytes;
}

std::string table_setting(std::span<const TableSetting> settings, const TableFormatOptions& options,
                          std::string_view name) {
  const auto given = options.settings.find(std::string(name));
  if (given != options.settings.end()) return given->second;
  const TableSetting* declared = find_setting(settings, name);
  return declared == nullptr ? "" : std::string(declared->otherwise);
}

double table_setting_number(std::span<const TableSetting> settings, const TableFormatOptions& options,
                            std::string_view name) {
  const TableFile option{"--set " + std::string(name), table_setting(settings, options, name)};
  TableLines line(option);
  line.advance();
  return line.number(option.content, "the setting");
}

bool is_first_word(std::span<const TableSetting> settings, const TableFormatOptions& options,
                   std::string_view name, std::string_view first, std::string_view second) {
  const std::string given = table_setting(settings, options, name);
  if (given == first || given == second) return given == first;
  const std::string set = "--set " + std::string(name);
  const std::string words = set + "=" + std::string(first) + " or " + set + "=" + std::string(second);
  if (given.empty())
    throw InputError({}, std::string(name) + " is not confirmed publicly and must be given",
                     "find it out on the machine (--list says how), then give " + words);
  throw InputError({}, set + "=" + given.substr(0, 40), "give " + words);
}

const Tool& tool_of(const Machine& machine, const TableFormatOptions& options) {
  static const Tool kNoTool;
  if (options.tool.empty()) return machine.tools.empty() ? kNoTool : machine.tools.front();
  if (const auto index = machine.tool_index(options.tool)) return machine.tools[*index];
  std::vector<std::string> names;
  for (const Tool& tool : machine.tools) names.push_back(tool.name);
  throw InputError({}, setting("tool") + " " + options.tool + ": the machine has no such tool",
                   "its tools are " + listed(names));
}

Conditions conditions_of(const FitResult& result, const TableFormatOptions& options) {
  return options.conditions ? *options.conditions : default_conditions(result);
}

namespace {

Eigen::Vector3d active_correction(const TableFormatOptions& options, const AxisPosition& position,
                                  const ApproachDirection& direction) {
  return options.active ? options.active->correction(position, direction).linear
                        : Eigen::Vector3d(0.0, 0.0, 0.0);
}

LinearDisplacements identified_displacements(const FitResult& result, const TableFormatOptions& options) {
  return {result, tool_of(result.machine, options), conditions_of(result, options)};
}

RigidCompromise compromise_of(const FitResult& result, const TableFormatOptions& options) {
  return {result, tool_of(result.machine, options), conditions_of(result, options)};
}

/// Of effects that couple axes the mean over the other axes stands on the specific lines, unless the user has
/// said where these are.
Compensation::LineField line_field(const FitResult& result, const TableFormatOptions& options) {
  const LinearDisplacements identified = identified_displacements(result, options);
  if (!identified.has_coupled() || options.lines) return {};
  return [identified, options, compromise = compromise_of(result, options),
          lines = lines_of(result.machine, options)](AxisName axis, double q, int direction) {
    AxisPosition position = lines;
    position[index_of(axis)] = q;
    ApproachDirection approach{};
    approach[index_of(axis)] = static_cast<std::int8_t>(direction);
    return Eigen::Vector3d(identified.rigid(position, approach) + compromise.along(axis, q, direction) -
                           active_correction(options, position, approach));
  };
}

}  // namespace

DisplacementField errors_to_correct(const FitResult& result, const TableFormatOptions& options) {
  DisplacementField identified =
      displacement_field(result, tool_of(result.machine, options), conditions_of(result, options));
  if (!options.active) return identified;
  return [identified, active = *options.active](const AxisPosition& position,
                                                const ApproachDirection& direction) {
    return Eigen::Vector3d(identified(position, direction) - active.correction(position, direction).linear);
  };
}

AxisPosition lines_of(const Machine& machine, const TableFormatOptions& options) {
  return options.lines.value_or(middle_of_travel(machine));
}

namespace {

Compensation compensation_zero_at(const ApproachDirection& to_home, const FitResult& result,
                                  const TableFormatOptions& options) {
  return {result.machine,
          lines_of(result.machine, options),
          options.type,
          errors_to_correct(result, options),
          line_field(result, options),
          to_home};
}

}  // namespace

Compensation ideal_compensation(const FitResult& result, const TableFormatOptions& options) {
  return compensation_zero_at(kTowardsPlus, result, options);
}

Compensation sampled_compensation(const TableFormat& format, const FitResult& result,
                                  const TableFormatOptions& options) {
  const LinearDisplacements identified = identified_displacements(result, options);
  const ApproachDirection to_home = format.limits.both_directions ? kTowardsPlus : ApproachDirection{};
  if (!format.rigid || !identified.has_coupled()) return compensation_zero_at(to_home, result, options);
  const DisplacementField rigid = [identified, options, compromise = compromise_of(result, options)](
                                      const AxisPosition& position, const ApproachDirection& direction) {
    return Eigen::Vector3d(identified.rigid(position, direction) + compromise.at(position, direction) -
                           active_correction(options, position, direction));
  };
  return {result.machine, lines_of(result.machine, options), options.type, rigid, {}, to_home};
}

bool is_of_two_axes(const FitResult& result, const TableFormatOptions& options) {
  return !options.active && identified_displacements(result, options).is_of_two_axes();
}

void require_points(const TableFormat& format, const Axis& axis, std::size_t points) {
  const auto limit = static_cast<std::size_t>(format.limits.points_per_table);
  if (limit == 0 || points <= limit) return;
  throw InputError({},
                   std::string(format.name) + ": axis " + letter_of(axis.name) + " would need " +
                       std::to_string(points) + " positions, a table holds " + std::to_string(limit),
                   "give a larger --step");
}

}  // namespace volcal
