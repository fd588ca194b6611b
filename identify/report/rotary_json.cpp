#include "volcal/identify/report/rotary_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "volcal/identify/report/numbers.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

const std::array<std::string, 3> kDirections = {"X", "Y", "Z"};

std::string meaning_of_motion(ErrorSymbol symbol) {
  if (symbol.is_positioning()) return "angular positioning";
  if (is_rotation(symbol.component)) return "tilt";
  return direction_of(symbol.component) == direction_of(symbol.axis) ? "axial" : "radial";
}

Json motion_json(const RotaryMotion& motion) {
  Json extrapolated = Json::array(), curves = Json::array();
  for (const bool outside : motion.extrapolated) extrapolated.push_back(outside ? 1 : 0);
  for (const RotaryMotion::Curve& curve : motion.curves) {
    curves.push_back({{"direction", curve.direction},
                      {"value", rounded_array(curve.value, kPerMicro)},
                      {"U95", rounded_array(curve.U95, kPerMicro, 3)}});
  }
  return {{"symbol", motion.symbol.name()},
          {"axis", axis_letter(motion.symbol.axis)},
          {"meaning", meaning_of_motion(motion.symbol)},
          {"unit", is_rotation(motion.symbol.component) ? "µrad" : "µm"},
          {"visible", motion.visible},
          {"range", rounded(motion.range() * kPerMicro, 4)},
          {"position", rounded_array(motion.position, position_factor(motion.symbol.axis), 6)},
          {"extrapolated", std::move(extrapolated)},
          {"curves", std::move(curves)}};
}

/// Where the line passes, `along` from its centre: across the axis, with its covariance.
Json place_json(const IdentifiedLine& line, double along, const std::array<int, 2>& across) {
  const Eigen::Vector3d displacement = line.displacement_at(along);
  const Eigen::Matrix3d covariance = line.covariance_at(along);
  constexpr double kSquare = kPerMicro * kPerMicro;
  return {
      {"along_mm", rounded(along * kPerMilli)},
      {"um", {rounded(displacement[across[0]] * kPerMicro), rounded(displacement[across[1]] * kPerMicro)}},
      {"covariance",
       {rounded(covariance(across[0], across[0]) * kSquare),
        rounded(covariance(across[0], across[1]) * kSquare),
        rounded(covariance(across[1], across[1]) * kSquare)}}};
}

/// The four errors of a line: two displacements, two tilts.
Json line_errors(const RotaryLine& drawn, double coverage_factor) {
  const IdentifiedLine& line = drawn.line;
  Json errors = Json::array();
  for (const Component component : kAllComponents) {
    const int direction = direction_of(component);
    if (direction == direction_of(line.axis)) continue;
    const bool tilt = is_rotation(component);
    const int place = direction + (tilt ? 3 : 0);
    const double value = tilt ? line.value.rotation[direction] : line.value.displacement[direction];
    const LocationSymbol symbol{component, line.axis};
    errors.push_back({{"symbol", symbol.name()},
                      {"unit", tilt ? "µrad" : "µm"},
                      {"visible", std::ranges::find(drawn.not_visible, symbol) == drawn.not_visible.end()},
                      {"by_convention", line.by_convention[static_cast<std::size_t>(place)]},
                      {"value", rounded(value * kPerMicro, kDigitsBesideU)},
                      {"U95", rounded(coverage_factor * std::sqrt(line.covariance(place, place)) * kPerMicro,
                                      kDigitsBesideU)}});
  }
  return errors;
}

Json axis_line_json(const RotaryLine& drawn, double reach, double coverage_factor) {
  const int along = direction_of(drawn.line.axis);
  // Seen against the axis, right-handed but for B, whose view keeps X to the right.
  const std::array<int, 2> across = along == 0   ? std::array{1, 2}
                                    : along == 1 ? std::array{0, 2}
                                                 : std::array{0, 1};
  Json places = Json::array();
  for (const double at : {-reach, 0.0, reach}) places.push_back(place_json(drawn.line, at, across));
  return {
      {"axis", axis_letter(drawn.line.axis)},
      {"along", kDirections[static_cast<std::size_t>(along)]},
      {"across",
       {kDirections[static_cast<std::size_t>(across[0])], kDirections[static_cast<std::size_t>(across[1])]}},
      {"centre_mm", rounded_vector(drawn.centre, kPerMilli, 7)},
      {"displacement_um", rounded_vector(drawn.line.value.displacement, kPerMicro)},
      {"rotation_urad", rounded_vector(drawn.line.value.rotation, kPerMicro)},
      {"errors", line_errors(drawn, coverage_factor)},
      {"places", std::move(places)}};
}

Json carried_json(const CarriedDisplacement& carried) {
  Json motions = Json::array();
  for (const ErrorSymbol& motion : carried.motions) motions.push_back(motion.name());
  return {{"carrying", axis_letter(carried.carrying)},
          {"carried", axis_letter(carried.carried)},
          {"motions", std::move(motions)}};
}

Json layer_json(const RotaryMap& map, double coverage_factor,
                const std::function<std::pair<double, double>(const RotaryMapNode&)>& of) {
  std::vector<double> values, expanded;
  for (const RotaryMapNode& node : map.nodes) {
    const auto [value, u] = of(node);
    values.push_back(value);
    expanded.push_back(coverage_factor * u);
  }
  return {{"value", rounded_array(values, kPerMicro, 4)}, {"U95", rounded_array(expanded, kPerMicro, 3)}};
}

Json map_json(const RotaryMap& map, double coverage_factor) {
  const auto layer = [&](const std::string& name, auto of) {
    Json json = layer_json(map, coverage_factor, of);
    json["name"] = name;
    return json;
  };
  Json position = Json::array(
      {layer("|E|", [](const RotaryMapNode& node) { return std::pair(node.size, node.u_size); })});
  Json orientation = Json::array({layer(
      "tool axis", [](const RotaryMapNode& node) { return std::pair(node.tool_axis, node.u_tool_axis); })});
  for (int i = 0; i < 3; ++i) {
    const auto component = [](int k) {
      return [k](const RotaryMapNode& node) { return std::pair(node.value[k], node.u[k]); };
    };
    position.push_back(layer(std::string("E") + "XYZ"[i], component(i)));
    orientation.push_back(layer(std::string("E") + "ABC"[i], component(3 + i)));
  }
  Json extrapolated = Json::array();
  for (const RotaryMapNode& node : map.nodes) extrapolated.push_back(node.extrapolated ? 1 : 0);
  return {{"tool", map.tool},
          {"point_mm", rounded_vector(map.point_w, kPerMilli, 6)},
          {"extrapolated", std::move(extrapolated)},
          {"position", std::move(position)},
          {"orientation", std::move(orientation)}};
}

Json map_axes(const RotaryPictures& pictures) {
  Json axes = Json::array();
  const auto& nodes = pictures.maps.front().axes;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    axes.push_back({{"name", axis_letter(nodes[k].axis)},
                    {"places", rounded_array(nodes[k].positions, position_factor(nodes[k].axis), 6)},
                    {"dots", rounded_array(pictures.measured[k], position_factor(nodes[k].axis), 5)}});
  }
  return axes;
}

}  // namespace

Json rotary_json(const RotaryPictures& pictures) {
  Json motions = Json::array(), lines = Json::array(), carried = Json::array(), maps = Json::array();
  for (const RotaryMotion& motion : pictures.motions) motions.push_back(motion_json(motion));
  for (const RotaryLine& line : pictures.lines)
    lines.push_back(axis_line_json(line, pictures.reach, pictures.coverage_factor));
  for (const CarriedDisplacement& each : pictures.carried) carried.push_back(carried_json(each));
  for (const RotaryMap& map : pictures.maps) maps.push_back(map_json(map, pictures.coverage_factor));
  return {{"coverage", rounded(pictures.coverage_factor)},
          {"reach_mm", rounded(pictures.reach * kPerMilli)},
          {"motions", std::move(motions)},
          {"lines", std::move(lines)},
          {"carried", std::move(carried)},
          {"map_axes", map_axes(pictures)},
          {"maps", std::move(maps)}};
}

}  // namespace volcal::report
