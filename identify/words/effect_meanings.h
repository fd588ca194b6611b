#pragma once
/// Effects in plain words: what a machine that has one does, and what usually is behind it.

#include <string_view>

namespace volcal {

struct EffectMeaning {
  std::string_view kind;
  std::string_view plain;         ///< one sentence for who knows machines and no models
  std::string_view usual_causes;  ///< "backlash of the screw; loose couplings": to follow "usual causes:"
};

/// Null for a kind that is not the library's own, or no effect at all.
const EffectMeaning* find_meaning(std::string_view kind);

}  // namespace volcal
