#pragma once
/// A campaign plan for the terminal.

#include <cstddef>
#include <string>

#include "volcal/identify/planning/campaign_plan.h"

namespace volcal {

/// What was asked for and what it costs; stations and runs; the target against the textbook's layout and the
/// given campaign; U and observability of every error; smallest detectable effects, one line a kind; what is
/// not visible and what one setup more would bring.
std::string plan_text(const CampaignPlan& plan);

/// Lengths and angles that the instrument reads at once.
std::size_t values_of_a_reading(const PlanSettings& settings);

/// "volumetric uncertainty (RMS of the vector)", "largest table value", "EXX", "reversal EXX from ..."
std::string target_words(const PlanSettings& settings);

/// The campaign that a plan is compared with: what it extends, or the textbook's.
const ExpectedCampaign& compared_with(const CampaignPlan& plan);

/// Target's standard uncertainty of the plan over that of what it is compared with.
double target_ratio(const CampaignPlan& plan);

/// What the search found, where the textbook's layout took its place; empty otherwise.
std::string replaced_words(const CampaignPlan& plan);

}  // namespace volcal
