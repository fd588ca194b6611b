#pragma once
/// Stored pitch error compensation of FANUC as rows of its screens: what a file says, and its reader.
///
/// Values are increments: that of point n belongs to the interval from n-1 to n, and the amount is 0 at the
/// reference position. Lengths of linear axes are in mm and detection units, of rotary axes in deg and
/// theirs. A rotary axis that turns round has 3625, the degrees of a turn: its points go from the reference
/// position (3620 = 3621) to a turn above it, their values add up to 0, and the point of the reference
/// position has the value of the last (Series 0i-PB Parameter Manual B-63980EN/01, page 100, example 2).
/// SHIFT of a rotary axis is no parameter: the amount that the table lacks since it is 0 at the reference
/// position, deg, which moving the reference position takes.

#include <span>
#include <string_view>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/text/table_text.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

inline constexpr std::string_view kPitchFile = "pitch_error.txt";
inline constexpr std::string_view kPitchRowsHeader = "NUMBER VALUE";
inline constexpr int kMostPitchPoints = 128;           ///< of one axis and direction
inline constexpr int kLargestPitchNumber = 1023;       ///< of a point
inline constexpr int kLargestMagnification = 100;      ///< 3623
inline constexpr int kWidestPitchValue = 127;          ///< of controls with the wider range
inline constexpr int kLargestReferenceAmount = 32767;  ///< 3627

enum class PitchOutput { Even, Middle };

struct PitchHead {
  double sign = 0.0;  ///< +1 where values are compensations, -1 where they are errors
  PitchOutput output = PitchOutput::Even;
  double unit = 0.0;         ///< detection unit of linear axes, m
  double rotary_unit = 0.0;  ///< of rotary axes, rad
  int largest = 0;
  bool reference_negative = true;  ///< 3627 is for travel in the negative direction

  double unit_of(AxisName axis) const { return is_rotary(axis) ? rotary_unit : unit; }
};

/// m of a mm, rad of a degree.
double pitch_length(AxisName axis);

/// Throws InputError with file, line and remedy.
CompensationTables read_pitch(std::span<const TableFile> files);

}  // namespace volcal
