#pragma once
/// Errors of the machine that the model holds at zero (left_out.h) are no effects beyond it: in a search they
/// come before effects that are no better, whatever has no name, and count among no limit of effects.
///
/// In: tests of families in one setting. Out: which of them comes first. Gains as in thresholds.h.

#include <functional>
#include <vector>

#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

bool is_left_out(const SearchSetting& setting, const FamilyTest& test);

/// Does better by more than chance; an error that the model holds at zero before an effect that does not do
/// better than it by as much.
bool comes_before(const SearchSetting& setting, const FamilyTest& one, const FamilyTest& other);

/// Of those that may be chosen; null: none may.
const FamilyTest* leading_errors_first(const SearchSetting& setting, const std::vector<FamilyTest>& tests,
                                       const std::function<bool(const FamilyTest&)>& may_be_chosen);

/// What is added where `best` is the best of all that exceed and `own`, null where there is none, the best of
/// the errors that the model holds at zero: null where `best` is an effect that something without a name does
/// better than.
const FamilyTest* first_to_add(const SearchSetting& setting, const FamilyTest& best, const FamilyTest* own,
                               const std::function<bool(const FamilyTest&)>& is_beaten_by_a_scan);

/// Of those that were added, the errors that the model holds at zero not counted.
int effects_beyond_errors(const ModelState& state);

/// An error function has other terms in `compared`, tests of the effects of `state` in their order, than it
/// has columns in the state.
bool any_order_differs(const ModelState& state, const std::vector<AddedEffect>& compared);

/// What effects are judged by in a state: not the positions of axes whose error functions came back. The
/// search holds these functions in a few polynomials, and what they leave along their axis is for the next
/// diagnosis.
bool is_held_in_few_terms(const ModelState& state, const Variable& variable);

/// An error function came back: the model that is fitted with it holds more of it than the search does.
bool any_function_came_back(const ModelState& state);

}  // namespace volcal
