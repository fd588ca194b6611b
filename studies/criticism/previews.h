#pragma once
/// Linear previews of a session against the full fits that confirm them, counted over campaigns; resumable:
/// every finished campaign is a line of previews.jsonl in the output folder.
///
/// In every campaign the leading effect that exceeds the noise is added, refitted and confirmed, again and
/// again. A preview or a refit holds where each of its amplitudes is less than U95/4 from that of the full
/// fit.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "volcal/studies/criticism/criticism_figures.h"

namespace volcal::studies {

/// An effect that was added and confirmed.
struct PreviewRecord {
  std::string effect;       ///< kind:target:driver:shape
  double miss = 0.0;        ///< of the amplitude that is off by most of its U95, over that
  double refit_miss = 0.0;  ///< the same of the refit
  bool said = false;        ///< the session says that the refit was off
};

struct PreviewedCampaign {
  std::string campaign;  ///< row and index, "listed:3", or a file
  std::uint64_t seed = 0;
  int readings = 0;  ///< wanted, of simulated campaigns
  std::string failure;
  std::vector<PreviewRecord> previews;
};

struct PreviewsOptions {
  std::vector<std::string> rows = {"listed", "pairs"};  ///< of criticism_rows()
  int campaigns = 20;                                   ///< per row
  std::vector<std::string> files;  ///< campaign.toml, besides; no row is simulated where campaigns is 0
  std::uint64_t seed = 1;
  int readings = 1500;
  int most = 4;  ///< effects of a campaign
  int threads = 0;
  std::string output;  ///< folder; empty = nothing is kept
  bool resume = false;
  std::function<void(int done, int all)> progress;
};

/// In the order of rows and indices, then files. Throws InputError for an output folder that holds campaigns
/// already (without `resume`), or those of another seed or size (with it).
std::vector<PreviewedCampaign> previews(const PreviewsOptions& options);

/// Previews that held, of all.
Share previews_that_held(const std::vector<PreviewedCampaign>& campaigns);
/// Refits that held, of all.
Share refits_that_held(const std::vector<PreviewedCampaign>& campaigns);
/// Of refits that did not hold, how many the session said so of.
Share misses_said(const std::vector<PreviewedCampaign>& campaigns);

}  // namespace volcal::studies
