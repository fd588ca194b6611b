#include "volcal/studies/criticism/criticism.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/errors.h"
#include "volcal/studies/criticism/criticism_campaign.h"
#include "volcal/studies/criticism/criticism_plan.h"

namespace volcal::cli {
namespace {

using Key = std::pair<std::string, int>;  // row and index

struct Job {
  std::string row;
  int index = 0;
};

std::vector<Job> jobs_of(const CriticismOptions& options) {
  std::vector<Job> jobs;
  for (const std::string& row : options.rows) {
    const int count = options.campaigns * (row == "null" ? static_cast<int>(criticism_noises().size()) : 1);
    for (int index = 0; index < count; ++index) jobs.push_back({row, index});
  }
  return jobs;
}

/// The file of finished campaigns. A line that a killed run left half written is dropped.
class Archive {
 public:
  explicit Archive(const CriticismOptions& options) : options_(options) {
    if (options.output.empty()) return;
    path_ = std::filesystem::path(options.output) / "campaigns.jsonl";
    std::filesystem::create_directories(options.output);
    if (std::filesystem::exists(path_)) {
      if (!options.resume) {
        throw InputError({path_.string(), 0}, "it holds the campaigns of an earlier run",
                         "add --resume to go on with it, or choose another folder");
      }
      read();
    }
    file_.open(path_, std::ios::app);
    if (!file_) throw InputError({path_.string(), 0}, "it cannot be written", "choose another folder");
  }

  const CampaignRecord* find(const Job& job) const {
    const auto found = records_.find({job.row, job.index});
    return found == records_.end() ? nullptr : &found->second;
  }

  void append(const CampaignRecord& record) {
    if (path_.empty()) return;
    file_ << json_text(nlohmann::json(record), -1) << '\n' << std::flush;
    if (!file_) throw InputError({path_.string(), 0}, "it cannot be written", "make room on the disk");
  }

 private:
  void read() {
    std::ifstream file(path_);
    std::string line, complete;
    for (int number = 1; std::getline(file, line) && !file.eof(); ++number) {
      const auto record = record_of_line(line, {path_.string(), number});
      if (!record) continue;
      add(*record);
      complete += line + '\n';
    }
    file.close();
    std::ofstream(path_, std::ios::trunc) << complete;
  }

  void add(const CampaignRecord& record) {
    if (record.seed != options_.seed || record.wanted_readings != options_.readings) {
      throw InputError({path_.string(), 0},
                       "it holds campaigns of --seed " + std::to_string(record.seed) + " --readings " +
                           std::to_string(record.wanted_readings),
                       "give the same, or choose another folder");
    }
    records_[{record.row, record.index}] = record;
  }

  const CriticismOptions& options_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::map<Key, CampaignRecord> records_;
};

}  // namespace

std::vector<CampaignRecord> criticism(const CriticismOptions& options) {
  Archive archive(options);
  const std::vector<Job> jobs = jobs_of(options);
  std::vector<CampaignRecord> records(jobs.size());
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (const CampaignRecord* known = archive.find(jobs[i])) {
      records[i] = *known;
    } else {
      open.push_back(i);
    }
  }
  std::size_t done = jobs.size() - open.size();
  std::mutex reporting;
  run_parallel(open.size(), thread_count(options.threads), [&](std::size_t at) {
    const Job& job = jobs[open[at]];
    CampaignRecord record = criticise_campaign(job.row, job.index, options.seed, options.readings);
    const std::lock_guard lock(reporting);
    archive.append(record);
    records[open[at]] = std::move(record);
    if (options.progress) options.progress(static_cast<int>(++done), static_cast<int>(jobs.size()));
  });
  return records;
}

}  // namespace volcal::cli
