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

/// Errors that were stated, and not identified, have none.
bool have_uncertainty(const FitResult& result, const std::vector<VolumetricError>& errors) {
  return !result.covariance.isZero(0.0) ||
         std::ranges::any_of(errors, [](const VolumetricError& error) { return !error.u.isZero(0.0); });
}

}  // namespace

std::string volumetric_text(const FitResult& result, const std::vector<VolumetricError>& errors) {
  std::vector<TextColumn> columns;
  for (const Axis& axis : result.machine.axes)
    columns.push_back({fmt::format("{} [{}]", letter_of(axis.name), position_unit(axis.name).suffix)});
  columns.push_back({"tool", Align::Left});
  const bool uncertain = have_uncertainty(result, errors);
  const char* const u95 = uncertain ? " +- U95" : "";
  for (const char* name : {"ex", "ey", "ez"}) columns.push_back({fmt::format("{}{} [um]", name, u95)});
  for (const char* name : {"ea", "eb", "ec"}) columns.push_back({fmt::format("{}{} [urad]", name, u95)});
  columns.push_back({"", Align::Left});
  TextTable table(columns, uncertain ? "Volumetric error (actual - nominal)"
                                     : "Volumetric error (actual - nominal), without a stated uncertainty");
  for (const VolumetricError& error : errors) {
    std::vector<std::string> cells;
    for (const Axis& axis : result.machine.axes)
      cells.push_back(short_number(at_the_edge(axis, error.position), 6));
    cells.push_back(error.tool);
    for (Eigen::Index k = 0; k < error.value.size(); ++k) {
      std::string& cell = cells.emplace_back(fixed_number(error.value[k] / kMicro, 2));
      if (uncertain) cell += " +- " + fixed_number(result.coverage_factor * error.u[k] / kMicro, 2);
    }
    cells.emplace_back(error.extrapolated ? "extrapolated" : "");
    table.add_row(std::move(cells));
  }
  return table.text();
}

nlohmann::ordered_json volumetric_json(const FitResult& result, const std::vector<VolumetricError>& errors) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const bool uncertain = have_uncertainty(result, errors);
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
    if (!uncertain) list.back()["u_um"] = list.back()["u_rotation_urad"] = nullptr;
  }
  return list;
}

}  // namespace volcal
