/// How the result was computed, and what the symbols mean.

#include "volcal/identify/report/numbers.h"

namespace volcal::report {
namespace {

Json glossary() {
  return Json::array({
      {"EXY",
       "error motion of an axis (ISO 230-1): direction first, moving axis second. X, Y, Z: displacement "
       "along; A, B, C: rotation about x, y, z"},
      {"EC0Y", "squareness or location error: component first, axis last"},
      {"sign",
       "error = actual minus nominal, tool relative to workpiece; a compensation is its negative "
       "(ISO/TR 16907)"},
      {"u, U95", "standard uncertainty; expanded uncertainty of a 95 % interval"},
      {"σ", "standard deviation of one reading, k = 1"},
      {"σ₀", "square root of χ² per degree of freedom with the stated σ"},
      {"r", "redundancy number of a reading, 0 to 1: how much of an error in it shows in its own residual"},
      {"w",
       "normalised residual, residual / (σ √r) (Baarda); standard normal when model and noise are right"},
      {"visible fraction", "share of an error's signal in the readings that no other parameter can imitate"},
  });
}

}  // namespace

Json computation_page(const PageInput& input) {
  const FitResult& result = input.result;
  Json timings = Json::array();
  for (const Timing& timing : result.timings) {
    timings.push_back({{"stage", timing.stage}, {"seconds", rounded(timing.seconds, 3)}});
  }
  return {{"iterations", result.iterations},
          {"initial_cost", rounded(result.initial_cost, 6)},
          {"final_cost", rounded(result.final_cost, 6)},
          {"parameters", result.layout.size},
          {"function_parameters", result.layout.function_size},
          {"observations", result.residuals.size()},
          {"timings", std::move(timings)},
          {"glossary", glossary()}};
}

}  // namespace volcal::report
