#include "volcal/studies/criticism/previews.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/session/session.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/nesting.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/study.h"
#include "volcal/studies/criticism/criticism_campaign.h"

namespace volcal::cli {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PreviewRecord, effect, miss, said)
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
  const SessionModel& confirmed = session.take(session.confirmation());
  return {full_name(effect), largest_miss(preview, confirmed.effects.back()),
          confirmed.standing == ModelStanding::Contradicted};
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

/// The file of finished campaigns. A line that a killed run left half written is dropped.
class PreviewArchive {
 public:
  explicit PreviewArchive(const PreviewsOptions& options) : options_(options) {
    if (options.output.empty()) return;
    path_ = std::filesystem::path(options.output) / "previews.jsonl";
    std::filesystem::create_directories(options.output);
    if (std::filesystem::exists(path_)) {
      if (!options.resume)
        throw InputError({path_.string(), 0}, "it holds the campaigns of an earlier run",
                         "add --resume to go on with it, or choose another folder");
      read();
    }
    file_.open(path_, std::ios::app);
    if (!file_) throw InputError({path_.string(), 0}, "it cannot be written", "choose another folder");
  }

  const PreviewedCampaign* find(const std::string& name) const {
    const auto found = records_.find(name);
    return found == records_.end() ? nullptr : &found->second;
  }

  void append(const PreviewedCampaign& record) {
    if (path_.empty()) return;
    file_ << json_text(nlohmann::json(record), -1) << '\n' << std::flush;
    if (!file_) throw InputError({path_.string(), 0}, "it cannot be written", "make room on the disk");
  }

 private:
  void read() {
    std::ifstream file(path_);
    std::string line, complete;
    for (int number = 1; std::getline(file, line) && !file.eof(); ++number) {
      require_shallow(line, NestedText::Json, path_.string());
      const auto json = nlohmann::json::parse(line, nullptr, false);
      if (json.is_discarded()) continue;
      try {
        add(json.get<PreviewedCampaign>());
      } catch (const nlohmann::json::exception&) {
        throw InputError({path_.string(), number}, "the line is no campaign of this study",
                         "choose another folder, or delete the file to begin anew");
      }
      complete += line + '\n';
    }
    file.close();
    std::ofstream(path_, std::ios::trunc) << complete;
  }

  void add(const PreviewedCampaign& record) {
    if (record.seed != options_.seed || record.readings != options_.readings)
      throw InputError({path_.string(), 0},
                       "it holds campaigns of --seed " + std::to_string(record.seed) + " --readings " +
                           std::to_string(record.readings),
                       "give the same, or choose another folder");
    records_[record.campaign] = record;
  }

  const PreviewsOptions& options_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::map<std::string, PreviewedCampaign> records_;
};

}  // namespace

std::vector<PreviewedCampaign> previews(const PreviewsOptions& options) {
  PreviewArchive archive(options);
  const std::vector<PreviewJob> jobs = preview_jobs(options);
  std::vector<PreviewedCampaign> records(jobs.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (const PreviewedCampaign* known = archive.find(jobs[i].name)) {
      records[i] = *known;
    } else {
      open.push_back(i);
    }
  }
  std::size_t done = jobs.size() - open.size();
  std::mutex reporting;
  run_parallel(open.size(), thread_count(options.threads), [&](std::size_t at) {
    PreviewedCampaign record = preview_campaign(jobs[open[at]], options);
    const std::lock_guard lock(reporting);
    archive.append(record);
    records[open[at]] = std::move(record);
    if (options.progress) options.progress(static_cast<int>(++done), static_cast<int>(jobs.size()));
  });
  return records;
}

Share previews_that_held(const std::vector<PreviewedCampaign>& campaigns) {
  Share share;
  for (const PreviewedCampaign& campaign : campaigns) {
    for (const PreviewRecord& preview : campaign.previews) {
      ++share.of;
      share.count += preview.miss < kHolds ? 1 : 0;
    }
  }
  return share;
}

Share misses_said(const std::vector<PreviewedCampaign>& campaigns) {
  Share share;
  for (const PreviewedCampaign& campaign : campaigns) {
    for (const PreviewRecord& preview : campaign.previews) {
      if (preview.miss < kHolds) continue;
      ++share.of;
      share.count += preview.said ? 1 : 0;
    }
  }
  return share;
}

}  // namespace volcal::cli
