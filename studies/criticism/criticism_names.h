#pragma once
/// Which answers are right for what sim/ hides: the names of the catalogue, and for what is in no catalogue
/// the variables and directions that it shows in. The only place where the two vocabularies meet.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/effects/effect.h"
#include "volcal/sim/hidden/hidden_effects.h"

namespace volcal::studies {

struct RightAnswer {
  /// The effect of the catalogue, with the true parameters of its shape and no amplitude; none when the
  /// catalogue does not hold it.
  std::optional<EffectSpec> spec;
  std::optional<EffectName> name;
  std::set<std::string> drivers;     ///< variables of the generic scan of which one must be named
  std::set<std::string> companions;  ///< that may be named beside them: arms of rotations
  std::set<std::string> directions;  ///< "X", "Y", "Z", "beam"
};

RightAnswer right_answer(const sim::HiddenEffect& hidden, const Campaign& campaign);

/// "screw-lead EXX period=0.01": kind and keys, SI.
std::string text_of(const sim::HiddenEffect& hidden);

}  // namespace volcal::studies
