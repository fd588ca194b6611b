#include "volcal/studies/criticism/previews.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/session/session.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/study.h"
#include "volcal/studies/criticism/criticism_campaign.h"
#include "volcal/studies/files/finished_campaigns.h"

namespace volcal::studies {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PreviewRecord, effect, miss, refit_miss, said)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PreviewedCampaign, campaign, seed, readings, failure, previews)

namespace {

constexpr double kHolds = 0.25;  // of U95
constexpr double kRisk = 0.05;   // of one exceedance by chance in the whole catalogue

struct PreviewJob {
  std::string name;
  std::string row;  ///< empty: a file
  int index = 0;
};

std::vector<PreviewJob> preview_jobs(const PreviewsOptions& options) {
  std::vector<PreviewJob> jobs;
  for (const std::string& row : options.rows) {
    for (int index = 0; index < options.campaigns; ++index)
      jobs.push_back({row + ":" + std::to_string(index), row, index});
  }
  for (const std::string& file : options.files) jobs.push_back({file, "", 0});
  return jobs;
}

std::optional<Campaign> campaign_of(const PreviewJob& job, const PreviewsOptions& options) {
  if (job.row.empty()) return read_campaign(job.name);
  const auto study = study_of_campaign(job.row, job.index, options.seed, options.readings);
  if (!study) return std::nullopt;
  return sim::simulate(*study).campaign;
}

/// The leading effect with a name, where it exceeds the noise.
std::optional<EffectName> leading_effect(Session& session) {
  for (const EffectFinding& effect : session.rank()) {
    if (!effect.resolution)
      return effect.log10_p < std::log10(kRisk) ? std::optional(effect.name) : std::nullopt;
  }
  return std::nullopt;
}

double largest_miss(const EffectFinding& preview, const EffectFinding& fitted) {
  double largest = 0.0;
  for (std::size_t k = 0; k < std::min(preview.amplitudes.size(), fitted.amplitudes.size()); ++k) {
    const AmplitudeFigure& after = fitted.amplitudes[k];
    largest =
        std::max(largest, std::abs(preview.amplitudes[k].value - after.value) / (kCoverageFactor * after.u));
  }
  return largest;
}

PreviewRecord add_and_confirm(Session& session, const EffectName& effect) {
  const EffectFinding preview = session.add(effect).effects.back();
  const EffectFinding refit = session.take(session.refit()).effects.back();
  const SessionModel& confirmed = session.take(session.confirmation());
  return {full_name(effect), largest_miss(preview, confirmed.effects.back()),
          largest_miss(refit, confirmed.effects.back()), confirmed.standing == ModelStanding::Contradicted};
}

PreviewedCampaign preview_campaign(const PreviewJob& job, const PreviewsOptions& options) {
  PreviewedCampaign record{job.name, options.seed, options.readings, "", {}};
  try {
    std::optional<Campaign> campaign = campaign_of(job, options);
    if (!campaign) {
      record.failure = "no effect drawn is visible in this layout";
      return record;
    }
    SessionOptions of_session;
    of_session.threads = 1;
    Session session(*std::move(campaign), {}, of_session);
    for (int k = 0; k < options.most; ++k) {
      const std::optional<EffectName> effect = leading_effect(session);
      if (!effect) break;
      record.previews.push_back(add_and_confirm(session, *effect));
    }
  } catch (const InputError& error) {
    record.failure = error.what();
  }
  return record;
}

void require_same(const PreviewedCampaign& record, const PreviewsOptions& options, const SourcePlace& place) {
  if (record.seed == options.seed && record.readings == options.readings) return;
  throw InputError({place.file, 0},
                   "it holds campaigns of --seed " + std::to_string(record.seed) + " --readings " +
                       std::to_string(record.readings),
                   "give the same, or choose another folder");
}

}  // namespace

std::vector<PreviewedCampaign> previews(const PreviewsOptions& options) {
  std::map<std::string, PreviewedCampaign> known;
  FinishedCampaigns finished(options.output, "previews.jsonl", options.resume,
                             [&](const nlohmann::json& json, const SourcePlace& place) {
                               auto record = json.get<PreviewedCampaign>();
                               require_same(record, options, place);
                               const std::string name = record.campaign;
                               known[name] = std::move(record);
                             });
  const std::vector<PreviewJob> jobs = preview_jobs(options);
  return all_campaigns<PreviewedCampaign>(
      jobs.size(), options.threads, options.progress,
      [&](std::size_t i) { return finished_before(known, jobs[i].name); },
      [&](std::size_t i) { return preview_campaign(jobs[i], options); },
      [&](std::size_t, const PreviewedCampaign& record) { finished.append(record); });
}

namespace {

Share that_held(const std::vector<PreviewedCampaign>& campaigns, double PreviewRecord::*miss) {
  Share share;
  for (const PreviewedCampaign& campaign : campaigns) {
    for (const PreviewRecord& preview : campaign.previews) {
      ++share.of;
      share.count += preview.*miss < kHolds ? 1 : 0;
    }
  }
  return share;
}

}  // namespace

Share previews_that_held(const std::vector<PreviewedCampaign>& campaigns) {
  return that_held(campaigns, &PreviewRecord::miss);
}

Share refits_that_held(const std::vector<PreviewedCampaign>& campaigns) {
  return that_held(campaigns, &PreviewRecord::refit_miss);
}

Share misses_said(const std::vector<PreviewedCampaign>& campaigns) {
  Share share;
  for (const PreviewedCampaign& campaign : campaigns) {
    for (const PreviewRecord& preview : campaign.previews) {
      if (preview.refit_miss < kHolds) continue;
      ++share.of;
      share.count += preview.said ? 1 : 0;
    }
  }
  return share;
}

}  // namespace volcal::studies
