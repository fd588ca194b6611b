#pragma once
/// The search for missing effects: proposes what to add to a model, one effect after another.
///
/// In: a linear model about a fit, the observations that are held out. Out: the model reached with what was
/// added and each effect's rivals, and what was rejected and why. SI; log10 p.
///
///   1. climb: the leading effect of the catalogue is added while it exceeds the noise and no scan does
///      better; where a scan does, up to three names together; where nothing exceeds, what the noise may have
///      absorbed (joint_noise.h). An error of the machine that the model holds at zero comes before effects
///      that are no better, whatever the scans do (errors_first.h), and while some are missing an effect is
///      added only where it stands out beside all of them (open_errors.h); shapes are settled in the end,
///   2. every added effect is compared with all others, the rest being in the model, and may be exchanged or
///      leave,
///   3. what is no name is rejected (rejection.h), or a rival that stands takes its place,
///   4. where a curve of one name's drivers explains as much as that name and another together, the curve
///      takes their place (one_cause.h),
///   5. while a scan exceeds, a surface or curve is drawn for it (surface_search.h), and the climb goes on
///      with it in the model; a surface of more variables may take its place and that of a name
///      (one_cause.h); in the end, where other surfaces or names came in, names are tried in its place.
///
/// A search for one step climbs as well, so that what it names stands beside all the rest, and then keeps the
/// first. Margins: thresholds.h. Valid as long as effects act linearly about the fit. Results do not depend
/// on threads.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/criticism/search/one_cause.h"
#include "volcal/identify/criticism/search/open_errors.h"
#include "volcal/identify/criticism/search/rejection.h"
#include "volcal/identify/criticism/search/surface_search.h"

namespace volcal {

struct SearchOptions {
  int threads = 1;    ///< at least 1
  int most = 8;       ///< effects added, errors that the model holds at zero not counted
  bool climb = true;  ///< false: in the end one effect is kept
  std::vector<std::string> leave_out;
  std::vector<EffectSpec> own;  ///< effects that the user thinks of
  SearchRules rules;            ///< a study leaves some out
  std::function<void(const std::string& stage, double done)> progress;
};

/// Something without a name explains the residuals of a tested state better than an effect of the catalogue.
bool any_scan_does_better(const ModelState& state, const FamilyTest& name);

class Search {
 public:
  /// `heldout`: observations that judge and never choose.
  Search(LinearModel model, std::vector<bool> heldout, SearchOptions options);
  /// From a model whose noise is known, without effects that were added; its held-out observations judge.
  Search(const ModelState& given, SearchOptions options);

  void run();

  /// The model without any effect, and the one reached; tested. After run().
  const ModelState& given() const { return *given_; }
  const ModelState& reached() const { return *state_; }
  /// Effects found after the one that was kept.
  bool more_is_known() const { return more_is_known_; }
  /// Families that exceed the noise and are no names.
  const Reasons& rejected() const { return rejected_; }

 private:
  const SearchRules& rules() const { return setting_->rules; }
  void report(const std::string& stage, double done) const;
  void start();
  void explain();
  bool may_draw() const;
  bool draw_one_cause();
  bool draw_surface();
  bool widen_surface();
  std::vector<FamilyTest> kept_beside(const OneCause& cause) const;
  std::vector<SurfaceTest> surfaces_but(std::size_t place) const;
  void draw(const SurfaceTest& surface, const std::vector<FamilyTest>& kept);
  void replace_surfaces();
  void begin_anew();
  void recall_rejected();
  void rebuild(const std::vector<SurfaceTest>& surfaces, const std::vector<FamilyTest>& effects);
  void add(const FamilyTest& effect) { state_ = state_->with(effect); }
  void test();
  void restart_with(const std::vector<FamilyTest>& effects);
  void climb();
  bool may_be_added(const FamilyTest& test) const;
  const FamilyTest* leading_exceeding(const std::function<bool(const FamilyTest&)>& among) const;
  const FamilyTest* leading_beside_open_errors(const FamilyTest* own);
  const FamilyTest* best_by_variables_of_scan();
  bool something_exceeds();
  bool add_leading();
  bool add_several();
  bool add_absorbed();
  bool explain_together(std::size_t first) const;
  void settle(const std::function<void()>& after_a_change);
  bool compare_with_rivals(bool may_change);
  bool near(const FamilyTest& own, const FamilyTest& other) const;
  const FamilyTest* leading(const std::vector<FamilyTest>& tests, const FamilyTest& own,
                            OpenErrors& open) const;
  void reject();
  void recheck(const std::set<std::size_t>& stood);
  void keep(const std::vector<FamilyTest>& effects);
  void settle_shapes();
  void keep_one_step();

  SearchOptions options_;
  LinearModel model_;
  std::shared_ptr<const SearchSetting> setting_;
  std::optional<ModelState> given_;
  std::optional<ModelState> base_;  ///< the given model with the surfaces that were drawn
  std::optional<ModelState> state_;
  std::optional<OpenErrors> open_;  ///< of `state_`, once it is tested
  Reasons rejected_;
  Reasons rejected_before_;                         ///< before the last surface was drawn
  std::set<std::size_t> dropped_;                   ///< not significant beside the others
  std::set<std::set<std::size_t>> tried_together_;  ///< added when several more were tried in vain
  std::size_t names_before_surfaces_ = 0;
  std::set<EffectName> in_place_of_names_;  ///< surfaces that explain more than names did
  bool more_is_known_ = false;
};

}  // namespace volcal
