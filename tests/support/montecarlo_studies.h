#pragma once
/// Fitted campaigns whose draws tests make, and what they look for in a study.

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::testing_support {

inline MonteCarloResult studied(const Campaign& campaign, const FitResult& result,
                                const MonteCarloOptions& options) {
  MonteCarloStudy study(campaign, result, options);
  while (!study.done()) study.run_block();
  return study.result();
}

inline const QuantityResult& value_of(const MonteCarloResult& result, const std::string& words) {
  for (const QuantityResult& value : result.quantities) {
    if (value.quantity.words() == words) return value;
  }
  throw std::out_of_range(words);
}

/// Readings of a tracer on a grid; its fit with smoothed functions.
class TracerStudy : public ::testing::Test {
 protected:
  static sim::SimulatedCampaign simulated(double drift) {
    sim::Study study;
    study.machine = sim::reference_machines()[1];
    study.seed = 21;
    sim::Tracking tracking;
    tracking.grid = {5, 4, 4};
    tracking.noise.drift = drift;
    tracking.noise.drift_time = 200.0;
    study.measurements.emplace_back().settings = tracking;
    study.validation.points = 5;
    return sim::simulate(study);
  }

  static FitOptions white_noise() {
    FitOptions options;
    options.noise = NoisePolicy::White;
    return options;
  }
  static const Campaign& campaign() {
    static const sim::SimulatedCampaign kSimulated = simulated(0.0);
    return kSimulated.campaign;
  }
  static const FitResult& result() {
    static const FitResult kResult = fit(campaign(), {}, white_noise());
    return kResult;
  }
};

}  // namespace volcal::testing_support
