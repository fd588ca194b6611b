#pragma once
/// Campaigns that a study has finished, kept in a file so that `--resume` goes on with it, and the loop over
/// those that are still open.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/model/description/errors.h"

namespace volcal::studies {

using TakeCampaign = std::function<void(const nlohmann::json& campaign, const SourcePlace& place)>;

/// Gives the campaign of a line to `take`; false, and nothing is taken, where a killed run left half a line.
/// Throws InputError where the line is no campaign of the study: nested too deeply, or `take` misses a value.
bool take_campaign(const std::string& line, const SourcePlace& place, const TakeCampaign& take);

/// The file FOLDER/NAME, a line of JSON a campaign; none where the folder is empty.
class FinishedCampaigns {
 public:
  /// Reads what an earlier run finished. Throws InputError where there is something and `resume` is false,
  /// and where the file cannot be written.
  FinishedCampaigns(const std::string& folder, const std::string& name, bool resume,
                    const TakeCampaign& take);
  /// Throws InputError when the disk is full.
  void append(const nlohmann::json& campaign);

 private:
  void read(const TakeCampaign& take);

  std::filesystem::path path_;
  std::ofstream file_;
};

/// What was finished before under a key; null: nothing.
template <class Key, class Record>
const Record* finished_before(const std::map<Key, Record>& known, const Key& key) {
  const auto found = known.find(key);
  return found == known.end() ? nullptr : &found->second;
}

/// Records of campaigns 0 ... count - 1: `known(i)` is a pointer to what was finished before, or null;
/// otherwise `make(i)`, on several threads, and `keep(i, record)`, by one thread at a time.
template <class Record, class Known, class Make, class Keep>
std::vector<Record> all_campaigns(std::size_t count, int threads,
                                  const std::function<void(int done, int all)>& progress, const Known& known,
                                  const Make& make, const Keep& keep) {
  std::vector<Record> records(count);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < count; ++i) {
    if (const Record* finished = known(i)) {
      records[i] = *finished;
    } else {
      open.push_back(i);
    }
  }
  std::size_t done = count - open.size();
  std::mutex reporting;
  run_parallel(open.size(), thread_count(threads), [&](std::size_t at) {
    Record record = make(open[at]);
    const std::lock_guard lock(reporting);
    keep(open[at], record);
    records[open[at]] = std::move(record);
    if (progress) progress(static_cast<int>(++done), static_cast<int>(count));
  });
  return records;
}

}  // namespace volcal::studies
