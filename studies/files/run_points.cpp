#include "volcal/studies/files/run_points.h"

#include <array>
#include <cmath>
#include <functional>

#include "volcal/identify/text/csv_table.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

constexpr double kFurthest = 100.0;  // m or rad: a position beyond is in another unit

/// What a column's numbers go into.
struct PointColumn {
  std::size_t index = 0;
  std::string name;
  std::function<bool(sim::CommandedPoint& point, double value)> store;  ///< false: not believed
};

std::vector<PointColumn> point_columns(const CsvTable& table) {
  std::vector<PointColumn> columns;
  for (const AxisName axis : kAllAxes) {
    const std::size_t k = index_of(axis);
    const std::string name = position_column(axis);
    if (const auto index = table.find(name)) {
      const double unit = unit_of_key(name).si_per_unit;
      columns.push_back({*index, name, [k, unit](sim::CommandedPoint& point, double value) {
                           point.position[k] = value * unit;
                           return std::abs(point.position[k]) <= kFurthest;
                         }});
    } else if (!is_rotary(axis) && !is_parallel(axis)) {
      throw InputError(table.header_place(), "column " + name + " is missing",
                       "give x_mm, y_mm and z_mm of every position");
    }
    const std::string direction = direction_of_approach(axis).column();
    if (const auto index = table.find(direction)) {
      columns.push_back({*index, direction, [k](sim::CommandedPoint& point, double value) {
                           if (value != -1.0 && value != 0.0 && value != 1.0) return false;
                           point.direction[k] = static_cast<std::int8_t>(value);
                           return true;
                         }});
    }
  }
  for (const auto& [name, member] :
       {std::pair("line", &sim::CommandedPoint::line), std::pair("run", &sim::CommandedPoint::run)}) {
    const auto index = table.find(name);
    if (!index) continue;
    columns.push_back({*index, name, [to = member](sim::CommandedPoint& point, double value) {
                         if (!(std::abs(value) < 1e9) || value != std::round(value)) return false;
                         point.*to = static_cast<std::int32_t>(value);
                         return true;
                       }});
  }
  return columns;
}

std::vector<sim::CommandedPoint> run_points_of(const CsvTable& table) {
  const std::vector<PointColumn> columns = point_columns(table);
  std::vector<std::size_t> indices;
  indices.reserve(columns.size());
  for (const PointColumn& column : columns) indices.push_back(column.index);
  const CsvColumns numbers = table.numbers(indices);
  std::vector<sim::CommandedPoint> points(numbers.size());
  for (std::size_t row = 0; row < points.size(); ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (columns[c].store(points[row], numbers.values[c][row])) continue;
      throw InputError(
          {table.file(), static_cast<int>(numbers.source_line[row])},
          "column " + columns[c].name + " holds a value that is not a position, direction, line or run",
          "positions in mm and deg, directions -1, 0 or 1, lines and runs whole numbers");
    }
  }
  return points;
}

}  // namespace

std::vector<sim::CommandedPoint> read_run_points(const std::string& path, const SourcePlace& named_at) {
  return run_points_of(CsvTable::read(path, {}, named_at));
}

std::vector<sim::CommandedPoint> parse_run_points(const std::string& text, const std::string& file) {
  return run_points_of(CsvTable::parse(text, file, {}));
}

}  // namespace volcal
