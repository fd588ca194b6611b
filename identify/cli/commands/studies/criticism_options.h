#pragma once
/// Options that studies of model criticism share.

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "volcal/studies/criticism/criticism.h"

namespace volcal::cli {

/// "one-cause", ... in their order.
std::vector<std::string> names_of_rules();
/// "rules of the search: one-cause (a curve takes the place of two names), ..."
std::string described_rules();

/// --rows, -n, --seed, --readings, -o and --resume; `file`: in which the folder keeps campaigns.
void add_campaign_options(CLI::App& app, studies::CriticisedCampaigns& campaigns, const std::string& file);
/// All rows where none was asked for.
void complete_rows(studies::CriticisedCampaigns& campaigns);

}  // namespace volcal::cli
