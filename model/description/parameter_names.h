#pragma once
/// Names of the parameters that belong to something of the user's files: what results, priors and lists call
/// them, made and read in one place.

#include <optional>
#include <string>

#include "volcal/model/description/symbols.h"

namespace volcal {

/// "tool long": what its offset is wrong by.
std::string tool_parameter(const std::string& tool);
/// "expansion X": expansion of an axis' scale.
std::string expansion_parameter(AxisName axis);
/// "length scale laser-tracer": relative error of the lengths of a group of setups.
std::string length_scale_parameter(const std::string& group);
bool is_length_scale(const std::string& parameter);

/// "station P1", "circle XY: centre": points in workpiece coordinates. "sphere S1": a point, of an R-test the
/// displacement of the sphere from where it was set.
std::string station_parameter(const std::string& station);
std::string sphere_parameter(const std::string& sphere);
std::string centre_parameter(const std::string& setup);

struct NamedPoint {
  enum class Kind { Station, Sphere, Centre } kind = Kind::Station;
  std::string name;  ///< of the station, the sphere or the setup
};
/// Absent for a parameter that is no point.
std::optional<NamedPoint> named_point(const std::string& parameter);

}  // namespace volcal
