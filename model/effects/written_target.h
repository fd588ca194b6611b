#pragma once
/// What an effect acts on where its user writes that: the key `target` of effects that are no names of the
/// catalogue (custom, empirical).

#include <string>

#include "volcal/model/effects/effect_keys.h"

namespace volcal {

struct WrittenTarget {
  std::string text;  ///< as it was written
  TargetKind kind = TargetKind::Motion;
  ErrorSymbol symbol;
  int component = 0;
  std::string owner;   ///< tool, station or setup; empty = all
  std::string column;  ///< of Reading
  bool angle = false;  ///< amplitudes are in urad, else in um

  TargetName name() const;
  EffectTarget target() const { return {.kind = kind, .symbol = symbol, .component = component}; }
  /// Key of an amplitude: "amplitude_um" for the stem "amplitude".
  std::string amplitude_key(const std::string& stem) const { return stem + (angle ? "_urad" : "_um"); }
  bool acts_on(const Campaign& campaign, const Setup& setup) const;
  /// Throws InputError when the campaign lacks the axis, tool, station, setup or column. `what`: the effect.
  void check(const Campaign& campaign, const std::string& what, const SourcePlace& place) const;
};

/// Throws InputError for a text that is no target.
WrittenTarget written_target(const EffectTable& table);
KeySchema written_target_key();

}  // namespace volcal
