/// The work volume in space: error vectors, their uncertainty, and where the instruments stood and measured.

#include <algorithm>
#include <cmath>
#include <limits>

#include "volcal/identify/report/numbers.h"
#include "volcal/model/description/parameter_names.h"

namespace volcal::report {
namespace {

constexpr std::size_t kPathVertices = 160;   ///< drawn per setup that measures along lines or circles
constexpr std::size_t kCloudPoints = 150;    ///< drawn per setup that measures points in space
constexpr std::size_t kDrawnPoints = 12000;  ///< over all setups

Json points_json(const std::vector<Eigen::Vector3d>& points, double factor, int digits) {
  Json json = Json::array();
  for (const Eigen::Vector3d& point : points) json.push_back(rounded_vector(point, factor, digits));
  return json;
}

Json component_ranges(const ToolVolume& volume) {
  Json ranges = Json::array();
  for (int i = 0; i < 3; ++i) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double u_square = 0.0;
    for (std::size_t k = 0; k < volume.error_w.size(); ++k) {
      low = std::min(low, volume.error_w[k][i]);
      high = std::max(high, volume.error_w[k][i]);
      u_square += volume.u_w[k][i] * volume.u_w[k][i];
    }
    const double u = std::sqrt(u_square / static_cast<double>(std::max<std::size_t>(1, volume.u_w.size())));
    ranges.push_back({{"component", std::string("E") + "XYZ"[i]},
                      {"min", rounded(low * kPerMicro, 4)},
                      {"max", rounded(high * kPerMicro, 4)},
                      {"range", rounded((high - low) * kPerMicro, 4)},
                      {"u_rms", rounded(u * kPerMicro, 3)}});
  }
  return ranges;
}

Json tool_json(const ToolVolume& volume) {
  Json extrapolated = Json::array();
  for (const bool outside : volume.extrapolated) extrapolated.push_back(outside ? 1 : 0);
  return {{"name", volume.tool},
          {"point_mm", points_json(volume.point_w, kPerMilli, 7)},
          {"error_um", points_json(volume.error_w, kPerMicro, 4)},
          {"u_um", points_json(volume.u_w, kPerMicro, 3)},
          {"example_um", points_json(volume.example_w, kPerMicro, 3)},
          {"extrapolated", std::move(extrapolated)},
          {"corner_mm", points_json(volume.corner_w, kPerMilli, 7)},
          {"components", component_ranges(volume)},
          {"error_rms_um", rounded(volume.error_rms * kPerMicro, 4)},
          {"error_max_um", rounded(volume.error_max * kPerMicro, 4)},
          {"u_rms_um", rounded(volume.u_rms * kPerMicro, 3)},
          {"u_max_um", rounded(volume.u_max() * kPerMicro, 3)}};
}

/// Named points among the nuisance parameters: stations and ball-bar centres. A sphere's parameters may be
/// its displacement from where it was set.
Json named_points(const FitResult& result) {
  Json list = Json::array();
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.kind != ParameterKind::Nuisance || block.size() != 3) continue;
    const auto point = named_point(block.name);
    if (!point || point->kind == NamedPoint::Kind::Sphere) continue;
    const Eigen::Vector3d point_w = result.parameters.segment<3>(block.offset);
    list.push_back({{"name", point->name},
                    {"kind", point->kind == NamedPoint::Kind::Station ? "station" : "centre"},
                    {"point_mm", rounded_vector(point_w, kPerMilli, 7)}});
  }
  return list;
}

/// Setups that follow a path are drawn as lines, those that look at points all over the volume as dots.
bool measures_points(const Setup& setup) {
  return setup.options.vector("station").has_value() || setup.readings.channels() == 3;
}

Json setup_json(const Setup& setup, const KinematicChain& chain, const Machine& machine, std::size_t limit) {
  const Readings& readings = setup.readings;
  const std::size_t step = std::max<std::size_t>(1, (readings.size() + limit - 1) / limit);
  Json points = Json::array();
  for (std::size_t row = 0; row < readings.size(); ++row) {
    const bool new_line = row > 0 && !readings.line.empty() && readings.line[row] != readings.line[row - 1];
    if (new_line && !measures_points(setup)) points.push_back(nullptr);
    const bool last = row + 1 == readings.size();
    if (row % step != 0 && !new_line && !last) continue;
    if (points.size() > 2 * limit) break;
    AxisPosition position{};
    for (const Axis& axis : machine.axes) {
      position[index_of(axis.name)] = readings.position[index_of(axis.name)][row];
    }
    points.push_back(
        rounded_vector(chain.nominal_point_w(position, machine.tools[setup.tool].offset), kPerMilli, 6));
  }
  return {{"name", setup.name},
          {"instrument", setup.instrument},
          {"form", measures_points(setup) ? "points" : "path"},
          {"point_mm", std::move(points)}};
}

}  // namespace

Json volume_page(const PageInput& input) {
  const Machine& machine = input.result.machine;
  const KinematicChain chain(machine);
  Json tools = Json::array();
  for (const ToolVolume& volume : input.volume) tools.push_back(tool_json(volume));
  const std::size_t share = kDrawnPoints / std::max<std::size_t>(1, input.campaign.setups.size());
  Json setups = Json::array();
  for (const Setup& setup : input.campaign.setups) {
    const std::size_t wanted = measures_points(setup) ? kCloudPoints : kPathVertices;
    setups.push_back(setup_json(setup, chain, machine, std::clamp<std::size_t>(share, 2, wanted)));
  }
  Json linear_axes = Json::array();
  bool rotary = false;
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) {
      rotary = true;
    } else if (!is_parallel(axis.name)) {
      linear_axes.push_back(axis_letter(axis.name));
    }
  }
  Json page = {{"linear_axes", std::move(linear_axes)},
               {"has_rotary", rotary},
               {"tools", std::move(tools)},
               {"named_points", named_points(input.result)},
               {"setups", std::move(setups)},
               {"coverage", rounded(input.result.coverage_factor)}};
  const std::string standing = letters_of(machine.parallel_axes());
  if (!standing.empty()) page["at_home"] = standing;
  return page;
}

}  // namespace volcal::report
