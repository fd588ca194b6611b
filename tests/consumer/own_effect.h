#pragma once
/// An effect of the consumer's own: play of a drive, which the library does not know by this name.

#include <memory>

#include "volcal/model/effects/effect.h"

std::unique_ptr<const volcal::EffectKind> play_effect();
