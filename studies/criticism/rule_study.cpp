#include "volcal/studies/criticism/rule_study.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/model/description/errors.h"
#include "volcal/studies/criticism/criticism_campaign.h"
#include "volcal/studies/criticism/criticism_outcome.h"
#include "volcal/studies/criticism/criticism_plan.h"
#include "volcal/studies/files/finished_campaigns.h"

namespace volcal::studies {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RuleCampaign, all, seconds, decided, without, seconds_without)

namespace {

constexpr double kRemovedShare = 0.9;
constexpr double kSameError = 0.01;  // share of a mean square; less is another rounding of the same model

using RuleKey = std::pair<std::string, int>;  // row and index

std::vector<RuleKey> keys_in_turn(const RuleStudyOptions& options) {
  const int noises = static_cast<int>(criticism_noises().size());
  std::vector<RuleKey> keys;
  for (int index = 0; index < options.campaigns; ++index) {
    for (const std::string& row : options.rows) {
      for (int k = 0; k < (is_null_row(row) ? noises : 1); ++k)
        keys.emplace_back(row, is_null_row(row) ? noises * index + k : index);
    }
  }
  return keys;
}

RuleCampaign campaign_with_and_without(const RuleKey& key, const RuleStudyOptions& options) {
  RuleCampaign campaign;
  std::set<SearchRule> decided;
  const SearchRules every{.off = {}, .decided = [&](SearchRule rule) { decided.insert(rule); }};
  campaign.all = criticise_campaign(key.first, key.second, options.seed, options.readings, every);
  campaign.seconds = campaign.all.seconds;
  for (const SearchRule rule : decided) {
    const std::string name(name_of(rule));
    campaign.decided.push_back(name);
    if (std::ranges::find(options.rules, name) == options.rules.end()) continue;
    const SearchRules others{.off = {rule}, .decided = {}};
    CampaignRecord record = criticise_campaign(key.first, key.second, options.seed, options.readings, others);
    campaign.seconds_without[name] = record.seconds;
    campaign.without[name] = std::move(record);
  }
  return campaign;
}

/// The same study, and every rule that decided something was left out.
void require_same_study(const RuleCampaign& campaign, const RuleStudyOptions& options,
                        const SourcePlace& place) {
  const auto missing = [&](const std::string& rule) {
    return std::ranges::find(options.rules, rule) != options.rules.end() && !campaign.without.contains(rule);
  };
  if (campaign.all.seed == options.seed && campaign.all.wanted_readings == options.readings &&
      std::ranges::none_of(campaign.decided, missing))
    return;
  throw InputError({place.file, 0},
                   "it holds campaigns of --seed " + std::to_string(campaign.all.seed) + " --readings " +
                       std::to_string(campaign.all.wanted_readings) + ", or of fewer rules",
                   "give the same, or choose another folder");
}

std::vector<std::string> reported_names(const CampaignRecord& record) {
  std::vector<std::string> names = {record.verdict};
  for (const AnswerRecord& answer : record.named) names.push_back(answer.name);
  for (const auto& set : record.sets) {
    names.emplace_back("one of");
    for (const AnswerRecord& answer : set) names.push_back(answer.name);
  }
  for (const std::string& drawn : record.drawn) names.push_back(drawn);
  if (!record.unknown.empty()) {
    names.push_back(record.unknown.front().direction);
    std::ranges::copy(record.unknown.front().variables, std::back_inserter(names));
  }
  return names;
}

bool reported_otherwise(const CampaignRecord& one, const CampaignRecord& other) {
  return reported_names(one) != reported_names(other) ||
         std::abs(one.ms_offered - other.ms_offered) > kSameError * one.ms_offered;
}

bool is_right(const CampaignRecord& record) {
  const Outcome outcome = outcome_of(record);
  const bool stranger = record.row == "unlisted" || record.row == "left-out" || record.row == "behind";
  return outcome == Outcome::Right || outcome == Outcome::RightInSet || outcome == Outcome::RightInClasses ||
         (stranger && outcome == Outcome::Unknown);
}

void count_into(RuleCounts& counts, const CampaignRecord& record) {
  if (!record.failure.empty()) return;
  if (record.hidden.empty()) {
    counts.alarms += outcome_of(record) == Outcome::Right ? 0 : 1;
    return;
  }
  counts.right += is_right(record) ? 1 : 0;
  counts.wrong += outcome_of(record) == Outcome::Wrong && remainder_of(record) >= kUndetectable ? 1 : 0;
  if (!record.recovery) return;
  ++counts.of_removed;
  counts.removed += recovered_share(record, record.ms_offered) >= kRemovedShare ? 1 : 0;
}

RuleRow row_of(const std::vector<RuleCampaign>& campaigns, const std::string& rule) {
  RuleRow row{.rule = rule, .counts = {}};
  for (const RuleCampaign& campaign : campaigns) {
    const auto without = campaign.without.find(rule);
    const bool again = without != campaign.without.end();
    row.decided += again ? 1 : 0;
    row.changed += again && reported_otherwise(campaign.all, without->second) ? 1 : 0;
    count_into(row.counts, again ? without->second : campaign.all);
    row.counts.seconds += again ? campaign.seconds_without.at(rule) : campaign.seconds;
  }
  return row;
}

}  // namespace

std::vector<RuleCampaign> rule_study(const RuleStudyOptions& options) {
  std::map<RuleKey, RuleCampaign> known;
  FinishedCampaigns finished(options.output, "rules.jsonl", options.resume,
                             [&](const nlohmann::json& json, const SourcePlace& place) {
                               auto campaign = json.get<RuleCampaign>();
                               require_same_study(campaign, options, place);
                               const RuleKey key(campaign.all.row, campaign.all.index);
                               known[key] = std::move(campaign);
                             });
  const std::vector<RuleKey> keys = keys_in_turn(options);
  return all_campaigns<RuleCampaign>(
      keys.size(), options.threads, options.progress,
      [&](std::size_t i) { return finished_before(known, keys[i]); },
      [&](std::size_t i) { return campaign_with_and_without(keys[i], options); },
      [&](std::size_t, const RuleCampaign& campaign) { finished.append(campaign); });
}

std::vector<RuleRow> rows_of(const std::vector<RuleCampaign>& campaigns,
                             const std::vector<std::string>& rules) {
  std::vector<RuleRow> rows = {row_of(campaigns, "")};
  for (const std::string& rule : rules) rows.push_back(row_of(campaigns, rule));
  return rows;
}

}  // namespace volcal::studies
