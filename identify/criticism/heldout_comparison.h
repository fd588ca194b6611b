#pragma once
/// A model judged on lines that its fit has not seen.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

inline constexpr double kShareOfJudging = 0.2;

/// Every fifth line of every setup (ladder.h); a setup of which nothing would remain keeps all its readings.
std::vector<std::vector<bool>> judging_rows(const Campaign& campaign, double share = kShareOfJudging);

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

/// What readings that no fit has seen say of a model with something added, by chi-squared with the sigma of
/// the records.
struct HeldOutGain {
  double chi2 = 0.0;       ///< without less with: greater than 0 where the model with it is nearer
  double by_chance = 0.0;  ///< that the readings' noise alone makes of it, either way, with 95 % at most

  bool is_better() const { return chi2 > by_chance; }
  bool is_worse() const { return chi2 < -by_chance; }
};

/// `without` and `with`: the same readings in the same order (heldout_residuals()). With d the difference of
/// the standardised predictions, sum d^2 = D, and e the noise, the gain is -D + 2 sum d e where what was
/// added is not there, and D + 2 sum d e where it is there as fitted. Independent noise of variance s^2
/// takes 2 sum d e beyond 2 k s sqrt(D) in one case in forty (k = 1.96), and -D + 2 k s sqrt(D) is k^2 s^2
/// at most, whatever D is: the 95 % point of chi-squared with one degree of freedom. s^2 is the mean square
/// of the residuals of the model that is nearer; where their products with d add up over a line (ladder.h),
/// as offsets of lines and drifts make them, sum over lines (sum d e)^2 / D takes its place.
HeldOutGain heldout_gain(const Campaign& campaign, const std::vector<ResidualRecord>& without,
                         const std::vector<ResidualRecord>& with);

}  // namespace volcal
