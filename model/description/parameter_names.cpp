#include "volcal/model/description/parameter_names.h"

#include <string_view>

namespace volcal {
namespace {

constexpr std::string_view kTool = "tool ", kExpansion = "expansion ", kLengthScale = "length scale ",
                           kStation = "station ", kSphere = "sphere ", kCentre = ": centre";

std::string joined(std::string_view one, std::string_view other) {
  return std::string(one) + std::string(other);
}

}  // namespace

std::string tool_parameter(const std::string& tool) { return joined(kTool, tool); }
std::string expansion_parameter(AxisName axis) { return std::string(kExpansion) + letter_of(axis); }
std::string length_scale_parameter(const std::string& group) { return joined(kLengthScale, group); }
bool is_length_scale(const std::string& parameter) { return parameter.starts_with(kLengthScale); }
std::string station_parameter(const std::string& station) { return joined(kStation, station); }
std::string sphere_parameter(const std::string& sphere) { return joined(kSphere, sphere); }
std::string centre_parameter(const std::string& setup) { return joined(setup, kCentre); }

std::optional<NamedPoint> named_point(const std::string& parameter) {
  if (parameter.starts_with(kStation))
    return NamedPoint{NamedPoint::Kind::Station, parameter.substr(kStation.size())};
  if (parameter.starts_with(kSphere))
    return NamedPoint{NamedPoint::Kind::Sphere, parameter.substr(kSphere.size())};
  if (parameter.ends_with(kCentre))
    return NamedPoint{NamedPoint::Kind::Centre, parameter.substr(0, parameter.size() - kCentre.size())};
  return std::nullopt;
}

}  // namespace volcal
