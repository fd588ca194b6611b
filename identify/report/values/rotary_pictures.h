#pragma once
/// What the pictures of identified rotary axes show: error motions over a turn, the axis lines against their
/// nominal places, and the error over the positions of two axes. Plain data, SI.

#include <optional>
#include <vector>

#include "volcal/identify/errors/rotary/identified_lines.h"
#include "volcal/identify/errors/rotary/rotary_map.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// One error motion over the positions of its axis.
struct RotaryMotion {
  struct Curve {
    int direction = 0;  ///< of approach; 0 = mean of both
    std::vector<double> value;
    std::vector<double> U95;
  };
  ErrorSymbol symbol;
  bool visible = true;  ///< false: the readings do not determine it
  std::vector<double> position;
  std::vector<bool> extrapolated;
  std::vector<Curve> curves;

  /// Largest less smallest value over the measured positions.
  double range() const;
};

struct RotaryLine {
  IdentifiedLine line;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< nominal, machine coordinates with all axes at 0
  std::vector<LocationSymbol> not_visible;           ///< location errors that the readings do not determine
};

/// An inner axis of a head, displaced along itself, turns with the axis that carries it: no location error
/// holds that, and error motions of the carrying axis have it as one wave a turn.
struct CarriedDisplacement {
  AxisName carrying = AxisName::C;
  AxisName carried = AxisName::B;
  std::vector<ErrorSymbol> motions;
};

struct RotaryPictures {
  double coverage_factor = kCoverageFactor;
  double reach = 0.0;  ///< length, m, to which axis lines are drawn either way from their centres
  std::vector<RotaryMotion> motions;
  std::vector<RotaryLine> lines;
  std::vector<CarriedDisplacement> carried;  ///< between identified axes
  std::vector<RotaryMap> maps;               ///< one per tool, of the first tools
  /// Positions of the maps' axes at which readings were taken, at most some hundreds.
  std::vector<std::vector<double>> measured;
};

/// Empty where no rotary axis was identified. `campaign`: readings of the same machine; their positions are
/// marked.
std::optional<RotaryPictures> rotary_pictures(const FitResult& result, const Campaign& campaign);

}  // namespace volcal
