// Lines that a fit has not seen.

#include "volcal/identify/criticism/heldout_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

Setup setup_of(int lines, int per_line) {
  Setup setup;
  for (int line = 0; line < lines; ++line) {
    for (int k = 0; k < per_line; ++k) {
      setup.readings.line.push_back(10 + line);
      setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.source_line.size()));
    }
  }
  setup.readings.value = {std::vector<double>(setup.readings.source_line.size())};
  return setup;
}

/// Ten lines of four: the fifth and the tenth of the first setup, shifted by one in the second. Four readings
/// of one line are too few to hold any out.
TEST(HeldOutLines, AreEveryFifthAndNeverAWholeSetup) {
  Campaign campaign;
  campaign.setups = {setup_of(10, 4), setup_of(10, 4), setup_of(1, 4), setup_of(1, 4), setup_of(1, 4)};
  const auto rows = judging_rows(campaign);
  for (std::size_t row = 0; row < 40; ++row) {
    EXPECT_EQ(rows[0][row], row / 4 == 4 || row / 4 == 9) << row;
    EXPECT_EQ(rows[1][row], row / 4 == 3 || row / 4 == 8) << row;
  }
  for (std::size_t setup = 2; setup < 5; ++setup) EXPECT_EQ(std::ranges::count(rows[setup], true), 0);
  const Campaign rest = without_rows(campaign, rows);
  EXPECT_EQ(rest.setups[0].readings.size(), 40U) << "positions stay";
  EXPECT_EQ(rest.setups[0].rows_left_out(), rows[0]);
  EXPECT_TRUE(rest.setups[4].left_out.empty());
}

TEST(HeldOutLines, DoNotRepeatReadingsThatAreLeftOut) {
  Campaign campaign;
  campaign.setups = {setup_of(10, 4)};
  campaign.setups[0].left_out = {{3, 0, "a cable"}, {17, 0, "a cable"}};
  const Campaign rest = without_rows(campaign, judging_rows(campaign));
  EXPECT_EQ(rest.setups[0].left_out.size(), 9U);
  EXPECT_TRUE(rest.setups[0].rows_left_out()[3]);
}

/// A line of X there and back five times, without a stated direction: with the first pass held out, what is
/// left begins at the far end, and the beam must not turn round.
TEST(HeldOutLines, LeaveTheBeamOfALineWhereItWas) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 7;
  sim::AxisLines lines;
  lines.axes = {AxisName::X};
  study.measurements.emplace_back().settings = lines;
  study.validation.points = 10;
  Campaign campaign = sim::simulate(study).campaign;
  ASSERT_EQ(campaign.setups.size(), 1U);
  campaign.setups[0].options = {};
  const std::vector<std::int32_t>& line = campaign.setups[0].readings.line;
  std::vector<std::vector<bool>> first_pass(1);
  for (const std::int32_t pass : line) first_pass[0].push_back(pass == line.front());
  const auto records = heldout_residuals(campaign, ModelSpec{}, first_pass, {});
  EXPECT_EQ(records.size(), 11U);
  for (const ResidualRecord& record : records) EXPECT_LT(std::abs(record.residual()), 5e-6) << record.row;
}

/// The truth's noise is 1 um here or there: the fit predicts unseen lines as well as that, the nominal
/// machine does not, and what the fit has not seen it predicts worse than what it has.
TEST(HeldOutLines, JudgeAFitByWhatItHasNotSeen) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 5;
  sim::Tracking tracking;
  tracking.grid = {6, 5, 5};
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  const Campaign campaign = sim::simulate(study).campaign;
  const auto rows = judging_rows(campaign);
  const auto rms = [](const std::vector<ResidualRecord>& records) {
    double sum = 0.0;
    for (const ResidualRecord& record : records) sum += record.residual() * record.residual();
    return std::sqrt(sum / static_cast<double>(records.size()));
  };
  std::size_t marked = 0;
  for (const auto& setup : rows) marked += static_cast<std::size_t>(std::ranges::count(setup, true));
  const auto fitted = heldout_residuals(campaign, ModelSpec{}, rows, {});
  EXPECT_EQ(fitted.size(), marked);
  const auto nominal =
      heldout_residuals(campaign, nominal_model(), rows, {.threads = 1, .fit = false, .progress = {}});
  EXPECT_LT(rms(fitted), 0.5 * rms(nominal));
  const FitResult whole = fit(campaign, ModelSpec{});
  const auto again = heldout_residuals(campaign, refittable_model(whole), rows, {});
  EXPECT_NEAR(rms(again), rms(fitted), 1e-3 * rms(fitted)) << "a result is fitted anew as its model file was";
  std::vector<ResidualRecord> seen;
  for (const ResidualRecord& record : whole.residuals) {
    if (rows[record.setup][record.row]) seen.push_back(record);
  }
  EXPECT_GT(rms(fitted), rms(seen));
}

}  // namespace
}  // namespace volcal
