#pragma once
/// Positioning figures of a linear axis, ISO 230-2:2014, clause 3. The same figures are used along a diagonal
/// (iso230_6.h). Lengths in m; every deviation counts positive in the + direction of the axis.
///
/// x_ij = P_ij - P_i: deviation of approach j at target i; + and - mark the direction of approach.
///   mean and spread    x_i+, x_i- means; s_i+, s_i- standard deviations with n - 1
///   reversal           B_i = x_i+ - x_i-;  B = max |B_i|;  mean reversal = mean of B_i
///   repeatability      R_i+ = 4 s_i+;  R_i- = 4 s_i-;  R_i = max(2 s_i+ + 2 s_i- + |B_i|, R_i+, R_i-)
///                      R+, R-, R = max over i
///   systematic         E+ = max x_i+ - min x_i+;  E- alike;  E = max over both - min over both
///   mean bidirectional M = range of (x_i+ + x_i-) / 2
///   accuracy           A+ = max(x_i+ + 2 s_i+) - min(x_i+ - 2 s_i+);  A- alike;  A over both directions
///
/// A figure that the readings do not define is empty, never 0: s_i needs two approaches, R and A need s_i at
/// every target, bidirectional figures need both directions.

#include <optional>
#include <span>
#include <vector>

namespace volcal {

struct PositioningReading {
  double target = 0.0;     ///< commanded position along the axis, m
  double deviation = 0.0;  ///< actual minus commanded, m
  int direction = 0;       ///< approach: +1, -1; 0 = unknown
};

/// Approaches of one target from one direction.
struct ApproachStatistics {
  int count = 0;
  double mean = 0.0;                  ///< defined when count > 0
  std::optional<double> deviation_s;  ///< s_i; empty for fewer than two approaches
};

struct PositioningTarget {
  double position = 0.0;  ///< P_i, m
  ApproachStatistics positive;
  ApproachStatistics negative;

  bool bidirectional() const { return positive.count > 0 && negative.count > 0; }
  std::optional<double> reversal() const;            ///< B_i
  std::optional<double> mean_bidirectional() const;  ///< mean of x_i+ and x_i-
  std::optional<double> repeatability() const;       ///< R_i
};

struct UnidirectionalFigures {
  std::optional<double> systematic;     ///< E+ or E-
  std::optional<double> repeatability;  ///< R+ or R-
  std::optional<double> accuracy;       ///< A+ or A-
};

struct PositioningFigures {
  std::vector<PositioningTarget> targets;  ///< ascending
  UnidirectionalFigures positive;
  UnidirectionalFigures negative;
  std::optional<double> systematic;          ///< E
  std::optional<double> mean_bidirectional;  ///< M
  std::optional<double> reversal;            ///< B, an absolute value
  std::optional<double> mean_reversal;       ///< signed
  std::optional<double> repeatability;       ///< R
  std::optional<double> accuracy;            ///< A
  int unknown_direction = 0;                 ///< readings left out because their approach is unknown
  double target_spread = 0.0;                ///< largest range of recorded positions taken as one target, m
};

/// Readings share a target as group_targets() says; `target_tolerance` in m.
PositioningFigures positioning_figures(std::span<const PositioningReading> readings,
                                       double target_tolerance = 1e-6);

}  // namespace volcal
