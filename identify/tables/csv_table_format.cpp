#include <fmt/format.h>

#include <cctype>
#include <iterator>

#include "volcal/identify/tables/csv_cell.h"
#include "volcal/identify/tables/table_format.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

std::string_view position_unit(AxisName axis) { return is_rotary(axis) ? "deg" : "mm"; }

double position_factor(AxisName axis) { return is_rotary(axis) ? kRadianPerDegree : kMetrePerMillimetre; }

std::string component_column(Component component) {
  const char letter =
      static_cast<char>(std::tolower(static_cast<unsigned char>(letter_of(kAllAxes[index_of(component)]))));
  return fmt::format("e{}_{}", letter, edge_unit(component));
}

/// symbol,axis,position,position_unit,direction,value,unit,u,U95,extrapolated; value, u and U95 in `unit`.
/// direction: 0 mean of both, 1, -1. Location rows have neither axis nor position.
std::string error_tables_csv(const std::vector<ErrorTableRow>& rows) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "symbol,axis,position,position_unit,direction,value,unit,u,U95,extrapolated\n");
  for (const ErrorTableRow& row : rows) {
    fmt::format_to(out, "{},", row.symbol);
    if (row.axis) {
      fmt::format_to(out, "{},{:.10g},{},", letter_of(*row.axis), row.position / position_factor(*row.axis),
                     position_unit(*row.axis));
    } else {
      fmt::format_to(out, ",,,");
    }
    fmt::format_to(out, "{},{:.9g},{},{:.6g},{:.6g},{}\n", row.direction, row.value / kMicro,
                   row.rotation ? "urad" : "um", row.u / kMicro, row.U95 / kMicro, row.extrapolated ? 1 : 0);
  }
  return fmt::to_string(text);
}

/// x_mm,y_mm,z_mm (and a_deg ... as the machine has axes),tool,ex_um ... ec_urad,u_ex_um ...
/// u_ec_urad,extrapolated.
std::string volumetric_grid_csv(const std::vector<VolumetricError>& grid, const Machine& machine) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  for (const AxisName axis : kAllAxes) {
    if (!machine.has_axis(axis)) continue;
    const char letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter_of(axis))));
    fmt::format_to(out, "{}_{},", letter, position_unit(axis));
  }
  fmt::format_to(out, "tool");
  for (const Component component : kAllComponents) fmt::format_to(out, ",{}", component_column(component));
  for (const Component component : kAllComponents) fmt::format_to(out, ",u_{}", component_column(component));
  fmt::format_to(out, ",extrapolated\n");
  for (const VolumetricError& point : grid) {
    for (const AxisName axis : kAllAxes) {
      if (!machine.has_axis(axis)) continue;
      fmt::format_to(out, "{:.10g},", point.position[index_of(axis)] / position_factor(axis));
    }
    fmt::format_to(out, "{}", csv_cell(point.tool));
    for (const double value : point.value) fmt::format_to(out, ",{:.9g}", value / kMicro);
    for (const double u : point.u) fmt::format_to(out, ",{:.6g}", u / kMicro);
    fmt::format_to(out, ",{}\n", point.extrapolated ? 1 : 0);
  }
  return fmt::to_string(text);
}

std::vector<TableFile> write(const FitResult& result, const TableFormatOptions& options) {
  return {
      {"error_tables.csv", error_tables_csv(error_table(result, options.functions))},
      {"volumetric_grid.csv",
       volumetric_grid_csv(volumetric_grid(result, options.grid_per_axis), result.machine)},
  };
}

}  // namespace

const TableFormat& csv_table_format() {
  static const TableFormat format = {"csv",
                                     "error_tables.csv with every function and squareness, "
                                     "volumetric_grid.csv with the volume; mm, um, urad",
                                     "volcal's own; symbols and signs of ISO 230-1 and ISO/TR 16907, 8.2",
                                     write};
  return format;
}

}  // namespace volcal
