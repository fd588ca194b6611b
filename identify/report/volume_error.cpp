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

/// All combinations of `per_axis` equally spaced positions of the linear axes, first axis fastest.
std::vector<AxisPosition> grid_positions(const Machine& machine, int per_axis) {
  AxisPosition home{};
  for (const Axis& axis : machine.axes) home[index_of(axis.name)] = axis.home;
  std::vector<AxisPosition> positions = {home};
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) continue;
    std::vector<AxisPosition> next;
    for (int i = 0; i < per_axis; ++i) {
      const double q = axis.travel_min + axis.travel() * i / (per_axis - 1);
      for (AxisPosition position : positions) {
        position[index_of(axis.name)] = q;
        next.push_back(position);
      }
    }
    positions = std::move(next);
  }
  return positions;
}

}  // namespace

double ToolVolume::error_rms() const { return rms_norm(error_w); }
double ToolVolume::error_max() const { return max_norm(error_w); }
double ToolVolume::u_rms() const { return rms_norm(u_w); }
double ToolVolume::u_max() const { return max_norm(u_w); }

std::vector<ToolVolume> tool_volumes(const FitResult& result, int per_axis) {
  const KinematicChain chain(result.machine);
  const std::vector<AxisPosition> positions = grid_positions(result.machine, per_axis);
  const std::vector<AxisPosition> corners = grid_positions(result.machine, 2);
  std::vector<ToolVolume> volumes;
  for (const Tool& tool : result.machine.tools) {
    ToolVolume volume;
    volume.tool = tool.name;
    for (const AxisPosition& position : positions) {
      const VolumetricError error = volumetric_error(result, position, tool);
      volume.point_w.push_back(chain.nominal_point_w(position, tool.offset));
      volume.error_w.emplace_back(error.value.head<3>());
      volume.u_w.emplace_back(error.u.head<3>());
      volume.extrapolated.push_back(error.extrapolated);
    }
    for (const AxisPosition& corner : corners) {
      volume.corner_w.push_back(chain.nominal_point_w(corner, tool.offset));
    }
    volumes.push_back(std::move(volume));
  }
  return volumes;
}

}  // namespace volcal::report
