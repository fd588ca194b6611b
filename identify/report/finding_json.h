#pragma once
/// An effect of a diagnosis as sections of the report show it.

#include "volcal/identify/report/page.h"

namespace volcal::report {

/// label, kind, shape, log10_p, visible_fraction, resolution; amplitudes with value, U95, mdb in `unit`.
Json finding_json(const EffectFinding& effect);
/// plain, usual_causes of its kind's schema; the summary of a kind that says nothing plain, as one of the
/// user's own; of a change of the model nothing.
Json meaning_json(const EffectName& name);
/// label, shape, amplitude and U95 in `unit`.
Json law_json(const FormulaFinding& law);
/// What is drawn of it (surface_json.h), its laws and what is free.
Json surface_json(const SurfaceFinding& surface);
/// centre x factor, mean and noise in units of `value_unit`, count.
Json binned_json(const BinnedMean& means, double centre_factor, double value_factor);

}  // namespace volcal::report
