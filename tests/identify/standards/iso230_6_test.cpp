#include "volcal/identify/standards/iso230_6.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

/// Deviations in um at 0 and 500 mm along the diagonal, + then -.
DiagonalFigures diagonal(const char* name, double plus_0, double plus_500, double minus_500, double minus_0) {
  const std::vector<PositioningReading> readings = {{0.0, plus_0 * 1e-6, +1},
                                                    {0.5, plus_500 * 1e-6, +1},
                                                    {0.5, minus_500 * 1e-6, -1},
                                                    {0.0, minus_0 * 1e-6, -1}};
  return {name, positioning_figures(readings)};
}

/// By hand, um. +X+Y+Z: + 0, 10; - 12, 1: E = 12 - 0 = 12, B = max(|0 - 1|, |10 - 12|) = 2.
/// -X+Y+Z: + 0, -20; - -17, 0: E = 0 - (-20) = 20, B = max(0, |-20 + 17|) = 3.
/// E_d = max(12, 20) = 20; B_d = max(2, 3) = 3.
TEST(Iso230Part6, LargestOfTheDiagonals) {
  const std::vector<DiagonalFigures> diagonals = {diagonal("+X+Y+Z", 0, 10, 12, 1),
                                                  diagonal("-X+Y+Z", 0, -20, -17, 0)};
  EXPECT_NEAR(*diagonals[0].positioning.systematic, 12e-6, 1e-15);
  EXPECT_NEAR(*diagonals[0].positioning.reversal, 2e-6, 1e-15);
  const DiagonalSummary summary = diagonal_summary(diagonals);
  EXPECT_EQ(summary.diagonals, 2);
  EXPECT_NEAR(*summary.systematic, 20e-6, 1e-15);
  EXPECT_NEAR(*summary.reversal, 3e-6, 1e-15);
}

TEST(Iso230Part6, ADiagonalInOneDirectionLeavesTheSummaryUndefined) {
  const std::vector<PositioningReading> one_way = {{0.0, 0.0, +1}, {0.5, 1e-6, +1}};
  const std::vector<DiagonalFigures> diagonals = {diagonal("+X+Y", 0, 10, 12, 1),
                                                  {"+X-Y", positioning_figures(one_way)}};
  const DiagonalSummary summary = diagonal_summary(diagonals);
  EXPECT_FALSE(summary.systematic.has_value());
  EXPECT_FALSE(summary.reversal.has_value());
  EXPECT_EQ(summary.diagonals, 2);
}

TEST(Iso230Part6, NoDiagonalsNoSummary) { EXPECT_FALSE(diagonal_summary({}).systematic.has_value()); }

}  // namespace
}  // namespace volcal
