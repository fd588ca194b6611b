#include "volcal/model/description/units.h"

#include <algorithm>
#include <array>

namespace volcal {
namespace {

// Longest suffix first, so that "um_per_m_K" is not taken for "K".
constexpr std::array kUnits = std::to_array<Unit>({
    {"um_per_m_K", kMicro},
    {"um_per_m_h", kMicro / kSecondsPerHour},
    {"um_per_m2", kMicro},
    {"um_per_m3", kMicro},
    {"urad_per_m2", kMicro},
    {"urad_per_m3", kMicro},
    {"urad_per_m", kMicro},
    {"urad_per_K", kMicro},
    {"um_per_K", kMicro},
    {"urad_per_h", kMicro / kSecondsPerHour},
    {"um_per_h", kMicro / kSecondsPerHour},
    {"ppm_per_K", kMicro},
    {"ppm_per_h", kMicro / kSecondsPerHour},
    {"um_per_metre", kMicro},
    {"um_per_m", kMicro},
    {"mm_min", kMetrePerMillimetre / kSecondsPerMinute},
    {"degC", 1.0},
    {"urad", kRadianPerMicroradian},
    {"mrad", kRadianPerMilliradian},
    {"ppm", kMicro},
    {"deg", kRadianPerDegree},
    {"rad", 1.0},
    {"mm", kMetrePerMillimetre},
    {"um", kMetrePerMicrometre},
    {"m", 1.0},
    {"ms", 1e-3},
    {"s", 1.0},
    {"K", 1.0},
});

bool ends_in_unit(std::string_view key, std::string_view suffix) {
  return key.size() > suffix.size() + 1 && key.ends_with(suffix) &&
         key[key.size() - suffix.size() - 1] == '_';
}

}  // namespace

std::string position_column(AxisName axis) {
  return std::string(1, lower_letter_of(axis)) + "_" + std::string(position_unit(axis).suffix);
}

std::string unit_text(std::string_view suffix) {
  std::string text(suffix);
  for (std::size_t at = text.find("_per_"); at != std::string::npos; at = text.find("_per_")) {
    text.replace(at, 5, "/");
  }
  std::ranges::replace(text, '_', '/');
  return text;
}

Unit unit_of_key(std::string_view key) {
  for (const Unit& unit : kUnits) {
    if (ends_in_unit(key, unit.suffix)) return unit;
  }
  return {"", 1.0};
}

std::string_view stem_of_key(std::string_view key) {
  const Unit unit = unit_of_key(key);
  if (unit.suffix.empty()) return key;
  return key.substr(0, key.size() - unit.suffix.size() - 1);
}

}  // namespace volcal
