#include "volcal/identify/report/values/shown_variable.h"

#include "volcal/model/description/units.h"

namespace volcal::report {

ShownVariable shown_variable(const std::string& name) {
  if (name.size() == 1 && std::string("xyzuvw").find(name) != std::string::npos) {
    return {"Position " + name, "mm", kPerMilli};
  }
  if (name.size() == 1) return {"Position " + name, "deg", 1.0 / kRadianPerDegree};
  if (name.starts_with("dir_")) return {"Direction of " + name.substr(4), "", 1.0};
  if (name.starts_with("T_")) return {"Temperature " + name.substr(2), "°C", 1.0};
  if (name == "time") return {"Time", "min", 1.0 / kSecondsPerMinute};
  if (name == "length") return {"Measured length", "mm", kPerMilli};
  if (name == "feed") return {"Feed", "mm/min", kPerMilli * kSecondsPerMinute};
  if (name == "elevation") return {"Elevation of the beam", "deg", 1.0 / kRadianPerDegree};
  if (name == "run") return {"Run", "", 1.0};
  if (name.starts_with("tool ")) return {"Tool " + name.substr(5), "", 1.0};
  if (name.starts_with("station ")) return {"Station " + name.substr(8), "", 1.0};
  if (name == "setup") return {"Setup", "", 1.0};
  if (name == "station") return {"Station", "", 1.0};
  if (name == "tool") return {"Tool", "", 1.0};
  return {name, "", 1.0};
}

}  // namespace volcal::report
