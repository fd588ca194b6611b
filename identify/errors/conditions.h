#pragma once
/// Conditions for which the error of a machine is stated: temperatures, time and feed, as far as its model
/// depends on them.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/variable.h"

namespace volcal {

struct Conditions {
  std::map<std::string, double> temperature_degC;  ///< by channel
  std::optional<double> time;                      ///< s, campaign clock
  std::optional<double> feed;                      ///< m/s
  std::vector<Variable> stated;                    ///< by the user, one that equals the default among them
};

/// 20 degC for every channel whose expansion of a scale the model knows, the campaign's mean for every other;
/// the campaign's mean time and feed where they were recorded. Of errors that are stated what their tables
/// hold for, or what is assumed.
Conditions default_conditions(const FitResult& result);

/// The default with NAME=VALUE of the user in place: T_<channel> (degC), time_s, feed_mm_min. Throws
/// InputError for a name that the result does not know, and for a value that is no number.
Conditions stated_conditions(const FitResult& result, const std::map<std::string, std::string>& given);

/// The temperature that the values hold for: that of the channel by which the model knows an expansion, else
/// the result's.
double stated_reference_temperature(const FitResult& result, const Conditions& conditions);
/// Where it is from: "mean of the campaign", "reduced by scale expansions", or "assumed" where no campaign
/// and no expansion says it.
std::string_view reference_temperature_origin(const FitResult& result);

/// Origin of a condition that the user stated.
inline constexpr std::string_view kAsStated = "as stated";

/// One condition as headers and JSON state it.
struct StatedCondition {
  Variable variable;        ///< a temperature, time or feed
  double value = 0.0;       ///< in its unit
  std::string_view origin;  ///< "reference temperature", "mean of the campaign", "of the tables", "assumed",
                            ///< "as stated"

  std::string name() const { return variable.column(); }  ///< "T_column_degC", "time_s", "feed_mm_min"
};
std::vector<StatedCondition> list_conditions(const FitResult& result, const Conditions& conditions);

}  // namespace volcal
