#include "volcal/identify/criticism/search/rivals.h"

#include <algorithm>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/errors_first.h"

namespace volcal {

Reached Rivals::settle(const std::function<Reached(Reached)>& after_a_change) {
  for (int change = 0; change < kThresholds.most_changes; ++change) {
    if (!compare(true)) return std::move(reached_);
    reached_ = after_a_change(std::move(reached_));
  }
  compare(false);
  return std::move(reached_);
}

/// Each added effect against all others, now that the rest is in the model: true when one was exchanged or
/// left, and the climb goes on from there. Error functions take as many terms as they have beside the others.
bool Rivals::compare(bool may_change) {
  std::vector<AddedEffect> added = reached_.state.added();
  std::vector<FamilyTest> kept = added_tests(added);
  for (std::size_t i = 0; i < added.size(); ++i) {
    options_.report("rivals of " + reached_.setting().families[kept[i].family].label(), 0.9);
    const std::vector<FamilyTest> tests =
        refined_tests(reached_.setting(), reached_.state.model(), *reached_.state.projector_without({i}));
    const FamilyTest& own = tests[kept[i].family];
    OpenErrors open(reached_.state, {i});
    const auto is_weak = [&] {
      return reached_.setting().family_wise_log10_p(own) > log10_family_risk() || !open.admits(own);
    };
    if (may_change && reached_.rules().decide(SearchRule::Departure, is_weak)) {
      reached_.dropped.insert(own.family);
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(i));
      reached_.restart_with(kept);
      return true;
    }
    const FamilyTest* best = leading(tests, own, open);
    const auto is_better = [&] { return best != nullptr && comes_before(reached_.setting(), *best, own); };
    if (may_change && reached_.rules().decide(SearchRule::Exchange, is_better)) {
      kept[i] = *best;
      reached_.restart_with(kept);
      return true;
    }
    added[i].test = own;
    added[i].rivals.clear();
    for (const FamilyTest& test : tests) {
      const bool known = reached_.state.has(test.family) || reached_.rejected.contains(test.family) ||
                         (is_left_out(reached_.setting(), own) && !is_left_out(reached_.setting(), test));
      if (test.score.dof > 0 && !known && near(own, test)) added[i].rivals.push_back(test);
    }
    std::ranges::sort(added[i].rivals, std::greater{}, &FamilyTest::gain);
  }
  if (any_order_differs(reached_.state, added)) {
    reached_.restart_with(added_tests(added));
    reached_.test();
    std::vector<AddedEffect> anew = reached_.state.added();
    for (std::size_t i = 0; i < anew.size(); ++i) {
      added[i].test.shape = anew[i].test.shape;  // that of its columns
      anew[i].test = std::move(added[i].test);
      anew[i].rivals = std::move(added[i].rivals);
    }
    added = std::move(anew);
  }
  reached_.state = reached_.state.with_comparisons(std::move(added));
  return false;
}

/// By LM alone more resolution is no rival: for the price of its columns it follows nearly anything.
bool Rivals::near(const FamilyTest& own, const FamilyTest& other) const {
  if (own.gain - other.gain < kThresholds.indistinguishable_gain) return true;
  return reached_.rules().decide(SearchRule::NearByLm, [&] {
    return !reached_.setting().families[other.family].resolution &&
           own.score.lm - other.score.lm < kThresholds.indistinguishable_lm;
  });
}

/// Of those that are not in the model, but `own`, which is.
const FamilyTest* Rivals::leading(const std::vector<FamilyTest>& tests, const FamilyTest& own,
                                  OpenErrors& open) const {
  return leading_errors_first(reached_.setting(), tests, [&](const FamilyTest& test) {
    if (test.family == own.family) return test.score.dof > 0;
    return reached_.may_be_added(test) && (!comes_before(reached_.setting(), test, own) || open.admits(test));
  });
}

}  // namespace volcal
