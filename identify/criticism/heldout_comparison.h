#pragma once
/// A model judged on lines that its fit has not seen.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// Every fifth line of every setup (ladder.h); a setup of which nothing would remain keeps all its readings.
std::vector<std::vector<bool>> judging_rows(const Campaign& campaign, double share = 0.2);

/// The campaign with the marked rows left out. They stay in their places: where a beam begins and points to,
/// and what a late temperature has behind it, is that of the whole campaign.
Campaign without_rows(const Campaign& campaign, const std::vector<std::vector<bool>>& marked);

/// The model of a result with everything to be estimated again, functions that were smoothed at automatic
/// resolution.
ModelSpec refittable_model(const FitResult& result);

struct HeldOutOptions {
  int threads = 0;
  bool fit = true;  ///< false: the model's own coefficients are judged, as for the nominal machine
  std::function<void(const std::string& stage, double done)> progress;
};

/// Residuals of the marked readings alone. The model is fitted to the others; then its functions and effects
/// are held, and stations, dead paths and the like estimated anew from all readings. Throws InputError.
std::vector<ResidualRecord> heldout_residuals(const Campaign& campaign, const ModelSpec& model,
                                              const std::vector<std::vector<bool>>& heldout,
                                              const HeldOutOptions& options);

}  // namespace volcal
