#pragma once
/// The law behind a surface: products of elementary functions of its drivers that explain as much.
///
/// In: the state that a search has reached and one of its surfaces. Out: expressions whose evidence reaches
/// the surface's, best first. Both are judged at the state's noise against the model without the surface. A
/// law pays ln n / 2 for its amplitude and for every parameter of its shape, n readings, and the logarithm of
/// the number of laws tried (Schwarz 1978, Ann. Stat. 6, 461; Chen and Chen 2008, Biometrika 95, 759). Laws
/// are ranked by what the surface's splines follow of them, the best are then tested by their own columns.
/// Valid near the fit; for surfaces of one or two drivers.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

/// `surface`: place among the state's.
std::vector<FormulaFinding> formulas_for(const ModelState& state, std::size_t surface);

}  // namespace volcal
