#pragma once
/// Drift at rest, ISO 230-3:2007: displacements and tilts of the spindle against the table over time, nothing
/// moving. Of the environmental temperature variation error (ETVE) the range over the test is the value; of a
/// spindle that turns, the distortion within the first hour and over the whole test. m or rad; s.
///
/// The text of the standard was not at hand: the definitions are those in common use under its name.

#include <optional>
#include <span>

namespace volcal {

struct DriftReading {
  double time = 0.0;   ///< s
  double value = 0.0;  ///< m or rad
};

struct DriftFigures {
  double duration = 0.0;             ///< s
  std::optional<double> range;       ///< largest less smallest value; empty below two readings
  std::optional<double> first_hour;  ///< the same within the first hour; empty where the test is shorter
  std::optional<double> change;      ///< last less first value
  std::optional<double>
      fastest_in_an_hour;  ///< largest range within any hour; empty where the test is shorter
};

DriftFigures drift_figures(std::span<const DriftReading> readings);

}  // namespace volcal
