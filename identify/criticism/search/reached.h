#pragma once
/// How far a search has come: the model states between which it moves and what it has learned of names on the
/// way. A value: what proposes a further step takes one and returns another.

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/criticism/search/open_errors.h"
#include "volcal/identify/criticism/search/rejection.h"

namespace volcal {

struct SearchOptions {
  int threads = 1;    ///< at least 1
  int most = 8;       ///< effects added, errors that the model holds at zero not counted
  bool climb = true;  ///< false: in the end one effect is kept
  std::vector<std::string> leave_out;
  std::vector<EffectSpec> own;  ///< effects that the user thinks of
  SearchRules rules;            ///< a study leaves some out
  std::function<void(const std::string& stage, double done)> progress;

  void report(const std::string& stage, double done) const;
};

struct Reached {
  ModelState given;  ///< without any effect; tested once the search has tested a state
  ModelState base;   ///< the given model with the surfaces that were drawn
  ModelState state;
  std::shared_ptr<OpenErrors> open = nullptr;           ///< of `state`, once it is tested
  Reasons rejected = {};                                ///< families that are no names
  Reasons rejected_before = {};                         ///< before the last surface was drawn
  std::set<std::size_t> dropped = {};                   ///< not significant beside the others
  std::set<std::set<std::size_t>> tried_together = {};  ///< added when several more were tried in vain
  std::size_t names_before_surfaces = 0;
  std::set<EffectName> in_place_of_names = {};  ///< surfaces that explain more than names did

  explicit Reached(const ModelState& model) : given(model), base(model), state(model) {}

  const SearchSetting& setting() const { return state.setting(); }
  const SearchRules& rules() const { return setting().rules; }
  void test();
  void add(const FamilyTest& effect);
  /// Another base, without any effect.
  void begin_from(ModelState other);
  /// The base, and these effects one after another; not tested. Those that the state begins with stay as they
  /// are.
  void restart_with(const std::vector<FamilyTest>& effects);
  /// What was no name beside another model may be one now.
  void begin_anew();

  bool may_be_added(const FamilyTest& test) const;
  /// The best of those that are not in the model; null: none.
  const FamilyTest* leading_exceeding(const std::function<bool(const FamilyTest&)>& among) const;
  /// What leads, an effect beyond the errors of the machine only where it comes before `own`, the best of
  /// these, and exceeds beside those that the model holds at zero. Of a tested state.
  const FamilyTest* leading_beside_open_errors(const FamilyTest* own) const;
  bool something_exceeds() const;
};

std::vector<FamilyTest> added_tests(const std::vector<AddedEffect>& added);

}  // namespace volcal
