#include "volcal/identify/report/text/correction_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

double shown_position(const AxisPosition& position, AxisName axis) {
  return position[index_of(axis)] / position_unit(axis).si_per_unit;
}

/// `signs`: of X, Y, Z; rotary axes are approached as X is.
Correction correction_at(const CompensationTables& tables, const AxisPosition& position,
                         std::string_view signs) {
  ApproachDirection direction{};
  for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = signs[i < 3 ? i : 0] == '+' ? 1 : -1;
  return tables.correction(position, direction);
}

std::vector<AxisName> sorted_rotary_axes(const Machine& machine) {
  std::vector<AxisName> axes = machine.rotary_axes();
  std::ranges::sort(axes);
  return axes;
}

/// X Y Z U V W A B C.
std::vector<AxisName> axes_in_order(const Machine& machine) {
  std::vector<AxisName> axes = machine.linear_axes();
  for (const AxisName axis : sorted_rotary_axes(machine)) axes.push_back(axis);
  return axes;
}

/// Which axes move, where two are parallel.
std::string who_moves(const Machine& machine) {
  std::string letters;
  for (const AxisName axis : machine.parallel_axes())
    letters += (letters.empty() ? "" : ", ") + std::string(1, letter_of(axis));
  if (letters.empty()) return {};
  return fmt::format("X, Y, Z move for it; {} where the command has it\n", letters);
}

}  // namespace

std::string corrections_text(const Machine& machine, const CompensationTables& tables,
                             const std::vector<AxisPosition>& points) {
  if (points.empty()) return {};
  std::vector<TextColumn> columns;
  for (const AxisName axis : axes_in_order(machine))
    columns.push_back({fmt::format("{} [{}]", letter_of(axis), position_unit(axis).suffix)});
  columns.push_back({"approached", Align::Left});
  for (const char* name : {"dX [um]", "dY [um]", "dZ [um]"}) columns.push_back({name});
  for (const AxisName axis : sorted_rotary_axes(machine))
    columns.push_back({fmt::format("d{} [urad]", letter_of(axis))});
  TextTable table(columns, "Added to the command by the tables read back");
  for (const AxisPosition& point : points) {
    for (const char* signs : {"+++", "---"}) {
      std::vector<std::string> cells;
      for (const AxisName axis : axes_in_order(machine))
        cells.push_back(short_number(shown_position(point, axis), 6));
      cells.push_back(fmt::format("towards {}", signs[0]));
      const Correction correction = correction_at(tables, point, signs);
      for (const double component : correction.linear) cells.push_back(fixed_number(component / kMicro, 3));
      for (const AxisName axis : sorted_rotary_axes(machine))
        cells.push_back(fixed_number(correction.rotary[direction_of(axis)] / kMicro, 3));
      table.add_row(std::move(cells));
    }
  }
  return table.text() + who_moves(machine);
}

nlohmann::ordered_json corrections_json(const Machine& machine, const CompensationTables& tables,
                                        const std::vector<AxisPosition>& points) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AxisPosition& point : points) {
    nlohmann::ordered_json entry;
    for (const AxisName axis : axes_in_order(machine))
      entry["position"][std::string(1, letter_of(axis))] = shown_position(point, axis);
    for (const char* signs : {"+++", "++-", "+-+", "+--", "-++", "-+-", "--+", "---"}) {
      const Correction correction = correction_at(tables, point, signs);
      const Eigen::Vector3d um = correction.linear / kMicro;
      entry["correction_um"][signs] = {um.x(), um.y(), um.z()};
      for (const AxisName axis : sorted_rotary_axes(machine))
        entry["rotary_correction_urad"][signs][std::string(1, letter_of(axis))] =
            correction.rotary[direction_of(axis)] / kMicro;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace volcal
