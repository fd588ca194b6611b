#include "volcal/identify/standards/rotary_test_names.h"

#include <fmt/format.h>

namespace volcal {

std::string motion_name(const ErrorMotionTest& test) {
  const char direction = "XYZ"[test.direction];
  switch (test.motion) {
    case ErrorMotion::RadialRotating:
      return "radial, rotating";
    case ErrorMotion::Axial:
      return fmt::format("axial {}", direction);
    case ErrorMotion::Tilt:
      return fmt::format("tilt about {}", direction);
    default:
      return fmt::format("radial {}", direction);
  }
}

std::string drift_name(const DriftTest& test) {
  if (test.angle) return "tilt " + test.quantity;
  return test.quantity == "beam" ? "along the beam" : test.quantity + " displacement";
}

std::string temperatures_text(const DriftTest& test) {
  std::string text;
  for (const TemperatureRange& range : test.temperatures)
    text += fmt::format("{}{} {:.1f} to {:.1f} degC", text.empty() ? "" : ", ", range.channel, range.low,
                        range.high);
  return text;
}

}  // namespace volcal
