// Lines that a fit has not seen.

#include "volcal/identify/criticism/heldout_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

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

/// Readings of one setup, in units of their sigma.
std::vector<ResidualRecord> records_of(const std::vector<double>& residuals) {
  std::vector<ResidualRecord> records;
  for (const double residual : residuals) {
    ResidualRecord& record = records.emplace_back();
    record.row = records.size() - 1;
    record.sigma = 2e-6;
    record.reading = residual * record.sigma;
  }
  return records;
}

/// Ten lines of two. The models differ by 2 sigma in the first four readings. The residuals that the nearer
/// one leaves are +-1 everywhere, so that s^2 = 1; without it they are 2 more: 3^2 + 1 + 3^2 + 1 against 4.
TEST(HeldOutGain, IsHeldAgainstWhatNoiseMakesOfIt) {
  Campaign campaign;
  campaign.setups = {setup_of(10, 2)};
  std::vector<double> with(20), without(20);
  for (std::size_t i = 0; i < with.size(); ++i) {
    with[i] = i % 2 == 0 ? 1.0 : -1.0;
    without[i] = with[i] + (i < 4 ? 2.0 : 0.0);
  }
  const HeldOutGain gain = heldout_gain(campaign, records_of(without), records_of(with));
  EXPECT_NEAR(gain.chi2, 16.0, 1e-9);
  EXPECT_NEAR(gain.by_chance, 1.96 * 1.96, 1e-9);
  EXPECT_TRUE(gain.is_better());
  const HeldOutGain back = heldout_gain(campaign, records_of(with), records_of(without));
  EXPECT_NEAR(back.chi2, -16.0, 1e-9);
  EXPECT_NEAR(back.by_chance, gain.by_chance, 1e-9);
  EXPECT_TRUE(back.is_worse());
}

/// As above, with noise that the readings of a line share: sums d e over the two lines are 4 and -4, their
/// squares 32 in all against D = 16, twice what independent readings would make.
TEST(HeldOutGain, ReadingsOfALineAreNotIndependent) {
  Campaign campaign;
  campaign.setups = {setup_of(10, 2)};
  std::vector<double> with(20), without(20);
  for (std::size_t i = 0; i < with.size(); ++i) {
    with[i] = i / 2 % 2 == 0 ? 1.0 : -1.0;
    without[i] = with[i] + (i < 4 ? 2.0 : 0.0);
  }
  const HeldOutGain gain = heldout_gain(campaign, records_of(without), records_of(with));
  EXPECT_NEAR(gain.chi2, 16.0, 1e-9);
  EXPECT_NEAR(gain.by_chance, 2.0 * 1.96 * 1.96, 1e-9);
}

/// One parameter that is not there moves predictions by d = a g, a from other readings: noise makes a gain
/// beyond what chance is said to make in one case in forty at most, however large a came out.
TEST(HeldOutGain, NoiseAloneRarelyPassesForMore) {
  Campaign campaign;
  campaign.setups = {setup_of(60, 5)};
  std::mt19937 random(20);
  std::normal_distribution<double> noise;
  constexpr int kCampaigns = 2000;
  for (const double size : {0.02, 0.1, 0.3}) {
    int better = 0;
    for (int k = 0; k < kCampaigns; ++k) {
      std::vector<double> with(300), without(300);
      for (std::size_t i = 0; i < with.size(); ++i) {
        without[i] = noise(random);
        with[i] = without[i] - size * std::sin(0.1 * static_cast<double>(i));
      }
      better += heldout_gain(campaign, records_of(without), records_of(with)).is_better() ? 1 : 0;
    }
    EXPECT_LE(better, 0.035 * kCampaigns) << size;  // 2.5 % and three standard deviations
  }
}

TEST(HeldOutGain, OfTheSamePredictionsIsNothing) {
  Campaign campaign;
  campaign.setups = {setup_of(10, 2)};
  const auto records = records_of(std::vector<double>(20, 1.0));
  EXPECT_EQ(heldout_gain(campaign, records, records).chi2, 0.0);
  EXPECT_FALSE(heldout_gain(campaign, records, records).is_better());
  EXPECT_THROW(heldout_gain(campaign, records, {}), std::invalid_argument);
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
