#include "volcal/model/effects/driver_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// Smallest and largest of all values; nothing recorded: min > max.
struct Range {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  template <class Values>
  void add(const Values& values) {
    for (const auto value : values) {
      min = std::min(min, static_cast<double>(value));
      max = std::max(max, static_cast<double>(value));
    }
  }
  bool constant() const { return min == max; }
};

/// A variable of EffectName::driver in all readings, with the column that holds it; nothing for those that
/// are no column.
struct Recorded {
  std::string column;
  Range range;
};

std::optional<Recorded> recorded_range(const Campaign& campaign, const std::string& variable) {
  for (const AxisName axis : kAllAxes) {
    const std::string letter(1, lower_letter_of(axis));
    if (variable != letter && variable != "dir_" + letter) continue;
    Recorded found{variable == letter ? position_column(axis) : variable, {}};
    for (const Setup& setup : campaign.setups) {
      if (variable == letter) {
        found.range.add(setup.readings.position[index_of(axis)]);
      } else {
        found.range.add(setup.readings.direction[index_of(axis)]);
      }
    }
    return found;
  }
  for (const std::string& channel : temperature_channels(campaign)) {
    if (variable != "T_" + channel && variable != channel_variable(channel)) continue;
    Recorded found{"T_" + channel + "_degC", {}};
    for (const Setup& setup : campaign.setups) {
      const auto values = setup.readings.temperature.find(channel);
      if (values != setup.readings.temperature.end()) found.range.add(values->second);
    }
    return found;
  }
  return std::nullopt;
}

/// Columns without a change; of an expression only where no variable of it changes.
std::vector<std::string> constant_columns(const Campaign& campaign, const Effect& effect) {
  std::vector<std::string> constant;
  std::istringstream words(effect.name().driver);
  for (std::string variable; words >> variable;) {
    const auto found = recorded_range(campaign, variable);
    const bool unknown_direction =
        found && found->range.constant() && found->range.min == 0.0 && variable.starts_with("dir_");
    if (found && found->range.constant() && !unknown_direction) {
      constant.push_back(found->column);
    } else if (effect.changes_with_any_driver()) {
      return {};
    }
  }
  return constant;
}

}  // namespace

void check_drivers_vary(const Campaign& campaign, const ModelSpec& model) {
  for (const EffectSpec& spec : model.effects) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) continue;  // refused where the model is bound to the campaign
    check_drivers_vary(campaign, *kind->make(spec, model.file), {model.file, spec.source_line});
  }
}

void check_drivers_vary(const Campaign& campaign, const Effect& effect, const SourcePlace& place) {
  const std::vector<std::string> constant = constant_columns(campaign, effect);
  if (constant.empty()) return;
  throw InputError(place,
                   fmt::format("{} depends on {}: the same in all readings", effect_label(effect),
                               fmt::join(constant, " and ")),
                   "remove the effect, or measure where that changes");
}

}  // namespace volcal
