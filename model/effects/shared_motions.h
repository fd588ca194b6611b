#pragma once
/// One cause that moves several error motions with one amplitude: keys, checks and places that such effects
/// share (Effect::terms).

#include <string>
#include <vector>

#include "volcal/model/effects/formula_effect.h"

namespace volcal {

/// Linear axes of the key `axes = "X Y Z"`: two or more, none twice.
std::vector<AxisName> shared_axes(const EffectTable& table);
/// Error motions of the key `symbols = "EXX EYY EZZ"`: two or more, none twice, all displacements or all
/// rotations, since one amplitude has one unit.
std::vector<ErrorSymbol> shared_symbols(const EffectTable& table);
KeySchema shared_axes_key(const std::string& help);
KeySchema shared_symbols_key(const std::string& help);

/// "EXX EYY EZZ", of axes their positioning errors.
std::vector<ErrorSymbol> positioning_errors(const std::vector<AxisName>& axes);
std::string names_of_symbols(const std::vector<ErrorSymbol>& symbols);
/// Machine's letters, "X Y Z".
std::string names_of_axes(const std::vector<AxisName>& axes);
std::vector<EffectTarget> targets_of(const std::vector<ErrorSymbol>& symbols);

/// Linear axes whose position changes in the campaign; whose direction of approach does, both being recorded.
/// What such an axis does is no part of what is seen of a cause that it shares with others.
std::vector<AxisName> axes_that_move(const Campaign& campaign);
std::vector<AxisName> axes_that_turn_round(const Campaign& campaign);

}  // namespace volcal
