#include "volcal/identify/cli/options/conditions_options.h"

#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {

void add_conditions_options(CLI::App& app, ConditionsArguments& arguments) {
  app.add_option(
         "--conditions", arguments.given,
         "T_<channel>=23.3,time_s=3600,feed_mm_min=1000: conditions that the error is stated for; "
         "default: 20 degC where the model knows the expansion, otherwise the campaign's mean, or what "
         "errors without a campaign assume")
      ->delimiter(',');
  app.add_flag("--no-extrapolation", arguments.no_extrapolation,
               "refuse to state errors beyond the measured positions and conditions; otherwise the last "
               "measured one is held");
}

std::map<std::string, std::string> named_values(const std::string& option,
                                                const std::vector<std::string>& given) {
  std::map<std::string, std::string> values;
  for (const std::string& text : given) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw InputError({}, option + " " + text, "write NAME=VALUE");
    if (!values.emplace(text.substr(0, equals), text.substr(equals + 1)).second)
      throw InputError({}, option + " " + text.substr(0, equals) + " is given twice", "give it once");
  }
  return values;
}

Conditions conditions_of(const FitResult& result, const ConditionsArguments& arguments) {
  return stated_conditions(result, named_values("--conditions", arguments.given));
}

void require_known_conditions(const Campaign& campaign, const ConditionsArguments& arguments) {
  FitResult unfitted;
  unfitted.machine = campaign.machine;
  unfitted.conditions = recorded_conditions(campaign);
  conditions_of(unfitted, arguments);
}

}  // namespace volcal::cli
