#pragma once
/// Adds effects of the catalogue to a model, one after another, while they exceed the noise and no scan does
/// better.
///
/// In: how far a search has come. Out: the same with more effects, tested. Where a scan does better than the
/// leading effect, up to three names are added together; where nothing exceeds, what the noise may have
/// absorbed (joint_noise.h). An error of the machine that the model holds at zero comes before effects that
/// are no better, whatever the scans do (errors_first.h), and while some are missing an effect is added only
/// where it stands out beside all of them (open_errors.h). Log10 p; margins: thresholds.h.

#include <utility>

#include "volcal/identify/criticism/search/reached.h"

namespace volcal {

/// Something without a name explains the residuals of a tested state better than an effect of the catalogue.
bool any_scan_does_better(const ModelState& state, const FamilyTest& name);

class Climb {
 public:
  /// `options` outlive the object.
  Climb(Reached from, const SearchOptions& options) : reached_(std::move(from)), options_(options) {}
  /// Once.
  Reached run();

 private:
  bool add_leading();
  bool add_several();
  bool add_absorbed();
  const FamilyTest* best_by_variables_of_scan() const;
  bool explain_together(std::size_t first) const;

  Reached reached_;
  const SearchOptions& options_;
};

}  // namespace volcal
