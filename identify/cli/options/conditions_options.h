#pragma once
/// Options of every command that states the error of a result: conditions, and what to do beyond the
/// readings.

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/model/description/campaign.h"

namespace volcal::cli {

struct ConditionsArguments {
  std::vector<std::string> given;
  bool no_extrapolation = false;
};

void add_conditions_options(CLI::App& app, ConditionsArguments& arguments);
/// Throws InputError for a condition that the result does not know, and where extrapolation is refused.
Conditions conditions_of(const FitResult& result, const ConditionsArguments& arguments);

/// The same of names and values, before a fit of this campaign that takes long. Throws InputError.
void require_known_conditions(const Campaign& campaign, const ConditionsArguments& arguments);

/// NAME=VALUE of an option that may be repeated. Throws InputError.
std::map<std::string, std::string> named_values(const std::string& option,
                                                const std::vector<std::string>& given);

}  // namespace volcal::cli
