#include "volcal/model/effects/driver_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/variable.h"
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

std::optional<Recorded> range_of_channel(const Campaign& campaign, const Variable& variable) {
  for (const std::string& channel : temperature_channels(campaign)) {
    if (channel != variable.subject && channel_variable(channel) != variable.written()) continue;
    Recorded found{temperature_of(channel).column(), {}};
    for (const Setup& setup : campaign.setups) {
      const auto values = setup.readings.temperature.find(channel);
      if (values != setup.readings.temperature.end()) found.range.add(values->second);
    }
    return found;
  }
  return std::nullopt;
}

std::optional<Recorded> recorded_range(const Campaign& campaign, const Variable& variable) {
  const bool is_position = variable.kind == Variable::Kind::Position;
  if (variable.kind == Variable::Kind::Temperature) return range_of_channel(campaign, variable);
  if (!is_position && variable.kind != Variable::Kind::Direction) return std::nullopt;
  Recorded found{variable.column(), {}};
  for (const Setup& setup : campaign.setups) {
    const std::size_t axis = index_of(variable.axis);
    if (is_position) {
      found.range.add(setup.readings.position[axis]);
    } else {
      found.range.add(setup.readings.direction[axis]);
    }
  }
  return found;
}

/// Columns without a change; of an expression only where no variable of it changes.
std::vector<std::string> constant_columns(const Campaign& campaign, const Effect& effect) {
  std::vector<std::string> constant;
  for (const Variable& variable : effect.name().driver.variables()) {
    const auto found = recorded_range(campaign, variable);
    const bool unknown_direction = found && found->range.constant() && found->range.min == 0.0 &&
                                   variable.kind == Variable::Kind::Direction;
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
