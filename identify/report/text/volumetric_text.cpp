#include "volcal/identify/report/text/volumetric_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

double at_the_edge(const Axis& axis, const AxisPosition& position) {
  return position[index_of(axis.name)] / position_unit(axis.name).si_per_unit;
}

std::vector<double> micro_of(const Eigen::Vector3d& si) {
  return {si.x() / kMicro, si.y() / kMicro, si.z() / kMicro};
}

}  // namespace

std::string volumetric_text(const FitResult& result, const std::vector<VolumetricError>& errors) {
  std::vector<TextColumn> columns;
  for (const Axis& axis : result.machine.axes)
    columns.push_back({fmt::format("{} [{}]", letter_of(axis.name), position_unit(axis.name).suffix)});
  columns.push_back({"tool", Align::Left});
  for (const char* name : {"ex", "ey", "ez"}) columns.push_back({fmt::format("{} +- U95 [um]", name)});
  for (const char* name : {"ea", "eb", "ec"}) columns.push_back({fmt::format("{} +- U95 [urad]", name)});
  columns.push_back({"", Align::Left});
  TextTable table(columns, "Volumetric error (actual - nominal)");
  for (const VolumetricError& error : errors) {
    std::vector<std::string> cells;
    for (const Axis& axis : result.machine.axes)
      cells.push_back(short_number(at_the_edge(axis, error.position), 6));
    cells.push_back(error.tool);
    for (Eigen::Index k = 0; k < error.value.size(); ++k) {
      cells.push_back(fixed_number(error.value[k] / kMicro, 2) + " +- " +
                      fixed_number(result.coverage_factor * error.u[k] / kMicro, 2));
    }
    cells.emplace_back(error.extrapolated ? "extrapolated" : "");
    table.add_row(std::move(cells));
  }
  return table.text();
}

nlohmann::ordered_json volumetric_json(const FitResult& result, const std::vector<VolumetricError>& errors) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const VolumetricError& error : errors) {
    nlohmann::ordered_json position;
    for (const Axis& axis : result.machine.axes)
      position[std::string(1, letter_of(axis.name))] = at_the_edge(axis, error.position);
    list.push_back({{"position", position},
                    {"tool", error.tool},
                    {"error_um", micro_of(error.value.head<3>())},
                    {"u_um", micro_of(error.u.head<3>())},
                    {"rotation_urad", micro_of(error.value.tail<3>())},
                    {"u_rotation_urad", micro_of(error.u.tail<3>())},
                    {"extrapolated", error.extrapolated}});
  }
  return list;
}

}  // namespace volcal
