#include "volcal/identify/criticism/search/ladder.h"

#include <gtest/gtest.h>

#include <vector>

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

}  // namespace
}  // namespace volcal
