#include "volcal/identify/words/noise_words.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

TEST(EdgeNoise, IsInTheUnitThatTheInstrumentReads) {
  const NoiseRow drift{0, "wander", "m or rad", 0.5e-6, 0.25e-6, 1e-6, 40.0, ""};
  const EdgeNoise edge = edge_noise(drift, "laser-tracer");
  EXPECT_NEAR(edge.value, 0.5, 1e-12);
  EXPECT_NEAR(edge.low, 0.25, 1e-12);
  EXPECT_NEAR(edge.high, 1.0, 1e-12);
  EXPECT_EQ(edge.meaning, "correlated drift");
  EXPECT_EQ(edge.unit, "um");
  EXPECT_EQ(edge_noise(drift, "angle").unit, "urad");
  EXPECT_EQ(edge_noise(drift, "laser-tracker").unit, "um");
  EXPECT_EQ(edge_noise(drift, "laser-tracker angles").unit, "urad");
  EXPECT_EQ(edge_noise(drift, "an instrument of another version").unit, "um or urad");
}

TEST(EdgeNoise, TermsWithUnitsOfTheirOwn) {
  const EdgeNoise white = edge_noise({0, "white", "1", 1.25, 1.0, 1.5, 0.0, ""}, "laser-tracker");
  EXPECT_EQ(white.value, 1.25);
  EXPECT_EQ(white.unit, "");
  const EdgeNoise tau = edge_noise({0, "tau", "s", 580.0, 300.0, 900.0, 40.0, ""}, "laser-tracer");
  EXPECT_EQ(tau.value, 580.0);
  EXPECT_EQ(tau.unit, "s");
  EXPECT_EQ(tau.meaning, "correlation time of the drift");
  const EdgeNoise per_metre = edge_noise({0, "per_metre", "m/m", 0.3e-6, 0.2e-6, 0.4e-6, 9.0, ""}, "angle");
  EXPECT_NEAR(per_metre.value, 0.3, 1e-12);
  EXPECT_EQ(per_metre.unit, "um/m");
}

}  // namespace
}  // namespace volcal
