#pragma once
/// Skew factors of printer firmware (Marlin's planner, ported to Klipper): added to commands are
///   dx = -y xy - z (xz - xy yz),  dy = -z yz
/// with positions in the machine's coordinates.

#include "volcal/identify/compensation/table_format.h"

namespace volcal {

inline constexpr std::string_view kSkewRefusal = "the firmware knows three skew factors and nothing else";

struct SkewFactors {
  double xy = 0.0;
  double xz = 0.0;
  double yz = 0.0;
};

/// From the squarenesses of the ideal L-SQU compensation: an angle between X and Y beyond 90 degrees by a
/// positive slope of x over y is a positive factor.
SkewFactors skew_factors(const FitResult& result, const TableFormatOptions& options);
CompensationTables skew_tables(const SkewFactors& factors);

}  // namespace volcal
