#pragma once
/// Plans against the textbook's layout, counted: for three structures of sim::reference_machines() both are
/// planned with the same budget, simulated on the same random machines, fitted, and judged by what was
/// predicted, by the fit, by Monte Carlo and by the truth.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace volcal::studies {

struct PlanningStudyOptions {
  int campaigns = 3;  ///< of each layout
  int readings = 960;
  std::uint64_t draws = 2000;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0 = all; results do not depend on it
  std::function<void(const std::string& stage, double done)> progress;
};

/// Root mean squares over the campaigns; m, of the error vector over volume and tools.
struct LayoutFigures {
  std::string name;  ///< "plan", "textbook"
  double predicted_u = 0.0;
  double fitted_u = 0.0;      ///< by linear propagation in the fits
  double montecarlo_u = 0.0;  ///< of the draws
  double true_error = 0.0;    ///< at fresh points after rigid alignment
  int invisible = 0;          ///< fits with an error that is not visible
};

struct PlannedMachine {
  std::string structure;
  LayoutFigures plan;
  LayoutFigures textbook;
};

std::vector<PlannedMachine> planning_study(const PlanningStudyOptions& options);

}  // namespace volcal::studies
