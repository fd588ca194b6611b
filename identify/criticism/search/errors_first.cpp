#include "volcal/identify/criticism/search/errors_first.h"

#include <algorithm>

#include "volcal/identify/criticism/data/thresholds.h"

namespace volcal {

bool is_left_out(const SearchSetting& setting, const FamilyTest& test) {
  return setting.families[test.family].is_left_out();
}

bool comes_before(const SearchSetting& setting, const FamilyTest& one, const FamilyTest& other) {
  const double margin = kThresholds.indistinguishable_gain;
  const bool favoured = is_left_out(setting, one) && !is_left_out(setting, other);
  return one.gain > other.gain + (favoured ? -margin : margin);
}

const FamilyTest* leading_errors_first(const SearchSetting& setting, const std::vector<FamilyTest>& tests,
                                       const std::function<bool(const FamilyTest&)>& may_be_chosen) {
  const FamilyTest *best = nullptr, *own = nullptr;
  for (const FamilyTest& test : tests) {
    if (!may_be_chosen(test)) continue;
    if (best == nullptr || test.gain > best->gain) best = &test;
    if (is_left_out(setting, test) && (own == nullptr || test.gain > own->gain)) own = &test;
  }
  return own != nullptr && comes_before(setting, *own, *best) ? own : best;
}

const FamilyTest* first_to_add(const SearchSetting& setting, const FamilyTest& best, const FamilyTest* own,
                               const std::function<bool(const FamilyTest&)>& is_beaten_by_a_scan) {
  if (own == nullptr) return is_beaten_by_a_scan(best) ? nullptr : &best;
  return comes_before(setting, best, *own) && !is_beaten_by_a_scan(best) ? &best : own;
}

int effects_beyond_errors(const ModelState& state) {
  return static_cast<int>(std::ranges::count_if(
      state.added(), [&](const AddedEffect& each) { return !is_left_out(state.setting(), each.test); }));
}

bool any_order_differs(const ModelState& state, const std::vector<AddedEffect>& compared) {
  for (std::size_t i = 0; i < compared.size(); ++i) {
    if (!state.family_of(compared[i]).orders.empty() && compared[i].test.shape != state.added()[i].test.shape)
      return true;
  }
  return false;
}

bool is_held_in_few_terms(const ModelState& state, const Variable& variable) {
  return std::ranges::any_of(state.added(), [&](const AddedEffect& each) {
    const Family& family = state.family_of(each);
    return !family.orders.empty() && family.name().driver.is(variable);
  });
}

bool any_function_came_back(const ModelState& state) {
  return std::ranges::any_of(state.added(),
                             [&](const AddedEffect& each) { return !state.family_of(each).orders.empty(); });
}

}  // namespace volcal
