#pragma once
/// What trying an effect has shown, for the terminal and as JSON; edge units.

#include <string>

#include "volcal/identify/session/tried_effect.h"

namespace volcal {

/// Three lines: its size, what it does to readings that no fit has seen, what remains. `effect`: as the user
/// wrote it.
std::string tried_text(const std::string& effect, const TriedEffect& tried);
/// The same as one JSON document, ending in a newline.
std::string tried_json(const std::string& effect, const TriedEffect& tried);

}  // namespace volcal
