#include "volcal/identify/compensation/csv_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <utility>

#include "volcal/identify/text/csv_cell.h"
#include "volcal/identify/text/decimal_text.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

double sign_of(TableContent content) { return content == TableContent::Errors ? 1.0 : -1.0; }

/// -0 would be written with its sign.
double signed_value(double value, TableContent content) { return sign_of(content) * value + 0.0; }

std::string function_header(TableContent content) {
  return fmt::format("symbol,axis,position,position_unit,direction,{},unit,u,U95,extrapolated",
                     content == TableContent::Errors ? "value" : "compensation");
}

std::string component_column(Component component, TableContent content) {
  return fmt::format("{}{}_{}", content == TableContent::Errors ? 'e' : 'd',
                     lower_letter_of(kAllAxes[index_of(component)]), edge_unit(component));
}

std::vector<AxisName> axes_of_grid(const Machine& machine) {
  std::vector<AxisName> axes;
  for (const AxisName axis : kAllAxes) {
    if (machine.has_axis(axis)) axes.push_back(axis);
  }
  return axes;
}

std::string grid_header(const Machine& machine, TableContent content) {
  std::string header;
  for (const AxisName axis : axes_of_grid(machine))
    header += fmt::format("{}_{},", lower_letter_of(axis), position_unit(axis).suffix);
  header += "tool";
  for (const Component component : kAllComponents) header += "," + component_column(component, content);
  for (const Component component : kAllComponents)
    header += ",u_" + component_column(component, TableContent::Errors);
  return header + ",extrapolated";
}

[[noreturn]] void fail_cell(const CsvRow& row, std::string_view name, const std::string& cell,
                            std::string_view remedy) {
  throw InputError(row.place, fmt::format("{} is \"{}\"", name, cell.substr(0, 40)), std::string(remedy));
}

bool flag(const CsvRow& row, std::size_t column) {
  const std::string& cell = row.cells[column];
  if (cell != "0" && cell != "1") fail_cell(row, "extrapolated", cell, "write 0 or 1");
  return cell == "1";
}

double uncertainty(const CsvRow& row, std::size_t column, std::string_view name) {
  const double value = csv_number(row, column, name);
  if (value < 0.0) fail_cell(row, name, row.cells[column], "an uncertainty is not negative");
  return value * kMicro;
}

int direction_in(const CsvRow& row, std::size_t column) {
  const std::string& cell = row.cells[column];
  for (const int direction : {-1, 0, 1}) {
    if (cell == std::to_string(direction)) return direction;
  }
  fail_cell(row, "direction", cell, "write 1, -1, or 0 for the mean of both");
}

void read_motion_place(const CsvRow& row, ErrorSymbol symbol, ErrorTableRow& result) {
  if (row.cells[1] != std::string(1, letter_of(symbol.axis)))
    fail_cell(row, "axis", row.cells[1], "write the axis that moves, the last letter of the symbol");
  if (row.cells[3] != position_unit(symbol.axis).suffix)
    fail_cell(row, "position_unit", row.cells[3], "positions are in mm, of rotary axes in deg");
  result.axis = symbol.axis;
  result.position = csv_number(row, 2, "position") * position_unit(symbol.axis).si_per_unit;
  result.rotation = is_rotation(symbol.component);
}

ErrorTableRow function_row(const CsvRow& row, TableContent content) {
  ErrorTableRow result;
  result.symbol = MachineError::parse(row.cells[0]);
  if (const auto motion = result.symbol.motion()) {
    read_motion_place(row, *motion, result);
  } else if (const auto location = result.symbol.location()) {
    if (!row.cells[1].empty() || !row.cells[2].empty())
      fail_cell(row, "axis", row.cells[1],
                "a location error has neither axis nor position; empty both cells");
    result.rotation = is_rotation(location->component);
  } else {
    fail_cell(row, "symbol", row.cells[0], "write a symbol of ISO 230-1: EXX, EAZ, EC0Y");
  }
  if (row.cells[6] != (result.rotation ? "urad" : "um"))
    fail_cell(row, "unit", row.cells[6], "displacements are in um, rotations in urad");
  result.direction = direction_in(row, 4);
  result.value = signed_value(csv_number(row, 5, "the value") * kMicro, content);
  result.u = uncertainty(row, 7, "u");
  result.U95 = uncertainty(row, 8, "U95");
  result.extrapolated = flag(row, 9);
  return result;
}

}  // namespace

std::string function_table_csv(const std::vector<ErrorTableRow>& rows, TableContent content) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{}\n", function_header(content));
  for (const ErrorTableRow& row : rows) {
    fmt::format_to(out, "{},", row.symbol.name());
    if (row.axis) {
      fmt::format_to(out, "{},{:.10g},{},", letter_of(*row.axis),
                     row.position / position_unit(*row.axis).si_per_unit, position_unit(*row.axis).suffix);
    } else {
      fmt::format_to(out, ",,,");
    }
    fmt::format_to(out, "{},{:.9g},{},{:.6g},{:.6g},{}\n", row.direction,
                   signed_value(row.value, content) / kMicro, row.rotation ? "urad" : "um", row.u / kMicro,
                   row.U95 / kMicro, row.extrapolated ? 1 : 0);
  }
  return fmt::to_string(text);
}

std::vector<ErrorTableRow> read_function_table(const TableFile& file, TableContent content) {
  std::vector<ErrorTableRow> rows;
  std::map<std::pair<MachineError, int>, std::vector<double>> positions;  // by symbol and direction
  for (const CsvRow& row : csv_rows(file, function_header(content))) {
    rows.push_back(function_row(row, content));
    auto& before = positions[{rows.back().symbol, rows.back().direction}];
    require_ascending(before, rows.back().position, row.place);
    before.push_back(rows.back().position);
  }
  return rows;
}

namespace {

constexpr int kDecimalsOfPosition = 7;
constexpr int kDecimalsOfError = 7;

/// Rows of a spatial grid as text.
class GridRows {
 public:
  GridRows(const Machine& machine, TableContent content)
      : axes_(axes_of_grid(machine)), sign_(sign_of(content)) {}

  void append(const VolumetricError& point) {
    for (const AxisName axis : axes_) {
      append_decimal(point.position[index_of(axis)] / position_unit(axis).si_per_unit, kDecimalsOfPosition,
                     text_);
      text_.push_back(',');
    }
    append_cell(point.tool);
    for (const double value : point.value) append_number(sign_ * value);
    for (const double u : point.u) append_number(u);
    text_.push_back(',');
    text_.push_back(point.extrapolated ? '1' : '0');
    text_.push_back('\n');
  }
  std::string_view text() const { return {text_.data(), text_.size()}; }
  void clear() { text_.clear(); }

 private:
  void append_cell(const std::string& tool) {
    if (tool != tool_) {
      tool_ = tool;
      cell_ = csv_cell(tool);
    }
    text_.append(cell_);
  }
  void append_number(double value) {
    text_.push_back(',');
    append_decimal(value / kMicro, kDecimalsOfError, text_);
  }

  std::vector<AxisName> axes_;
  double sign_;
  std::string tool_, cell_;
  fmt::memory_buffer text_;
};

}  // namespace

TableFile spatial_grid_file(std::string name, const FitResult& result, int per_axis,
                            const Conditions& conditions, TableContent content) {
  const auto kept = std::make_shared<const FitResult>(result);
  return {std::move(name), grid_header(result.machine, content) + "\n",
          [kept, per_axis, conditions, content](const TextTaker& take) {
            GridRows rows(kept->machine, content);
            for_each_plane_of_grid(*kept, per_axis, conditions, [&](std::span<const VolumetricError> plane) {
              for (const VolumetricError& point : plane) rows.append(point);
              take(rows.text());
              rows.clear();
            });
          }};
}

std::vector<TableFile> result_tables(const FitResult& result, const TableFormatOptions& options) {
  return {{"error_tables.csv",
           function_table_csv(error_table(result, function_options(result, options)), TableContent::Errors)},
          spatial_grid_file("volumetric_grid.csv", result, options.grid_per_axis,
                            conditions_of(result, options), TableContent::Errors)};
}

ErrorTableOptions function_options(const FitResult& result, const TableFormatOptions& options) {
  ErrorTableOptions functions = options.functions;
  functions.conditions = conditions_of(result, options);
  functions.tool = options.tool;
  return functions;
}

}  // namespace volcal
