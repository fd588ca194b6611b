// Waves of an axis' position: those that are there are found at their period, others are not.

#include "volcal/identify/criticism/scans/wave_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/projection/score_statistics.h"

namespace volcal {
namespace {

using testing_support::model_of_nothing_hidden;
using testing_support::white_projector;
using testing_support::white_residual;

Eigen::VectorXd wave(AxisName axis, ScanDirection direction, double period, double phase) {
  const LinearModel& model = model_of_nothing_hidden();
  Eigen::VectorXd moved = model.direction(direction);
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    const auto& [setup, row, channel] = model.observations()[static_cast<std::size_t>(i)];
    const double q = model.campaign().setups[setup].readings.position[index_of(axis)][row];
    moved[i] *= std::sin(2.0 * std::numbers::pi * q / period + phase);
  }
  return moved;
}

std::vector<WaveTest> scanned_waves(const Eigen::VectorXd& residual, int threads = 1) {
  return wave_scan(model_of_nothing_hidden(), white_projector(model_of_nothing_hidden(), residual), threads);
}

const WaveTest& least_probable_wave(const std::vector<WaveTest>& tests) {
  return *std::ranges::min_element(tests, {}, &WaveTest::log10_p);
}

double range_of(AxisName axis) {
  double low = 1e9, high = -1e9;
  for (const Setup& setup : model_of_nothing_hidden().campaign().setups) {
    const auto [least, most] = std::ranges::minmax(setup.readings.position[index_of(axis)]);
    low = std::min(low, least);
    high = std::max(high, most);
  }
  return high - low;
}

TEST(WaveScan, FindsScrewsAndScalesAtTheirPeriod) {
  const std::tuple<AxisName, ScanDirection, double> hidden[] = {{AxisName::X, ScanDirection::X, 10.3e-3},
                                                                {AxisName::Y, ScanDirection::Y, 5.07e-3},
                                                                {AxisName::Z, ScanDirection::X, 1.9e-3},
                                                                {AxisName::X, ScanDirection::Z, 41e-6}};
  std::mt19937_64 random(21);
  for (const auto& [axis, direction, period] : hidden) {
    const std::vector<WaveTest> tests = scanned_waves(white_residual(model_of_nothing_hidden(), random) +
                                                      2e-6 * wave(axis, direction, period, 0.7));
    ASSERT_EQ(tests.size(), 9U) << "three axes, three directions";
    const WaveTest& least = least_probable_wave(tests);
    EXPECT_EQ(least.axis, axis) << period;
    EXPECT_EQ(least.direction, direction) << period;
    EXPECT_NEAR(1.0 / least.period, 1.0 / period, 0.2 / range_of(axis)) << period;
    EXPECT_LT(least.log10_p, -10.0) << period;
    EXPECT_GT(least.log10_choices, 3.0) << "thousands of periods were looked at";
  }
}

/// The wave that is reported explains what its test says.
TEST(WaveScan, TestsTheProjectedWave) {
  std::mt19937_64 random(22);
  const LinearModel& model = model_of_nothing_hidden();
  const Projector projector = white_projector(
      model, white_residual(model, random) + 1e-6 * wave(AxisName::Y, ScanDirection::X, 7.3e-3, 0.1));
  for (const WaveTest& test : wave_scan(model, projector, 2)) {
    const Eigen::MatrixXd columns = wave_columns(model, test.axis, test.direction, test.period);
    EXPECT_NEAR(score_test(projector.project(columns), 0, 2).lm, test.projected_lm, 1e-6 * test.projected_lm);
    EXPECT_LE(test.lm, test.projected_lm);
  }
}

TEST(WaveScan, IsTheSameForAnyNumberOfThreads) {
  std::mt19937_64 random(23);
  const Eigen::VectorXd residual = white_residual(model_of_nothing_hidden(), random);
  const std::vector<WaveTest> one = scanned_waves(residual, 1), three = scanned_waves(residual, 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].period, three[i].period);
    EXPECT_EQ(one[i].lm, three[i].lm);
  }
}

/// At the level that p claims: of 180 tests of noise a twentieth or fewer has p below 0.05.
TEST(WaveScan, HoldsItsLevelOnNoise) {
  std::mt19937_64 random(24);
  int below = 0, tests = 0;
  for (int campaign = 0; campaign < 20; ++campaign) {
    for (const WaveTest& test : scanned_waves(white_residual(model_of_nothing_hidden(), random))) {
      ++tests;
      below += test.log10_p < std::log10(0.05) ? 1 : 0;
    }
  }
  EXPECT_EQ(tests, 180);
  EXPECT_LE(below, 9 + 6) << "two standard deviations above the expectation";
}

/// Readings of a position that err together, for whatever reason, are no wave.
TEST(WaveScan, TakesWhatRepeatsAtAPositionForNoWave) {
  std::mt19937_64 random(25);
  std::normal_distribution<double> normal;
  const LinearModel& model = model_of_nothing_hidden();
  std::map<double, double> of_position;
  Eigen::VectorXd moved = model.direction(ScanDirection::Z);
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    const auto& [setup, row, channel] = model.observations()[static_cast<std::size_t>(i)];
    const double z = model.campaign().setups[setup].readings.position[index_of(AxisName::Z)][row];
    const auto [entry, is_new] = of_position.try_emplace(z);
    if (is_new) entry->second = 3e-6 * normal(random);
    moved[i] *= entry->second;
  }
  ASSERT_LE(2 * of_position.size(), model.size()) << "positions are met from both sides";
  const WaveTest& least = least_probable_wave(scanned_waves(white_residual(model, random) + moved));
  EXPECT_GT(least.log10_p, -3.0);
  EXPECT_LT(2.0 * least.lm, least.projected_lm) << "the noise alone would make it one";
}

}  // namespace
}  // namespace volcal
