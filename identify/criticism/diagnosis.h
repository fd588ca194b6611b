#pragma once
/// Where a model fails to explain the readings, and which physical effect is missing.
///
///   1. the noise model by restricted likelihood,
///   2. score tests of every named family, after projection off the model,
///   3. generic scans, because the catalogue is never complete,
///   4. a verdict in the user's words; effects are added one by one until nothing is left, and told all with
///      `climb`, else the first.
///
/// A share of the lines is held out: they never choose, and judge every step.

#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

struct DiagnoseOptions {
  int threads = 1;     ///< 0 = as many as the machine has; results do not depend on it
  bool climb = false;  ///< tell all effects that were found, not the first alone
  int most_effects = 8;
  double heldout_share = 0.1;
  bool figures = true;                 ///< what the report draws; a study leaves it out
  std::vector<std::string> leave_out;  ///< kinds of effects that are not looked for
  std::vector<EffectSpec> own;  ///< effects that the user thinks of, judged like those of the catalogue
  std::vector<EffectSpec> asked_laws;  ///< surfaces (kind `empirical`) behind which laws are looked for
  bool compare = true;                 ///< MIB, confounding matrix, next measurement
  PlanningOptions planning;
  SearchRules rules;  ///< of the search; a study leaves some out
  std::function<void(const std::string& stage, double done)> progress;
};

class ModelState;

/// A diagnosis with the fit that it is of.
struct DiagnosedModel {
  FitResult fit;
  Diagnosis diagnosis;
};

/// Adjusts the campaign by the model as a diagnosis wants it, outliers removed and readings independent,
/// since the diagnosis estimates the noise at every step anew; then diagnoses that.
DiagnosedModel diagnose_model(const Campaign& campaign, const ModelSpec& model,
                              const DiagnoseOptions& options);

/// `result` must come from fit() of this campaign.
Diagnosis diagnose(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options);
/// The same where the noise about `result` is known already: `given` is its linear model at that noise, and
/// its held-out lines count, not the share of the options.
Diagnosis diagnose(const FitResult& result, const ModelState& given, const DiagnoseOptions& options);

}  // namespace volcal
