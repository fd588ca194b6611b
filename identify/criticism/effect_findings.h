#pragma once
/// Effects of the catalogue as a diagnosis reports them.
///
/// In: states of the model that a search has tested. Out: names with amplitudes, their standard uncertainties
/// and smallest detectable sizes, SI with the unit of the edge; log10 p family-wise. MDB: the amplitude that
/// chi-squared finds with the power of thresholds.h.
/// Valid about the fit.

#include <span>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

EffectFinding finding(const SearchSetting& setting, const FamilyTest& test);

/// Everything that was added, estimated together by a projector of the state: of all readings, or of those
/// that are not held out.
std::vector<EffectFinding> added_findings(const ModelState& state, const Projector& projector);

/// Fills names, changes of the model and sets of alternatives: everything that was added, estimated together
/// from all readings. What was held out has judged by now.
void list_added(const ModelState& reached, Diagnosis& diagnosis);
/// Fills what would have been found in the given model, and what could not be.
void list_detectable(const ModelState& given, Diagnosis& diagnosis);
/// Fills the ranking of what is not in the model.
void list_ranking(const ModelState& reached, Diagnosis& diagnosis);
/// Fills what the user thought of: beside the others where it was added, else at the model reached.
void list_tried(const ModelState& reached, std::span<const EffectSpec> own, Diagnosis& diagnosis);

}  // namespace volcal
