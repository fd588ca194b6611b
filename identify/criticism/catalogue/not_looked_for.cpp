#include "volcal/identify/criticism/catalogue/not_looked_for.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

bool direction_is_known(const Campaign& campaign, AxisName axis) {
  return std::ranges::any_of(campaign.setups, [&](const Setup& setup) {
    const auto& direction = setup.readings.direction[index_of(axis)];
    return std::ranges::any_of(direction, [](std::int8_t sign) { return sign != 0; });
  });
}

bool moves_along(const Campaign& campaign, AxisName axis) {
  const MeasuredRange range = measured_range(campaign, axis);
  return range.max > range.min;
}

/// Of the axes that move and whose directions are known nowhere.
std::set<Variable> unknown_directions(const Campaign& campaign) {
  std::set<Variable> directions;
  for (const Axis& axis : campaign.machine.axes) {
    if (!moves_along(campaign, axis.name) || direction_is_known(campaign, axis.name)) continue;
    directions.insert(direction_of_approach(axis.name));
  }
  return directions;
}

std::set<std::string> kinds_driven_by(const std::vector<Family>& families,
                                      const std::set<Variable>& drivers) {
  std::set<std::string> kinds;
  for (const Family& family : families) {
    if (!family.effect) continue;
    const EffectName& name = family.effect->name();
    const bool driven =
        std::ranges::any_of(drivers, [&](const Variable& driver) { return name.driver.has(driver); });
    if (driven) kinds.insert(name.kind);
  }
  return kinds;
}

std::set<std::string> kinds_with_candidates(const Campaign& campaign) {
  std::set<std::string> kinds;
  for (const EffectKind* kind : effect_kinds()) {
    if (!kind->candidates(campaign).empty()) kinds.insert(kind->schema().kind);
  }
  return kinds;
}

/// Kinds that could act if the readings recorded their times.
std::set<std::string> kinds_in_time(const Campaign& campaign) {
  Campaign timed = campaign;
  double now = 0.0;
  for (Setup& setup : timed.setups) {
    for (std::size_t row = 0; row < setup.readings.size(); ++row) setup.readings.time.push_back(now += 1.0);
  }
  std::set<std::string> more = kinds_with_candidates(timed);
  for (const std::string& kind : kinds_with_candidates(campaign)) more.erase(kind);
  return more;
}

std::vector<std::string> list(const std::set<std::string>& names) { return {names.begin(), names.end()}; }

}  // namespace

std::vector<Finding> not_looked_for(const Campaign& campaign, const std::vector<Family>& families) {
  std::vector<Finding> findings;
  const std::set<Variable> directions = unknown_directions(campaign);
  if (const auto kinds = kinds_driven_by(families, directions); !kinds.empty()) {
    findings.push_back(
        {FindingCode::DirectionsUnrecorded,
         {{"columns", names_of(std::vector(directions.begin(), directions.end()))}, {"kinds", list(kinds)}}});
  }
  const bool any_time =
      std::ranges::any_of(campaign.setups, [](const Setup& setup) { return !setup.readings.time.empty(); });
  if (any_time) return findings;
  if (const auto kinds = kinds_in_time(campaign); !kinds.empty()) {
    findings.push_back({FindingCode::TimesUnrecorded, {{"kinds", list(kinds)}}});
  }
  return findings;
}

}  // namespace volcal
