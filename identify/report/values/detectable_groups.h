#pragma once
/// The table of smallest detectable amplitudes, shortened: one line per kind of effect and unit.

#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"

namespace volcal::report {

struct DetectableGroup {
  std::string kind;
  std::string unit;
  double si_per_unit = 1.0;
  std::size_t effects = 0;
  std::size_t not_visible = 0;
  const DetectableEffect* easiest = nullptr;  ///< of the visible ones; null when there are none
  const DetectableEffect* hardest = nullptr;
};

/// In the order of the effects, which must outlive the groups.
std::vector<DetectableGroup> detectable_groups(const std::vector<DetectableEffect>& effects);

}  // namespace volcal::report
