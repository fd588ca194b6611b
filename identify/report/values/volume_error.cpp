#include "volcal/identify/report/values/volume_error.h"

#include <algorithm>
#include <utility>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/remaining_error.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/errors/volume/volumetric.h"

namespace volcal::report {
namespace {

double max_norm(const std::vector<Eigen::Vector3d>& vectors) {
  double largest = 0.0;
  for (const auto& vector : vectors) largest = std::max(largest, vector.norm());
  return largest;
}

/// True when X, Y, Z stand at an end of their travel.
bool is_corner(const Machine& machine, const AxisPosition& position) {
  return std::ranges::all_of(machine.axes, [&](const Axis& axis) {
    const double from_start = position[index_of(axis.name)] - axis.travel_min;
    const double tolerance = 1e-9 * axis.travel();
    return is_rotary(axis.name) || is_parallel(axis.name) || from_start < tolerance ||
           from_start > axis.travel() - tolerance;
  });
}

}  // namespace

double ToolVolume::u_max() const { return max_norm(u_w); }

std::vector<ToolVolume> tool_volumes(const FitResult& result, int per_axis) {
  const KinematicChain chain(result.machine);
  const RemainingErrors remaining_errors(result.covariance);
  const std::vector<AxisPosition> positions = grid_positions(result.machine, per_axis);
  std::vector<ToolVolume> volumes;
  for (const Tool& tool : result.machine.tools) {
    const ErrorField field(result, tool);
    ToolVolume& volume = volumes.emplace_back();
    volume.tool = tool.name;
    Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(positions.size()), result.layout.size);
    std::vector<Eigen::Vector3d> errors;
    for (const AxisPosition& position : positions) {
      const Eigen::Vector3d point_w = chain.nominal_point_w(position, tool.offset);
      rows.middleRows<3>(3 * static_cast<Eigen::Index>(errors.size())) =
          field.unheld_rows(position).topRows<3>();
      errors.emplace_back(field.at(position).head<3>());
      volume.point_w.push_back(point_w);
      volume.extrapolated.push_back(field.is_beyond_readings(position));
      if (is_corner(result.machine, position)) volume.corner_w.push_back(point_w);
    }
    volume.error_w = without_rigid_motion(volume.point_w, errors);
    RemainingError remaining = remaining_errors.at(volume.point_w, rows);
    volume.u_w = std::move(remaining.u);
    volume.example_w = std::move(remaining.example);
    const BudgetLine whole =
        error_budget(result, tool, default_conditions(result), kVolumeCells, RotaryPoses::AtRest).total;
    volume.error_rms = whole.rms;
    volume.error_max = whole.max;
    volume.u_rms = whole.u_rms;
  }
  return volumes;
}

}  // namespace volcal::report
