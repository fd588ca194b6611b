#pragma once
/// Units at the edge. Every key and column name ends in its unit; inside the program everything is SI.

#include <string>
#include <string_view>

#include "volcal/model/description/symbols.h"

namespace volcal {

struct Unit {
  std::string_view suffix;  ///< as written at the end of a key: "mm", "um_per_m_K"; empty = dimensionless
  double si_per_unit;       ///< factor from the edge to SI
};

/// In which positions of an axis are written: mm, of rotary axes deg.
constexpr Unit position_unit(AxisName axis);
/// Column of an axis's positions: "x_mm", "c_deg".
std::string position_column(AxisName axis);

/// Unit of a key or column by its longest known suffix after an underscore; dimensionless when none fits.
Unit unit_of_key(std::string_view key);
/// Key without its unit: "station_mm" gives "station".
std::string_view stem_of_key(std::string_view key);
/// Suffix as it is printed: "um_per_m_K" gives "um/m/K".
std::string unit_text(std::string_view suffix);

inline constexpr double kMicro = 1e-6;  ///< um, urad, um/m and um/m/K in SI
inline constexpr double kMetrePerMillimetre = 1e-3;
inline constexpr double kMetrePerInch = 25.4e-3;
inline constexpr double kMetrePerMicrometre = 1e-6;
inline constexpr double kRadianPerMicroradian = 1e-6;
inline constexpr double kRadianPerMilliradian = 1e-3;
inline constexpr double kPerMicro = 1e6;  ///< um per m, urad per rad
inline constexpr double kPerMilli = 1e3;  ///< mm per m
inline constexpr double kSecondsPerMinute = 60.0;
inline constexpr double kSecondsPerHour = 3600.0;
inline constexpr double kRadianPerDegree = 3.14159265358979323846 / 180.0;

constexpr Unit position_unit(AxisName axis) {
  return is_rotary(axis) ? Unit{"deg", kRadianPerDegree} : Unit{"mm", kMetrePerMillimetre};
}

/// At which lengths are stated (ISO 1).
inline constexpr double kReferenceTemperature_degC = 20.0;

}  // namespace volcal
