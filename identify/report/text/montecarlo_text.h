#pragma once
/// A Monte Carlo study for the terminal.

#include <string>

#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/result/result.h"

namespace volcal {

/// Paths against refits; per error function, squareness, block of parameters and tool the standard
/// uncertainty by linear propagation and by Monte Carlo, bias and verdict; the verdict of clause 8.
std::string montecarlo_text(const MonteCarloResult& result);

/// Of chord steps whose result is not held to refits, or differs from them by more than is allowed: what they
/// hold fixed; empty for others.
std::string held_by_steps_text(const MonteCarloResult& result);

/// Of a fit that does not determine every error, which nothing is drawn from: what is not visible, why, and
/// what to do.
std::string undetermined_text(const FitResult& fit);

}  // namespace volcal
