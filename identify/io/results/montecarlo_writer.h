#pragma once
/// Files of a Monte Carlo study: montecarlo.json (everything, edge units) and montecarlo.csv (one row a
/// quantity).

#include <string>
#include <vector>

#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/result/result.h"

namespace volcal {

inline constexpr const char* kMonteCarloFormat = "volcal-montecarlo-1";

std::string montecarlo_json(const MonteCarloResult& result);

/// Of a fit that does not determine every error: status, no draws, and what is not visible, in words.
std::string undetermined_json(const FitResult& fit, const std::vector<Finding>& notes = {});

/// kind,name,axis,position,position_unit,direction,tool,x_mm,y_mm,z_mm,unit,estimate,u_linear,u,ratio,bias,
/// bias_error,symmetric_low,symmetric_high,shortest_low,shortest_high,linear_low,linear_high,tolerance,
/// difference,validated; estimate and what follows in `unit`. validated: 1, 0, empty = undecided.
std::string montecarlo_csv(const MonteCarloResult& result);

}  // namespace volcal
