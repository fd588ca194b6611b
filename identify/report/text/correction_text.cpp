#include "volcal/identify/report/text/correction_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

double in_mm(const AxisPosition& position, AxisName axis) {
  return position[index_of(axis)] / kMetrePerMillimetre;
}

Eigen::Vector3d correction_um(const CompensationTables& tables, const AxisPosition& position,
                              std::string_view signs) {
  ApproachDirection direction{};
  for (std::size_t i = 0; i < 3; ++i) direction[i] = signs[i] == '+' ? 1 : -1;
  return tables.correction(position, direction) / kMicro;
}

}  // namespace

std::string corrections_text(const Machine& machine, const CompensationTables& tables,
                             const std::vector<AxisPosition>& points) {
  if (points.empty()) return {};
  std::vector<TextColumn> columns;
  for (const AxisName axis : linear_axes_of(machine))
    columns.push_back({fmt::format("{} [mm]", letter_of(axis))});
  columns.push_back({"approached", Align::Left});
  for (const char* name : {"dX [um]", "dY [um]", "dZ [um]"}) columns.push_back({name});
  TextTable table(columns, "Added to the command by the tables read back");
  for (const AxisPosition& point : points) {
    for (const char* signs : {"+++", "---"}) {
      std::vector<std::string> cells;
      for (const AxisName axis : linear_axes_of(machine))
        cells.push_back(short_number(in_mm(point, axis), 6));
      cells.push_back(fmt::format("towards {}", signs[0]));
      for (const double component : correction_um(tables, point, signs))
        cells.push_back(fixed_number(component, 3));
      table.add_row(std::move(cells));
    }
  }
  return table.text();
}

nlohmann::ordered_json corrections_json(const Machine& machine, const CompensationTables& tables,
                                        const std::vector<AxisPosition>& points) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AxisPosition& point : points) {
    nlohmann::ordered_json entry;
    for (const AxisName axis : linear_axes_of(machine))
      entry["position"][std::string(1, letter_of(axis))] = in_mm(point, axis);
    for (const char* signs : {"+++", "++-", "+-+", "+--", "-++", "-+-", "--+", "---"}) {
      const Eigen::Vector3d um = correction_um(tables, point, signs);
      entry["correction_um"][signs] = {um.x(), um.y(), um.z()};
    }
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace volcal
