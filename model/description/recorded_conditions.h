#pragma once
/// What was recorded beside the readings of a campaign. Plain data; temperatures in degC, other values in SI.

#include <map>
#include <optional>
#include <string>

namespace volcal {

/// Who says a condition: readings of a campaign, tables that errors were read from, or nobody.
enum class ConditionOrigin { Campaign, Tables, Assumed };

struct RecordedRange {
  double min = 0.0;
  double mean = 0.0;
  double max = 0.0;
  ConditionOrigin origin = ConditionOrigin::Campaign;
};

/// Conditions under which a campaign was measured, as far as its files record them.
struct RecordedConditions {
  std::map<std::string, RecordedRange> temperature_degC;  ///< by channel
  std::optional<RecordedRange> time;                      ///< s, campaign clock
  std::optional<RecordedRange> feed;                      ///< m/s
};

}  // namespace volcal
