#include "volcal/identify/text/json_number.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "volcal/identify/text/text_file.h"

namespace volcal {

nlohmann::ordered_json number_json(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0.0 ? "inf" : "-inf";
}

double number_from(const nlohmann::ordered_json& json) {
  if (json.is_number()) return json.get<double>();
  const auto name = json.get<std::string>();
  if (name == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (name == "inf") return std::numeric_limits<double>::infinity();
  if (name == "-inf") return -std::numeric_limits<double>::infinity();
  throw std::invalid_argument("\"" + printable(name) + "\" is not a number");
}

}  // namespace volcal
