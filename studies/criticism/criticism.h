#pragma once
/// Model criticism counted over simulated campaigns, resumable: every finished campaign is a line of
/// campaigns.jsonl in the output folder.

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/studies/criticism/criticism_record.h"

namespace volcal::studies {

/// Which campaigns a study of model criticism makes, and where it keeps those that are finished.
struct CriticisedCampaigns {
  std::vector<std::string> rows;  ///< of criticism_rows()
  int campaigns = 20;             ///< per row; null: per kind of noise
  std::uint64_t seed = 1;
  int readings = 1500;
  int threads = 0;     ///< 0 = all; results do not depend on it
  std::string output;  ///< folder; empty = nothing is kept
  bool resume = false;
  std::function<void(int done, int all)> progress;
};

struct CriticismOptions : CriticisedCampaigns {
  std::set<SearchRule> without;  ///< rules of the search that are left out
};

/// In the order of rows and indices. Throws InputError for an output folder that holds campaigns already
/// (without `resume`), or campaigns of another seed, size or set of rules (with it).
std::vector<CampaignRecord> criticism(const CriticismOptions& options);

}  // namespace volcal::studies
