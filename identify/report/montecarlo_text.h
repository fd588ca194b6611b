#pragma once
/// A Monte Carlo study for the terminal.

#include <string>

#include "volcal/identify/montecarlo/montecarlo.h"

namespace volcal {

/// Paths against refits; per error function, squareness, block of parameters and tool the standard
/// uncertainty by linear propagation and by Monte Carlo, bias and verdict; the verdict of clause 8.
std::string montecarlo_text(const MonteCarloResult& result);

}  // namespace volcal
