#pragma once
/// An effect of the user's own, tried: its size by a full fit, whether it predicts readings better that no
/// fit has seen, and what remains above the noise with it in the model.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/heldout_comparison.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/standards/comparison.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// An amplitude or a parameter of the effect, at the edge.
struct TriedValue {
  std::string name;
  std::string unit;
  double value = 0.0;
  double u = 0.0;  ///< NaN: held at its value
};

struct TriedEffect {
  std::vector<TriedValue> values;
  std::string not_visible;  ///< why; empty = visible
  FitStatus status = FitStatus::Ok;
  bool judged = false;       ///< the setups have lines to hold out
  Comparison without, with;  ///< of the same lines, seen by neither fit
  HeldOutGain gain;          ///< of these
  Diagnosis remains;         ///< of the model with the effect: names one by one, nothing drawn

  /// Whether it is visible and its fit has converged.
  bool done() const { return not_visible.empty() && status != FitStatus::NotConverged; }
};

struct TryOptions {
  int threads = 0;  ///< 0 = all; results do not depend on it
  std::function<void(const std::string& stage, double done)> progress;
};

/// `model`: that the effect is added to. Throws InputError where the model has it already or nothing recorded
/// drives it.
TriedEffect try_effect(const Campaign& campaign, const ModelSpec& model, const WrittenEffect& effect,
                       const TryOptions& options);

}  // namespace volcal
