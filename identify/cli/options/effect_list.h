#pragma once
/// What `volcal diagnose --list` prints: every kind of effect with its keys, and every target, driver and
/// shape that names in diagnosis.json, --effect and --separate are made of, each with what it means.

#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal::cli {

/// Full names (kind:target:driver:shape) of all that a diagnosis of the campaign against the model tests.
std::vector<std::string> testable_effects(const Campaign& campaign, const ModelSpec& spec);

/// `testable`: of a campaign; empty when none is given.
std::string effect_list_text(const std::vector<std::string>& testable);
/// `notes`: on the campaign's files.
std::string effect_list_json(const std::vector<std::string>& testable, const std::vector<Finding>& notes);

}  // namespace volcal::cli
