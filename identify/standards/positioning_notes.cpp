#include "volcal/identify/standards/positioning_notes.h"

#include <algorithm>
#include <cstdint>

#include "volcal/identify/standards/approach.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {

std::vector<Finding> notes_on_positioning(const PositioningFigures& figures, const SetupValues& values,
                                          const char* unit) {
  std::vector<Finding> notes = notes_on_removed(values);
  if (figures.target_spread > kSamePosition)
    notes.push_back({FindingCode::StandardsTargetsSpread,
                     {{"spread", FindingNumber{figures.target_spread, unit, kMicro}}}});
  if (figures.unknown_direction > 0)
    notes.push_back({FindingCode::StandardsApproachUnknown,
                     {{"readings", static_cast<std::int64_t>(figures.unknown_direction)}}});
  const auto one_sided = std::ranges::count_if(
      figures.targets, [](const PositioningTarget& target) { return !target.bidirectional(); });
  if (one_sided > 0 && figures.reversal)
    notes.push_back({FindingCode::StandardsTargetsOneSided,
                     {{"targets", static_cast<std::int64_t>(one_sided)},
                      {"of", static_cast<std::int64_t>(figures.targets.size())}}});
  const bool repeated = figures.positive.repeatability || figures.negative.repeatability;
  if (!repeated && !figures.targets.empty()) notes.push_back({FindingCode::StandardsRepeatabilityUndefined});
  return notes;
}

}  // namespace volcal
