#include "volcal/identify/criticism/search/reached.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/scans/amplitude_constancy.h"
#include "volcal/identify/criticism/search/errors_first.h"

namespace volcal {
namespace {

/// One cause on several axes is a name where its amplitude is the same on all of them.
bool acts_alike_in_its_places(const ModelState& state, const FamilyTest& test) {
  const Family& family = state.setting().families[test.family];
  return !acts_in_several_places(family) ||
         log10_p_of_one_amplitude(state.model(), family, test.shape, state.projector()) >
             std::log10(kThresholds.constancy_risk);
}

bool have_same_columns(const FamilyTest& one, const FamilyTest& other) {
  return one.family == other.family && one.shape == other.shape;
}

}  // namespace

std::vector<FamilyTest> added_tests(const std::vector<AddedEffect>& added) {
  std::vector<FamilyTest> tests;
  std::ranges::transform(added, std::back_inserter(tests), &AddedEffect::test);
  return tests;
}

void SearchOptions::report(const std::string& stage, double done) const {
  if (progress) progress(stage, done);
}

void Reached::test() {
  state = state.tested();
  open = std::make_shared<OpenErrors>(state);
}

void Reached::add(const FamilyTest& effect) {
  state = state.with(effect);
  open.reset();
}

void Reached::begin_from(ModelState other) {
  base = std::move(other);
  state = base;
  open.reset();
}

void Reached::restart_with(const std::vector<FamilyTest>& effects) {
  const std::vector<AddedEffect>& added = state.added();
  const auto differing = std::ranges::mismatch(effects, added, have_same_columns, {}, &AddedEffect::test).in1;
  const auto kept = static_cast<std::size_t>(differing - effects.begin());
  if (kept == effects.size() && kept == added.size()) return;
  if (kept == 0) {
    state = base;
  } else if (kept < added.size()) {
    state = state.with_first(kept).value_or(base);
  }
  open.reset();
  for (std::size_t i = state.added().size(); i < effects.size(); ++i) add(effects[i]);
}

void Reached::begin_anew() {
  rejected_before.merge(rejected);
  rejected.clear();
  dropped.clear();
  tried_together.clear();
}

bool Reached::may_be_added(const FamilyTest& test) const {
  return test.score.dof > 0 && !state.has(test.family) && !rejected.contains(test.family) &&
         !dropped.contains(test.family) &&
         !rules().decide(SearchRule::OneAmplitude, [&] { return !acts_alike_in_its_places(state, test); });
}

const FamilyTest* Reached::leading_exceeding(const std::function<bool(const FamilyTest&)>& among) const {
  const ModelTests& tests = state.tests();
  const auto found = std::ranges::find_if(tests.exceeding, [&](std::size_t i) {
    return among(tests.families[i]) && may_be_added(tests.families[i]);
  });
  return found == tests.exceeding.end() ? nullptr : &tests.families[*found];
}

const FamilyTest* Reached::leading_beside_open_errors(const FamilyTest* own) const {
  return leading_exceeding([&](const FamilyTest& test) {
    return is_left_out(setting(), test) ||
           ((own == nullptr || comes_before(setting(), test, *own)) && open->admits(test));
  });
}

bool Reached::something_exceeds() const {
  return leading_beside_open_errors(nullptr) != nullptr || state.tests().any_scan_exceeds();
}

}  // namespace volcal
