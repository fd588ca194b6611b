#pragma once
/// Compares every added effect with all others, the rest being in the model.
///
/// In: how far a search has come. Out: the same, each effect with the rivals that the readings do not tell
/// from it; an effect may be exchanged for a better one, or leave where it is not significant beside the
/// others. Margins: thresholds.h.

#include <functional>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/search/reached.h"

namespace volcal {

class Rivals {
 public:
  /// `options` outlive the object.
  Rivals(Reached from, const SearchOptions& options) : reached_(std::move(from)), options_(options) {}
  /// Until every added effect stands against its rivals. Once.
  Reached settle(const std::function<Reached(Reached)>& after_a_change);

 private:
  bool compare(bool may_change);
  bool near(const FamilyTest& own, const FamilyTest& other) const;
  const FamilyTest* leading(const std::vector<FamilyTest>& tests, const FamilyTest& own,
                            OpenErrors& open) const;

  Reached reached_;
  const SearchOptions& options_;
};

}  // namespace volcal
