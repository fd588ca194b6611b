#pragma once
/// The law behind a surface: products of elementary functions of its drivers that explain as much.
///
/// In: the state that a search has reached and one of its surfaces, or a surface that a user asks about. Out:
/// expressions, best first. Both are judged at the state's noise against the model without the surface. A law
/// pays ln n / 2 for its amplitude and for every parameter of its shape, n readings, and the logarithm of the
/// number of laws tried (Schwarz 1978, Ann. Stat. 6, 461; Chen and Chen 2008, Biometrika 95, 759). Laws are
/// ranked by what the surface's splines follow of them, of two drivers all, of three by beam search, one
/// driver's function after another exchanged; the best are then tested by their own columns, and the best of
/// these with a further recorded variable as a factor. Valid near the fit.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

/// Laws whose evidence reaches the surface's. `surface`: place among the state's.
std::vector<FormulaFinding> formulas_for(const ModelState& state, std::size_t surface);

/// Whether two effects of the kind `empirical` are functions of the same variables, whatever their order,
/// with the same factors, on the same target.
bool is_same_function(const EffectSpec& surface, const EffectSpec& other);

/// Throws InputError where laws cannot be looked for behind a surface in a campaign.
void check_asked_surface(const LinearModel& model, const EffectSpec& surface);

/// The best laws of a target and drivers that the user names, whether or not they reach the surface's
/// evidence; in the place of the surface of these variables where the state has one. `surface`: of the kind
/// `empirical`, checked.
AskedLaws asked_laws(const ModelState& state, const EffectSpec& surface);

}  // namespace volcal
