#include "volcal/identify/report/volume_error.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/tables/error_tables.h"

namespace volcal::report {
namespace {

double rms_norm(const std::vector<Eigen::Vector3d>& vectors) {
  double sum = 0.0;
  for (const auto& vector : vectors) sum += vector.squaredNorm();
  return vectors.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(vectors.size()));
}

double max_norm(const std::vector<Eigen::Vector3d>& vectors) {
  double largest = 0.0;
  for (const auto& vector : vectors) largest = std::max(largest, vector.norm());
  return largest;
}

/// True when every linear axis stands at an end of its travel.
bool is_corner(const Machine& machine, const AxisPosition& position) {
  return std::ranges::all_of(machine.axes, [&](const Axis& axis) {
    const double from_start = position[index_of(axis.name)] - axis.travel_min;
    const double tolerance = 1e-9 * axis.travel();
    return is_rotary(axis.name) || from_start < tolerance || from_start > axis.travel() - tolerance;
  });
}

}  // namespace

double ToolVolume::error_rms() const { return rms_norm(error_w); }
double ToolVolume::error_max() const { return max_norm(error_w); }
double ToolVolume::u_rms() const { return rms_norm(u_w); }
double ToolVolume::u_max() const { return max_norm(u_w); }

std::vector<ToolVolume> tool_volumes(const FitResult& result, int per_axis) {
  const KinematicChain chain(result.machine);
  std::vector<ToolVolume> volumes;
  for (const VolumetricError& error : volumetric_grid(result, per_axis)) {
    if (volumes.empty() || volumes.back().tool != error.tool) {
      volumes.emplace_back().tool = error.tool;
    }
    ToolVolume& volume = volumes.back();
    const Tool& tool = result.machine.tools[*result.machine.tool_index(error.tool)];
    const Eigen::Vector3d point_w = chain.nominal_point_w(error.position, tool.offset);
    volume.point_w.push_back(point_w);
    volume.error_w.emplace_back(error.value.head<3>());
    volume.u_w.emplace_back(error.u.head<3>());
    volume.extrapolated.push_back(error.extrapolated);
    if (is_corner(result.machine, error.position)) volume.corner_w.push_back(point_w);
  }
  return volumes;
}

}  // namespace volcal::report
