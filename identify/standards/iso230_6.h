#pragma once
/// Displacement along body and face diagonals, ISO 230-6:2002. The diagonal displacement deviation is the
/// measured minus the commanded displacement along the diagonal; per diagonal the figures are those of
/// ISO 230-2 (E, B, R, ... of iso230_2.h) with the diagonal in place of the axis. Lengths in m.
///   diagonal systematic deviation of positioning  E_d = max of E over the diagonals
///   diagonal reversal value                       B_d = max of B over the diagonals
/// Body diagonals (three axes move) and face diagonals of one plane (two axes) are judged apart.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/standards/iso230_2.h"

namespace volcal {

struct DiagonalFigures {
  std::string name;  ///< axes with the sign of their motion: "+X-Y+Z"
  PositioningFigures positioning;
};

struct DiagonalSummary {
  int diagonals = 0;                 ///< of those given; the standard asks for four (body) or two (face)
  std::optional<double> systematic;  ///< E_d; empty unless every diagonal has E
  std::optional<double> reversal;    ///< B_d; empty unless every diagonal has B
};

DiagonalSummary diagonal_summary(std::span<const DiagonalFigures> diagonals);

}  // namespace volcal
