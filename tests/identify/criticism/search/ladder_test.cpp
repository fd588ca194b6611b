#include "volcal/identify/criticism/search/ladder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/diagnosis.h"

namespace volcal {
namespace {

LadderStep step(double systematic, double low) {
  LadderStep step;
  step.systematic = systematic;
  step.systematic_low = low;
  return step;
}

TEST(Ladder, AnErrorThatHardlyFallsIsAboveTheNoiseAndNearlyAsLargeAsBefore) {
  const LadderStep before = step(0.50e-6, 0.32e-6);
  const auto not_reduced = [&](const LadderStep& after) {
    return heldout_error_not_reduced(std::vector{before, step(0.49e-6, 0.30e-6), after});
  };
  EXPECT_TRUE(not_reduced(step(0.47e-6, 0.26e-6)));
  EXPECT_FALSE(not_reduced(step(0.47e-6, 0.0))) << "may be noise";
  EXPECT_FALSE(not_reduced(step(0.35e-6, 0.10e-6))) << "has fallen";
}

/// No reading is held out: nothing is known of what held-out readings are left with.
TEST(Ladder, WithoutHeldOutReadingsNothingIsSaidOfThem) {
  const testing_support::FittedStudy study(testing_support::hiding({}, {3, 3, 3}));
  DiagnoseOptions options;
  options.heldout_share = 0.0;
  options.figures = options.compare = false;
  const Diagnosis diagnosis = diagnose(study.simulated.campaign, study.result, options);
  ASSERT_FALSE(diagnosis.ladder.empty());
  for (const LadderStep& step : diagnosis.ladder) {
    EXPECT_GT(step.rms_fit, 0.0);
    for (const double value : {step.rms_heldout, step.noise_floor, step.systematic, step.systematic_low,
                               step.systematic_high, step.heldout_loglik_gain})
      EXPECT_TRUE(std::isnan(value)) << value;
  }
}

}  // namespace
}  // namespace volcal
