#pragma once
/// Tables of an uncertainty budget: the share of every source, and what halving it would bring.

#include <string>

#include "volcal/identify/montecarlo/montecarlo.h"

namespace volcal {

std::string budget_text(const MonteCarloResult& result);

}  // namespace volcal
