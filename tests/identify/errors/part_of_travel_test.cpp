// Automatic knots where a part of the travel was measured: resolution is that of the part.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/machines.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/priors/resolution.h"

namespace volcal {
namespace {

constexpr double kMeasured = 0.2;        // m
constexpr double kStepOfTravel = 0.025;  // m
constexpr double kPeriod = 0.1;          // m
constexpr double kAmplitude = 1e-5;      // m
constexpr double kSigmaOfTravel = 5e-7;  // m

double truth(double x) { return kAmplitude * std::sin(2.0 * 3.14159265358979323846 * x / kPeriod); }

Axis axis_of(double travel) {
  Axis axis;
  axis.name = AxisName::X;
  axis.travel_max = travel;
  return axis;
}

/// Five runs of a line along X over 200 mm of its travel, from `start`, where its home is.
Campaign line_on(double travel, double start = 0.0, unsigned seed = 7) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("wbXYZt");
  for (Axis& axis : campaign.machine.axes) axis.travel_max = travel;
  std::ranges::find(campaign.machine.axes, AxisName::X, &Axis::name)->home = start;
  campaign.machine.tools = {{"t", Eigen::Vector3d::Zero(), 0.0}};
  Setup& setup = campaign.setups.emplace_back();
  setup.name = "X";
  setup.instrument = "displacement";
  setup.noise.set("constant", kSigmaOfTravel);
  setup.readings.value.resize(1);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 5; ++run) {
    for (int i = 0; i * kStepOfTravel < kMeasured + 1e-9; ++i) {
      const double x = start + i * kStepOfTravel;
      setup.readings.position[0].push_back(x);
      setup.readings.position[1].push_back(0.0);
      setup.readings.position[2].push_back(0.0);
      setup.readings.value[0].push_back(x - start + truth(x) - truth(start) +
                                        kSigmaOfTravel * normal(random));
      setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.source_line.size()) + 2);
    }
  }
  return campaign;
}

FitResult positioning_of(const Campaign& campaign) {
  ModelSpec model;
  model.default_function.basis = "zero";
  model.functions[{Component::X, AxisName::X}] = FunctionSpec{};
  const auto squareness = campaign.machine.datum.squareness();
  model.locations_off = {squareness.begin(), squareness.end()};
  FitOptions options;
  options.threads = 1;
  return fit(campaign, model, options);
}

ErrorTableRow value_at(const FitResult& result, double x) {
  ErrorTableOptions options;
  options.step = kStepOfTravel;
  for (const ErrorTableRow& row : error_table(result, options)) {
    if (row.symbol.name() == "EXX" && std::abs(row.position - x) < 1e-9) return row;
  }
  return {};
}

TEST(PartOfTravel, ValuesAreThoseOfAShortAxis) {
  const FitResult on_long = positioning_of(line_on(1.0)), on_short = positioning_of(line_on(kMeasured));
  for (const double x : {0.025, 0.075, 0.125, 0.175}) {
    const ErrorTableRow row = value_at(on_long, x), expected = value_at(on_short, x);
    EXPECT_FALSE(row.extrapolated);
    EXPECT_NEAR(row.value, expected.value, 0.25 * expected.U95) << x;
    EXPECT_NEAR(row.u / expected.u, 1.0, 0.1) << x;
  }
  EXPECT_EQ(on_long.status, FitStatus::Ok);
  EXPECT_NEAR(on_long.variance_components.front().scale, 1.0, 0.35) << "the wave is no noise";
}

/// Rows in steps of 50 mm would meet the wave of 100 mm at its zeros alone.
TEST(PartOfTravel, StepsOfTablesFollowThePieces) {
  double largest = 0.0, step = 0.0, before = 0.0;
  for (const ErrorTableRow& row : error_table(positioning_of(line_on(1.0)))) {
    if (row.symbol.name() != "EXX" || row.position > kMeasured + 1e-9) continue;
    largest = std::max(largest, std::abs(row.value));
    step = std::max(step, row.position - before);
    before = row.position;
  }
  EXPECT_LE(step, kStepOfTravel + 1e-9);
  EXPECT_NEAR(largest, kAmplitude, 0.15 * kAmplitude);
}

// One draw of the noise may be off: seed 7 estimates 0.7 of it and is 1.9 U95 off at 25 mm, on either axis.
// Over draws the values have no bias and U95 covers 95 % of them, within what 20 draws of 8 values tell.
TEST(PartOfTravel, UncertaintyCoversTheTruth) {
  constexpr int kDraws = 20;
  int inside = 0, values = 0;
  double sum = 0.0, variance = 0.0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const FitResult result = positioning_of(line_on(1.0, 0.0, seed));
    for (int i = 1; i <= 8; ++i) {
      const ErrorTableRow row = value_at(result, i * kStepOfTravel);
      const double off = row.value - truth(i * kStepOfTravel);
      ++values;
      if (std::abs(off) < row.U95) ++inside;
      sum += off / 8.0;
      variance += row.u * row.u / 8.0;
      EXPECT_LT(row.U95, 1.5e-6) << seed;
    }
  }
  EXPECT_GE(inside, static_cast<int>(0.88 * values));
  EXPECT_LT(std::abs(sum) / kDraws, 3.0 * std::sqrt(variance) / kDraws);
}

TEST(PartOfTravel, UncertaintyGrowsOutside) {
  const FitResult result = positioning_of(line_on(1.0, 0.4));
  double before = value_at(result, 0.6).u;
  for (const double x : {0.65, 0.7, 0.8, 1.0}) {
    const ErrorTableRow row = value_at(result, x);
    EXPECT_TRUE(row.extrapolated);
    EXPECT_GT(row.u, before) << x;
    before = row.u;
  }
  EXPECT_GT(value_at(result, 1.0).u, 10.0 * value_at(result, 0.5).u);
  EXPECT_LT(value_at(result, 1.0).u, 1e-3);
}

TEST(PartOfTravel, PiecesAreEvenInsideAndDoubleOutside) {
  const Campaign campaign = line_on(1.0, 0.4);
  const ResolvedStretch stretch = resolved_stretch(campaign, AxisName::X);
  EXPECT_NEAR(stretch.min, 0.4, 1e-12);
  EXPECT_NEAR(stretch.max, 0.6, 1e-12);
  EXPECT_EQ(stretch.intervals, 8);
  const std::vector<double> knots = stretch.breakpoints(axis_of(1.0));
  EXPECT_EQ(knots.front(), 0.0);
  EXPECT_EQ(knots.back(), 1.0);
  ASSERT_TRUE(std::ranges::is_sorted(knots, std::less_equal{}));
  std::vector<double> pieces;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) pieces.push_back(knots[i + 1] - knots[i]);
  EXPECT_EQ(std::ranges::count_if(pieces, [](double each) { return std::abs(each - kStepOfTravel) < 1e-9; }),
            8);
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
    EXPECT_LT(std::max(pieces[i + 1] / pieces[i], pieces[i] / pieces[i + 1]), 3.001);
}

TEST(PartOfTravel, AGapOfOneIntervalIsNone) {
  const Axis axis = axis_of(kMeasured + kStepOfTravel);
  const ResolvedStretch stretch = resolved_stretch(line_on(axis.travel_max), AxisName::X);
  EXPECT_TRUE(stretch.is_whole(axis));
  EXPECT_EQ(stretch.intervals, 8);
  EXPECT_EQ(resolved_stretch(line_on(1.0), AxisName::Y).intervals, 1) << "Y stands still";
  EXPECT_TRUE(resolved_stretch(line_on(1.0), AxisName::Y).is_whole(axis_of(1.0)));
}

}  // namespace
}  // namespace volcal
