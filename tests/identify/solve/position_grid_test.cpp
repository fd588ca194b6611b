// Campaigns whose readings stand at a few positions of each axis again and again, against simulated truth.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

sim::SimulatedCampaign measured_on(const Eigen::Vector3i& grid) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 29;
  sim::Tracking tracking;
  tracking.grid = grid;
  tracking.jitter = 0.0;
  study.measurements.emplace_back().settings = tracking;
  return sim::simulate(study);
}

bool is_visible_in(const FitResult& result, const std::string& error) {
  const auto found =
      std::ranges::find(result.rank.errors, MachineError::parse(error), &Observability::symbol);
  return found != result.rank.errors.end() && found->visible;
}

/// Nobody knows what a function does between two positions; the others show how rough it can be.
TEST(PositionGrid, ErrorsAreVisibleThatItsPositionsShow) {
  const auto simulated = measured_on({9, 7, 6});
  const FitResult result = fit(simulated.campaign, ModelSpec{});
  EXPECT_EQ(result.status, FitStatus::Ok);
  EXPECT_TRUE(result.rank.invisible.empty());
  const sim::TruthInDatum truth(simulated.truth);
  const auto squareness = truth.datum().squareness();
  int held = 0, rows = 0;
  for (const ErrorTableRow& row : error_table(result)) {
    if (row.u == 0.0) continue;
    if (const auto location = row.symbol.location()) {
      const auto place = std::ranges::find(squareness, *location) - squareness.begin();
      EXPECT_LT(row.u, 2e-6) << row.symbol.name();
      EXPECT_NEAR(row.value, truth.squareness()[static_cast<std::size_t>(place)], 3.0 * row.u)
          << row.symbol.name();
      continue;
    }
    held += std::abs(row.value - truth.value(*row.symbol.motion(), row.position)) < 1.96 * row.u ? 1 : 0;
    ++rows;
  }
  EXPECT_GT(held, 0.88 * rows) << rows;
}

/// Two positions tell a squareness from no straightness.
TEST(PositionGrid, ASquarenessIsNotVisibleWhereTwoPositionsAreAll) {
  const FitResult result = fit(measured_on({9, 7, 2}).campaign, ModelSpec{});
  EXPECT_EQ(result.status, FitStatus::RankDeficient);
  for (const char* hidden : {"EXZ", "EYZ", "EA0Z", "EB0Z"})
    EXPECT_FALSE(is_visible_in(result, hidden)) << hidden;
  for (const char* seen : {"EXX", "EYX", "EYY", "EXY", "EC0Y"})
    EXPECT_TRUE(is_visible_in(result, seen)) << seen;
}

}  // namespace
}  // namespace volcal
