#include "volcal/identify/report/values/detectable_groups.h"

#include <algorithm>

namespace volcal::report {

std::vector<DetectableGroup> detectable_groups(const std::vector<DetectableEffect>& effects) {
  std::vector<DetectableGroup> groups;
  for (const DetectableEffect& effect : effects) {
    auto group = std::ranges::find_if(groups, [&](const DetectableGroup& each) {
      return each.kind == effect.name.kind && each.unit == effect.unit;
    });
    if (group == groups.end()) {
      groups.push_back({.kind = effect.name.kind, .unit = effect.unit, .si_per_unit = effect.si_per_unit});
      group = groups.end() - 1;
    }
    ++group->effects;
    if (!effect.visible) {
      ++group->not_visible;
      continue;
    }
    if (group->easiest == nullptr || effect.mdb < group->easiest->mdb) group->easiest = &effect;
    if (group->hardest == nullptr || effect.mdb > group->hardest->mdb) group->hardest = &effect;
  }
  return groups;
}

}  // namespace volcal::report
