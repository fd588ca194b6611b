#pragma once
/// How the amplitude of a reversal is called wherever parameters have names: "reversal EXX".

#include <string>

#include "volcal/model/description/symbols.h"

namespace volcal {

inline std::string reversal_label(ErrorSymbol symbol) { return "reversal " + symbol.name(); }

}  // namespace volcal
