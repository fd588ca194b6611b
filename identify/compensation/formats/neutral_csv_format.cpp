#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "volcal/identify/compensation/rotary_grid_csv.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& neutral_csv_format();

namespace {

constexpr std::string_view kAxisFile = "axis_corrections.csv";
constexpr std::string_view kGridFile = "correction_grid.csv";
constexpr std::string_view kRotaryFile = "rotary_axis_corrections.csv";
constexpr std::string_view kMetadataFile = "metadata.csv";
constexpr std::string_view kAxisHeader =
    "input_axis,output_axis,position_mm,towards_plus_um,towards_minus_um";
constexpr std::string_view kGridHeader =
    "x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,x_reversal_dx_um,x_reversal_dy_um,x_reversal_dz_um,y_reversal_dx_um,"
    "y_reversal_dy_um,y_reversal_dz_um,z_reversal_dx_um,z_reversal_dy_um,z_reversal_dz_um";

std::string axis_file(const std::vector<SampledTable>& tables) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{}\n", kAxisHeader);
  for (const SampledTable& sampled : tables) {
    const AxisTable& table = sampled.table;
    for (std::size_t i = 0; i < table.position.size(); ++i) {
      fmt::format_to(out, "{},{},{:.10g},{:.9g},{:.9g}\n", letter_of(table.input), letter_of(sampled.output),
                     table.position[i] / kMetrePerMillimetre,
                     without_negative_zero(table.forward[i]) / kMetrePerMicrometre,
                     without_negative_zero(table.backward[i]) / kMetrePerMicrometre);
    }
  }
  return fmt::to_string(text);
}

std::string grid_file(const CorrectionGrid& grid) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{}\n", kGridHeader);
  const auto write_vector = [&](const Eigen::Vector3d& value) {
    for (const double component : value)
      fmt::format_to(out, ",{:.9g}", without_negative_zero(component) / kMetrePerMicrometre);
  };
  for_each_node(grid.nodes, [&](std::size_t index, const AxisPosition& node) {
    fmt::format_to(out, "{:.10g},{:.10g},{:.10g}", node[0] / kMetrePerMillimetre,
                   node[1] / kMetrePerMillimetre, node[2] / kMetrePerMillimetre);
    write_vector(grid.mean[index]);
    for (const auto& half : grid.half_reversal) write_vector(2.0 * half[index]);
    fmt::format_to(out, "\n");
  });
  return fmt::to_string(text);
}

AxisName linear_axis_in(const CsvRow& row, std::size_t column, std::string_view name) {
  const std::string& cell = row.cells[column];
  const auto axis = cell.size() == 1 ? axis_from_letter(cell[0]) : std::nullopt;
  if (!axis || is_rotary(*axis) || is_parallel(*axis) || cell[0] != letter_of(*axis))
    throw InputError(row.place, fmt::format("{} is \"{}\"", name, cell.substr(0, 40)), "write X, Y or Z");
  return *axis;
}

void add_axis_tables(const TableFile& file, CompensationTables& result) {
  std::map<std::pair<AxisName, AxisName>, AxisTable> tables;
  for (const CsvRow& row : csv_rows(file, kAxisHeader)) {
    const AxisName input = linear_axis_in(row, 0, "input_axis");
    AxisTable& table = tables[{input, linear_axis_in(row, 1, "output_axis")}];
    table.input = input;
    const double position = csv_number(row, 2, "position_mm") * kMetrePerMillimetre;
    require_ascending(table.position, position, row.place);
    table.position.push_back(position);
    table.forward.push_back(csv_number(row, 3, "towards_plus_um") * kMetrePerMicrometre);
    table.backward.push_back(csv_number(row, 4, "towards_minus_um") * kMetrePerMicrometre);
  }
  for (auto& [axes, table] : tables) result.terms.push_back(axis_term(axes.second, std::move(table)));
}

void add_grid(const TableFile& file, CompensationTables& result) {
  std::vector<std::array<double, 3>> points;
  std::vector<SourcePlace> places;
  CorrectionGrid grid;
  for (const CsvRow& row : csv_rows(file, kGridHeader)) {
    const auto value = [&](std::size_t column) { return csv_number(row, column, "the value"); };
    const auto vector = [&](std::size_t column) -> Eigen::Vector3d {
      return kMetrePerMicrometre * Eigen::Vector3d(value(column), value(column + 1), value(column + 2));
    };
    points.push_back({value(0), value(1), value(2)});
    places.push_back(row.place);
    grid.mean.emplace_back(vector(3));
    for (std::size_t i = 0; i < 3; ++i) grid.half_reversal[i].emplace_back(0.5 * vector(6 + 3 * i));
  }
  grid.nodes = grid_nodes(points, places);
  for (auto& nodes : grid.nodes) {
    for (double& node : nodes) node *= kMetrePerMillimetre;
  }
  result.terms.push_back(grid_term(std::move(grid)));
}

constexpr std::string_view kRotaryHeader = "axis,position_deg,towards_plus_urad,towards_minus_urad,full_turn";

std::string rotary_file(const std::vector<SampledTable>& tables) {
  std::string text = fmt::format("{}\n", kRotaryHeader);
  for (const SampledTable& sampled : tables) {
    const AxisTable& table = sampled.table;
    for (std::size_t i = 0; i < table.position.size(); ++i)
      text += fmt::format(
          "{},{:.12g},{:.9g},{:.9g},{}\n", letter_of(sampled.output), table.position[i] / kRadianPerDegree,
          without_negative_zero(table.forward[i]) / kMicro, without_negative_zero(table.backward[i]) / kMicro,
          table.beyond == BeyondEnds::Repeat ? 1 : 0);
  }
  return text;
}

AxisName rotary_axis_in(const CsvRow& row) {
  const std::string& cell = row.cells[0];
  const auto axis = cell.size() == 1 ? axis_from_letter(cell[0]) : std::nullopt;
  if (!axis || !is_rotary(*axis) || cell[0] != letter_of(*axis))
    throw InputError(row.place, fmt::format("axis is \"{}\"", cell.substr(0, 40)), "write A, B or C");
  return *axis;
}

void add_rotary_tables(const TableFile& file, CompensationTables& result) {
  std::map<AxisName, AxisTable> tables;
  for (const CsvRow& row : csv_rows(file, kRotaryHeader)) {
    const AxisName axis = rotary_axis_in(row);
    AxisTable& table = tables[axis];
    table.input = axis;
    const double position = csv_number(row, 1, "position_deg") * kRadianPerDegree;
    require_ascending(table.position, position, row.place);
    if (row.cells[4] != "0" && row.cells[4] != "1")
      throw InputError(row.place, "full_turn is \"" + row.cells[4].substr(0, 40) + "\"", "write 0 or 1");
    const BeyondEnds beyond = row.cells[4] == "1" ? BeyondEnds::Repeat : BeyondEnds::Hold;
    if (!table.position.empty() && table.beyond != beyond)
      throw InputError(row.place, "full_turn differs from the row above", "write one value for an axis");
    table.beyond = beyond;
    table.position.push_back(position);
    table.forward.push_back(csv_number(row, 2, "towards_plus_urad") * kMicro);
    table.backward.push_back(csv_number(row, 3, "towards_minus_urad") * kMicro);
  }
  for (auto& [axis, table] : tables) result.terms.push_back(axis_term(axis, std::move(table)));
}

void add_rotary_files(const FitResult& result, const TableFormatOptions& options,
                      std::vector<TableFile>& files) {
  if (options.type.has(CompensationPart::RotaryPositioning))
    files.push_back({std::string(kRotaryFile),
                     rotary_file(sample_rotary_positioning(neutral_csv_format(), result, options))});
  const RotaryShares shares = twist_shares(neutral_csv_format(), options.type);
  if (!shares.location && !shares.motion) return;
  for (const RotaryGrid& grid : rotary_grids_to_correct(result, options, shares))
    files.push_back({rotary_grid_file_name(grid.body, TableContent::Compensations),
                     rotary_grid_csv(grid, TableContent::Compensations, false)});
  files.push_back({std::string(kMetadataFile), table_metadata_csv(result, options)});
}

std::vector<TableFile> write_neutral(const FitResult& result, const TableFormatOptions& options) {
  const TableFormat& format = neutral_csv_format();
  std::vector<TableFile> files;
  if (!options.type.is_separable()) {
    files.push_back({std::string(kGridFile), grid_file(sample_grid(format, result, options))});
  } else if (!options.type.linear().empty()) {
    files.push_back({std::string(kAxisFile), axis_file(sample_axis_tables(format, result, options))});
  }
  add_rotary_files(result, options, files);
  return files;
}

CompensationTables read_neutral(std::span<const TableFile> files) {
  CompensationTables result;
  const TableFile* axes = find_file(files, kAxisFile);
  const TableFile* grid = find_file(files, kGridFile);
  const TableFile* rotary = find_file(files, kRotaryFile);
  std::vector<RotaryGrid> grids = read_rotary_grids(files, TableContent::Compensations);
  if (axes == nullptr && grid == nullptr && rotary == nullptr && grids.empty()) file_named(files, kAxisFile);
  if (axes != nullptr) add_axis_tables(*axes, result);
  if (grid != nullptr) add_grid(*grid, result);
  if (rotary != nullptr) add_rotary_tables(*rotary, result);
  if (grids.empty()) return result;
  const TableMetadata metadata = read_table_metadata(file_named(files, kMetadataFile));
  result.terms.push_back(rotary_grid_term(std::move(grids), metadata.machine, metadata.tool_offset()));
  return result;
}

}  // namespace

const TableFormat& neutral_csv_format() {
  static const TableFormat format = {
      .name = "neutral-csv",
      .summary =
          "corrections to add to the command, by axis (L-POS, L-STR, L-SQU) or on a grid with the share "
          "of each axis's reversal (with L-ANG, L-VOL), of rotary axes by axis (R-POS) and on a grid of "
          "table or tool; mm, deg, um, urad",
      .source =
          "volcal's own, after ISO/TR 16907:2015, 9.2 and 9.3: linear between positions, held beyond "
          "them; reversal is towards + minus towards -",
      .verified = "read back and evaluated by volcal",
      .supported = CompensationType::volumetric(),
      .rotary = CompensationType::rotary_volumetric(),
      .refusal = "it holds every type of the linear axes",
      .limits = {.both_directions = true},
      .settings = {},
      .write = write_neutral,
      .read = read_neutral};
  return format;
}

}  // namespace volcal
