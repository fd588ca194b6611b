#include "volcal/identify/errors/conditions.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/scale_expansions.h"
#include "volcal/model/observation/campaign_binding.h"

namespace volcal {
namespace {

constexpr std::string_view kReferenceTemperature = "reference temperature";

std::string_view origin_of(const RecordedRange& range) {
  switch (range.origin) {
    case ConditionOrigin::Campaign:
      return "mean of the campaign";
    case ConditionOrigin::Tables:
      return "of the tables";
    case ConditionOrigin::Assumed:
      return "assumed";
  }
  return "";
}

/// Whether the model reduces the scale of an axis by this channel.
bool knows_expansion(const FitResult& result, const std::string& channel) {
  return expansion_channels(result.machine, result.identified).contains(channel);
}

double number_of(const std::string& name, const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw InputError({}, setting("conditions") + " " + name + "=" + text + " is not a number",
                     "write " + name + "=23.3");
  return value;
}

std::string recorded_names(const FitResult& result) {
  std::string names;
  bool of_campaign = true;
  const auto add = [&](const std::string& name, const RecordedRange& range) {
    names += (names.empty() ? "" : ", ") + name;
    of_campaign = of_campaign && range.origin == ConditionOrigin::Campaign;
  };
  for (const auto& [channel, range] : result.conditions.temperature_degC)
    add(temperature_of(channel).name(), range);
  if (result.conditions.time) add(Variable{Variable::Kind::Time}.column(), *result.conditions.time);
  if (result.conditions.feed) add(Variable{Variable::Kind::Feed}.column(), *result.conditions.feed);
  if (names.empty()) return "its campaign recorded none";
  return (of_campaign ? "its campaign recorded " : "it knows ") + names;
}

void require_plausible(const std::string& name, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw InputError({}, setting("conditions") + " " + name + " is not plausible",
                   "give a value between " + std::to_string(static_cast<long>(least)) + " and " +
                       std::to_string(static_cast<long>(most)));
}

/// What a condition is of: a column, a temperature without its unit too.
std::optional<Variable> variable_named(const std::string& name) {
  if (const auto variable = Variable::parse_column(name)) return variable;
  const auto variable = Variable::parse(name);
  return variable && variable->kind == Variable::Kind::Temperature ? variable : std::nullopt;
}

}  // namespace

Conditions default_conditions(const FitResult& result) {
  Conditions conditions;
  for (const auto& [channel, range] : result.conditions.temperature_degC)
    conditions.temperature_degC[channel] =
        knows_expansion(result, channel) ? kReferenceTemperature_degC : range.mean;
  if (result.conditions.time) conditions.time = result.conditions.time->mean;
  if (result.conditions.feed) conditions.feed = result.conditions.feed->mean;
  return conditions;
}

Conditions stated_conditions(const FitResult& result, const std::map<std::string, std::string>& given) {
  Conditions conditions = default_conditions(result);
  for (const auto& [name, text] : given) {
    const double value = number_of(name, text);
    const auto variable = variable_named(name);
    const auto is = [&](Variable::Kind kind) { return variable && variable->kind == kind; };
    if (is(Variable::Kind::Temperature) && conditions.temperature_degC.contains(variable->subject)) {
      require_plausible(name, value, -80.0, 200.0);
      conditions.temperature_degC[variable->subject] = value;
    } else if (is(Variable::Kind::Time) && conditions.time) {
      require_plausible(name, value, -1e9, 1e9);
      conditions.time = value;
    } else if (is(Variable::Kind::Feed) && conditions.feed) {
      require_plausible(name, value, 0.0, 1e6);
      conditions.feed = value * variable->unit().si_per_unit;
    } else {
      throw InputError({}, setting("conditions") + " " + name + ": the result does not know this condition",
                       recorded_names(result));
    }
    conditions.stated.push_back(*variable);
  }
  return conditions;
}

double stated_reference_temperature(const FitResult& result, const Conditions& conditions) {
  for (const auto& [channel, value] : conditions.temperature_degC) {
    if (knows_expansion(result, channel)) return value;
  }
  return result.reference_temperature_degC;
}

std::string_view reference_temperature_origin(const FitResult& result) {
  if (result.temperature_is_campaign_mean) return "mean of the campaign";
  const bool is_fitted = !result.setups.empty();
  const bool is_reduced =
      is_fitted || std::ranges::any_of(result.conditions.temperature_degC, [&](const auto& entry) {
        return knows_expansion(result, entry.first);
      });
  return is_reduced ? "reduced by scale expansions" : "assumed";
}

std::vector<StatedCondition> list_conditions(const FitResult& result, const Conditions& conditions) {
  const Conditions usual = default_conditions(result);
  const RecordedConditions& recorded = result.conditions;
  const auto is_stated = [&](const Variable& variable) {
    return std::ranges::find(conditions.stated, variable) != conditions.stated.end();
  };
  std::vector<StatedCondition> list;
  for (const auto& [channel, value] : conditions.temperature_degC) {
    const auto otherwise = usual.temperature_degC.find(channel);
    const bool stated = otherwise == usual.temperature_degC.end() || otherwise->second != value ||
                        is_stated(temperature_of(channel));
    list.push_back({temperature_of(channel), value,
                    stated                             ? kAsStated
                    : knows_expansion(result, channel) ? kReferenceTemperature
                                                       : origin_of(recorded.temperature_degC.at(channel))});
  }
  const auto add = [&](const Variable& variable, double value, bool usual_value, const RecordedRange& range) {
    list.push_back({variable, value, usual_value && !is_stated(variable) ? origin_of(range) : kAsStated});
  };
  const Variable time{Variable::Kind::Time}, feed{Variable::Kind::Feed};
  if (conditions.time) add(time, *conditions.time, conditions.time == usual.time, *recorded.time);
  if (conditions.feed) {
    add(feed, *conditions.feed / feed.unit().si_per_unit, conditions.feed == usual.feed, *recorded.feed);
  }
  return list;
}

}  // namespace volcal
