#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/rotary_grid_csv.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

/// Errors of the axes as a program reads them: linear between rows, then the kinematic model.
class FunctionTables {
 public:
  FunctionTables(const std::vector<ErrorTableRow>& rows, const TableFile& file) {
    for (const ErrorTableRow& row : rows) {
      if (const auto motion = row.symbol.motion()) add(*motion, row);
      if (const auto location = row.symbol.location()) locations_[*location] = row.value;
    }
    for (auto& [symbol, table] : tables_) complete(symbol, table, file);
  }

  /// Of the linear axes alone.
  PoseErrors<double> linear_at(const AxisPosition& position, const ApproachDirection& direction) const {
    PoseErrors<double> errors = at(position, direction);
    for (const AxisName axis : kAllAxes) {
      if (!is_rotary(axis)) continue;
      errors.motion[index_of(axis)] = {};
      errors.location[index_of(axis)] = {};
    }
    return errors;
  }

  PoseErrors<double> at(const AxisPosition& position, const ApproachDirection& direction) const {
    PoseErrors<double> errors;
    for (const auto& [symbol, table] : tables_)
      errors.motion[index_of(symbol.axis)][index_of(symbol.component)] = table.value(position, direction);
    for (const auto& [symbol, value] : locations_)
      errors.location[index_of(symbol.axis)][index_of(symbol.component)] = value;
    return errors;
  }

 private:
  void add(ErrorSymbol symbol, const ErrorTableRow& row) {
    AxisTable& table = tables_[symbol];
    table.input = symbol.axis;
    if (row.direction >= 0) {
      table.position.push_back(row.position);
      table.forward.push_back(row.value);
    }
    if (row.direction <= 0) table.backward.push_back(row.value);
  }

  static void complete(ErrorSymbol symbol, const AxisTable& table, const TableFile& file) {
    if (table.forward.size() == table.backward.size()) return;
    throw InputError({file.name, 0}, symbol.name() + " has not as many rows for direction 1 as for -1",
                     "give both directions at the same positions, or direction 0 alone");
  }

  std::map<ErrorSymbol, AxisTable> tables_;
  std::map<LocationSymbol, double> locations_;
};

std::vector<TableFile> write_csv(const FitResult& result, const TableFormatOptions& given) {
  TableFormatOptions options = given;
  options.functions.step = given.step;
  options.functions.rotary_step = given.rotary_step;
  const std::vector<ErrorTableRow> errors = error_table(result, function_options(result, options));
  if (errors.empty())
    throw InputError({}, "every error motion and squareness is switched off in the model: csv has no row",
                     "leave one on in the model file, or take a format whose tables then hold zeros");
  std::vector<TableFile> files = result_tables(result, options);
  files.push_back({"compensation_tables.csv", function_table_csv(errors, TableContent::Compensations)});
  files.push_back(spatial_grid_file("compensation_grid.csv", result, options.grid_per_axis,
                                    conditions_of(result, options), TableContent::Compensations));
  if (!options.type.rotary().empty() && no_rotary_grid(result).empty()) {
    const auto add = [&files](const std::vector<RotaryGrid>& grids, TableContent content) {
      for (const RotaryGrid& grid : grids)
        files.push_back({rotary_grid_file_name(grid.body, content), rotary_grid_csv(grid, content, true)});
    };
    add(rotary_grids(result, conditions_of(result, options), grid_step(options)), TableContent::Errors);
    add(rotary_grids_to_correct(result, options), TableContent::Compensations);
  }
  files.push_back({"metadata.csv", table_metadata_csv(result, options)});
  return files;
}

/// Rotary axes by the control's own kinematic model, without the grids. `at_home`: what the tables of linear
/// axes leave there.
CorrectionTerm rotary_term(const TableMetadata& metadata, const Eigen::Vector3d& tool,
                           const Eigen::Vector3d& at_home, std::shared_ptr<const FunctionTables> tables) {
  FiveAxisSettings settings;
  settings.tool_offset = tool;
  const FiveAxisCompensation compensation(
      metadata.machine, settings,
      [tables = std::move(tables), at_home, structure = metadata.machine.structure](
          const AxisPosition& position, const ApproachDirection& direction) {
        PoseErrors<double> errors = tables->at(position, direction);
        add_displacement_of_table(structure, at_home, errors);
        return errors;
      });
  return [compensation](const AxisPosition& position, const ApproachDirection& direction) {
    return compensation.correction(position, direction);
  };
}

/// Of the axis whose displacement the error at home is.
bool hold_errors_of_table(const std::vector<ErrorTableRow>& rows, const Structure& structure) {
  const auto table = outermost_table_axis(structure);
  return table &&
         std::ranges::any_of(rows, [&](const ErrorTableRow& row) { return row.symbol.axis() == table; });
}

/// From compensation_tables.csv and metadata.csv, for the tool that the latter names; zero at home approached
/// towards +.
CompensationTables read_csv(std::span<const TableFile> files) {
  const TableMetadata metadata = read_table_metadata(file_named(files, "metadata.csv"));
  const TableFile& file = file_named(files, "compensation_tables.csv");
  const auto rows = read_function_table(file, TableContent::Compensations);
  for (const ErrorTableRow& row : rows) {
    const auto location = row.symbol.location();
    const auto axis = location && is_rotary(location->axis) ? std::optional(location->axis) : row.axis;
    if (axis && !metadata.machine.has_axis(*axis))
      throw InputError({file.name, 0}, row.symbol.name() + " belongs to an axis that the machine lacks",
                       "take metadata.csv of the same run");
  }
  const auto tables = std::make_shared<const FunctionTables>(rows, file);
  const KinematicChain chain(metadata.machine);
  const Eigen::Vector3d tool = metadata.tool_offset();
  const Eigen::Vector3d movable = movable_directions(metadata.machine);
  const auto error = [=](const AxisPosition& position, const ApproachDirection& direction) {
    const AxisPosition linear = without_rotary_axes(position);
    const ToolTwist twist = chain.first_order(linear, tool, tables->linear_at(linear, direction));
    return Eigen::Vector3d(twist.displacement_w.cwiseProduct(movable));
  };
  const Eigen::Vector3d at_home = error(home_of(metadata.machine), kTowardsPlus);
  CompensationTables result;
  result.terms.emplace_back(
      [error, at_home](const AxisPosition& position, const ApproachDirection& direction) {
        return Correction{at_home - error(position, direction), {0.0, 0.0, 0.0}};
      });
  if (!metadata.type.rotary().empty()) {
    const bool is_known = hold_errors_of_table(rows, metadata.machine.structure);
    const Eigen::Vector3d left =
        is_known ? Eigen::Vector3d(at_home + metadata.tool_effect()) : Eigen::Vector3d::Zero();
    result.terms.push_back(rotary_term(metadata, tool, left, tables));
  }
  // The grids hold the same once more: they must be sound.
  read_rotary_grids(files, TableContent::Errors);
  read_rotary_grids(files, TableContent::Compensations);
  return result;
}

}  // namespace

const TableFormat& csv_table_format() {
  static const TableFormat format = {
      .name = "csv",
      .summary =
          "errors and compensations of every function, squareness and location of rotary axes in both "
          "directions, and on grids of the volume and of the rotary axes, with uncertainty and the "
          "conditions of the run; mm, deg, um, urad",
      .source = "volcal's own; symbols, signs and layout of ISO 230-1 and ISO/TR 16907:2015, 9.1 to 9.3",
      .verified = "read back and evaluated by volcal with its kinematic model",
      .supported = CompensationType::volumetric(),
      .rotary = CompensationType::rotary_volumetric(),
      .rigid = true,
      .indivisible = true,
      .parallel_axes = true,
      .positions_of_own = true,
      .refusal = "its tables per error are the whole model",
      .limits = {.both_directions = true},
      .settings = {},
      .write = write_csv,
      .read = read_csv};
  return format;
}

}  // namespace volcal
