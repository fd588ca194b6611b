#include "volcal/studies/criticism/criticism.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "volcal/model/description/errors.h"
#include "volcal/studies/criticism/criticism_campaign.h"
#include "volcal/studies/criticism/criticism_plan.h"
#include "volcal/studies/files/finished_campaigns.h"

namespace volcal::studies {
namespace {

using Key = std::pair<std::string, int>;  // row and index

struct Job {
  std::string row;
  int index = 0;
};

std::vector<Job> jobs_of(const CriticismOptions& options) {
  std::vector<Job> jobs;
  for (const std::string& row : options.rows) {
    const int count =
        options.campaigns * (is_null_row(row) ? static_cast<int>(criticism_noises().size()) : 1);
    for (int index = 0; index < count; ++index) jobs.push_back({row, index});
  }
  return jobs;
}

void require_same(const CampaignRecord& record, const CriticismOptions& options, const SourcePlace& place) {
  std::vector<std::string> without;
  for (const SearchRule rule : options.without) without.emplace_back(name_of(rule));
  if (record.seed == options.seed && record.wanted_readings == options.readings && record.without == without)
    return;
  const std::string rules =
      record.without.empty() ? "" : fmt::format(" --without {}", fmt::join(record.without, ","));
  throw InputError({place.file, 0},
                   fmt::format("it holds campaigns of --seed {} --readings {}{}", record.seed,
                               record.wanted_readings, rules),
                   "give the same, or choose another folder");
}

}  // namespace

std::vector<CampaignRecord> criticism(const CriticismOptions& options) {
  std::map<Key, CampaignRecord> known;
  FinishedCampaigns finished(options.output, "campaigns.jsonl", options.resume,
                             [&](const nlohmann::json& json, const SourcePlace& place) {
                               auto record = json.get<CampaignRecord>();
                               require_same(record, options, place);
                               const Key key(record.row, record.index);
                               known[key] = std::move(record);
                             });
  const std::vector<Job> jobs = jobs_of(options);
  return all_campaigns<CampaignRecord>(
      jobs.size(), options.threads, options.progress,
      [&](std::size_t i) { return finished_before(known, Key(jobs[i].row, jobs[i].index)); },
      [&](std::size_t i) {
        return criticise_campaign(jobs[i].row, jobs[i].index, options.seed, options.readings,
                                  {.off = options.without, .decided = {}});
      },
      [&](std::size_t, const CampaignRecord& record) { finished.append(record); });
}

}  // namespace volcal::studies
