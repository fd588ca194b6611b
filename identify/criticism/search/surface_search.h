#pragma once
/// A surface or curve for what no name explains: an effect of the kind `empirical`, whose target and drivers
/// are those of a scan that exceeds the noise.
///
/// In: a tested model state and what its scans have found. Out: the surface of the highest evidence. SI;
/// natural logarithms. Judged by the marginal likelihood of the readings at the state's noise, the surface
/// under its prior with lengths and amplitude by evidence (surface_prior.h), over that without it: columns
/// projected off the model, so that nothing which the model can imitate counts. Valid near the fit.

#include <memory>
#include <optional>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

struct SurfaceTest {
  EffectSpec spec;  ///< without coefficients
  std::shared_ptr<const Effect> effect;
  UnknownFinding finding;     ///< that it explains
  double log_evidence = 0.0;  ///< over the state's model
};

/// Effects that might explain a finding: by all of its variables, and by each alone; by a direction also with
/// the travel since the axis turned.
std::vector<EffectSpec> surfaces_for(const LinearModel& model, const UnknownFinding& finding);

/// Columns of an effect off the model of a projector, one group.
ProjectedColumns projected_effect(const LinearModel& model, const Projector& projector, const Effect& effect);
/// Over the model of a projector, which has not got the surface.
double surface_evidence(const LinearModel& model, const Projector& projector, const Effect& surface);

/// A curve over its own axis of an error function that the given model holds at zero: no effect without a
/// name, but that function, which the search gives back.
bool is_error_left_out(const ModelState& state, const Effect& surface);

/// Nothing where none has an evidence above the threshold (thresholds.h).
std::optional<SurfaceTest> best_surface(const ModelState& state, const std::vector<UnknownFinding>& findings);

}  // namespace volcal
