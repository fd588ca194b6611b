#pragma once
/// The search for missing effects: proposes what to add to a model, one effect after another.
///
/// In: a linear model about a fit, the observations that are held out. Out: the model reached with what was
/// added and each effect's rivals, and what was rejected and why. SI; log10 p.
///
///   1. climb (climb.h): effects of the catalogue are added while they exceed the noise and no scan does
///      better; shapes are settled in the end,
///   2. every added effect is compared with all others, the rest being in the model, and may be exchanged or
///      leave (rivals.h),
///   3. what is no name is rejected (rejection.h), or a rival that stands takes its place,
///   4. where a curve of one name's drivers explains as much as that name and another together, the curve
///      takes their place (drawing.h),
///   5. while a scan exceeds, a surface or curve is drawn for it, and the climb goes on with it in the model;
///      a surface of more variables may take its place and that of a name; in the end, where other surfaces
///      or names came in, names are tried in its place (drawing.h).
///
/// A search for one step climbs as well, so that what it names stands beside all the rest, and then keeps the
/// first. Margins: thresholds.h. Valid as long as effects act linearly about the fit. Results do not depend
/// on threads.

#include <functional>
#include <optional>
#include <vector>

#include "volcal/identify/criticism/search/reached.h"

namespace volcal {

class Search {
 public:
  /// `heldout`: observations that judge and never choose.
  Search(LinearModel model, std::vector<bool> heldout, SearchOptions options);
  /// From a model whose noise is known, without effects that were added; its held-out observations judge.
  Search(const ModelState& given, SearchOptions options);

  void run();

  /// The model without any effect, and the one reached; tested. After run().
  const ModelState& given() const { return reached_->given; }
  const ModelState& reached() const { return reached_->state; }
  /// Effects found after the one that was kept.
  bool more_is_known() const { return more_is_known_; }
  /// Families that exceed the noise and are no names.
  const Reasons& rejected() const { return reached_->rejected; }

 private:
  void keep_one_step();

  SearchOptions options_;
  std::function<ModelState()> begin_;  ///< the given model
  std::optional<Reached> reached_;     ///< after run()
  bool more_is_known_ = false;
};

}  // namespace volcal
