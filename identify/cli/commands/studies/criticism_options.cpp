#include "volcal/identify/cli/commands/studies/criticism_options.h"

#include <fmt/format.h>

#include <CLI/Validators.hpp>

#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/studies/criticism/criticism_plan.h"

namespace volcal::cli {

std::vector<std::string> names_of_rules() {
  std::vector<std::string> names;
  for (const SearchRule rule : search_rules()) names.emplace_back(name_of(rule));
  return names;
}

std::string described_rules() {
  std::vector<std::string> described;
  for (const SearchRule rule : search_rules())
    described.push_back(fmt::format("{} ({})", name_of(rule), description_of(rule)));
  return fmt::format("rules of the search: {}", fmt::join(described, ", "));
}

void add_campaign_options(CLI::App& app, studies::CriticisedCampaigns& campaigns, const std::string& file) {
  const std::vector<std::string> rows(studies::criticism_rows().begin(), studies::criticism_rows().end());
  app.add_option("--rows", campaigns.rows, fmt::format("{}; default: all", fmt::join(rows, ", ")))
      ->delimiter(',')
      ->check(CLI::IsMember(rows));
  app.add_option("-n,--campaigns", campaigns.campaigns, "per row; row null: per kind of noise")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", campaigns.seed, "of the first campaign, the others follow")->capture_default_str();
  app.add_option("--readings", campaigns.readings, "of a campaign, about")
      ->check(CLI::Range(400, 100'000))
      ->capture_default_str();
  add_archive_options(app, campaigns.output, campaigns.resume, file);
}

void complete_rows(studies::CriticisedCampaigns& campaigns) {
  if (campaigns.rows.empty())
    campaigns.rows.assign(studies::criticism_rows().begin(), studies::criticism_rows().end());
}

}  // namespace volcal::cli
