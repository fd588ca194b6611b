#pragma once
/// Files of a campaign plan.

#include <string>

#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal {

inline constexpr const char* kPlanFormat = "volcal-plan-1";

/// Everything of the plan, edge units: budget, stations, runs, figures of every campaign, errors, effects,
/// options.
std::string plan_json(const CampaignPlan& plan);

/// study.toml that `volcal simulate` measures the plan with on a random machine: its runs and, when it
/// extends a campaign, those of that campaign that the instrument can repeat. Points are read from campaign/.
std::string plan_study_toml(const CampaignPlan& plan);

/// machine.toml, campaign/ (campaign.toml and one CSV a setup, nominal readings to be replaced), study.toml.
/// The caller adds plan.json and commits the folder.
void write_plan_campaign(const CampaignPlan& plan, const AtomicFolder& folder);

}  // namespace volcal
