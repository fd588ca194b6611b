#pragma once
/// Why an effect that was added to a model is no name for what the readings show.
///
/// In: a tested model state. Out: findings "diagnosis.rejected...", and what may stand in the place of a
/// rejected effect. An effect is rejected when what it leaves exceeds the noise more than it did, its own
/// driver still moves what it leaves, its amplitude varies
/// (amplitude_constancy.h: Nyblom 1989, JASA 84, 223), or its shape lies beyond the end of its scan. Risks
/// and margins: thresholds.h; probabilities in log10. Valid where all that the readings need is in the model
/// or among its scans.

#include <map>
#include <optional>
#include <vector>

#include "volcal/identify/criticism/scans/amplitude_constancy.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/model/description/finding.h"

namespace volcal {

/// Reason by family.
using Reasons = std::map<std::size_t, Finding>;

class Rejection {
 public:
  /// `state` is tested, and outlives the object.
  explicit Rejection(const ModelState& state) : state_(state) {}

  /// Of an added effect, by its place; nothing: the name stands.
  std::optional<Finding> rejection_reason(std::size_t added) const;
  /// Of all added effects that are no names.
  Reasons rejection_reasons() const;
  /// What the scans still see is less probable than the effect.
  bool leaves_more(const AddedEffect& effect) const;
  /// The first rival whose amplitude is plainly constant in the place of the added effect; null: none.
  const FamilyTest* standing_rival(std::size_t added, const Reasons& rejected) const;

 private:
  const SearchRules& rules() const { return state_.setting().rules; }
  bool still_moves(const std::vector<Variable>& drivers) const;
  bool lies_beyond_its_scan(std::size_t added) const;
  ConstancyTest constancy(std::size_t added) const;
  double log10_constancy_of_rival(std::size_t added, const FamilyTest& rival) const;

  const ModelState& state_;
};

}  // namespace volcal
