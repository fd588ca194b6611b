#include "volcal/identify/standards/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace volcal {
namespace {

using ::testing::ElementsAre;
using By = Grouping::Kind;

/// One axis X of 0 to 1 m and Y of 0 to 0.5 m; a tracer setup S1 (tool a) and a level setup S2 (tool b).
Campaign small_campaign() {
  Campaign campaign;
  campaign.machine.structure = Structure::parse("w X' b Y t");
  for (const AxisName name : {AxisName::X, AxisName::Y}) {
    Axis axis;
    axis.name = name;
    axis.travel_max = name == AxisName::X ? 1.0 : 0.5;
    campaign.machine.axes.push_back(axis);
  }
  campaign.machine.tools = {{"a", Eigen::Vector3d::Zero(), 0.0}, {"b", Eigen::Vector3d::UnitX(), 0.0}};
  for (const auto& [name, instrument, tool] :
       {std::tuple("S1", "laser-tracer", 0U), std::tuple("S2", "angle", 1U)}) {
    Setup setup;
    setup.name = name;
    setup.instrument = instrument;
    setup.tool = tool;
    setup.readings.position[0] = {0.05, 0.45, 0.95, 0.45};
    setup.readings.position[1] = {0.1, 0.1, 0.4, 0.4};
    setup.readings.value = {{0.0, 0.0, 0.0, 0.0}};
    setup.readings.source_line = {2, 3, 4, 5};
    campaign.setups.push_back(setup);
  }
  campaign.setups[0].readings.run = {1, 1, 2, 2};
  campaign.setups[0].readings.line = {1, 1, 2, 2};
  campaign.setups[0].readings.time = {0.0, 10.0, 90.0, 100.0};
  return campaign;
}

ResidualRecord record(std::size_t setup, std::size_t row, double residual, double sigma) {
  ResidualRecord result;
  result.setup = setup;
  result.row = row;
  result.reading = residual;
  result.sigma = sigma;
  result.redundancy = 1.0;
  return result;
}

/// Residuals over sigma: S1 1, 2, 3, 0; S2 0, 1, 0, 1.
std::vector<ResidualRecord> small_records() {
  return {record(0, 0, 1e-6, 1e-6), record(0, 1, 4e-6, 2e-6), record(0, 2, -3e-6, 1e-6),
          record(0, 3, 0.0, 1e-6),  record(1, 0, 0.0, 1e-6),  record(1, 1, 1e-6, 1e-6),
          record(1, 2, 0.0, 1e-6),  record(1, 3, -2e-6, 2e-6)};
}

std::vector<std::string> labels(const Breakdown* breakdown) {
  std::vector<std::string> result;
  if (breakdown) {
    for (const auto& cell : breakdown->cells) result.push_back(cell.label);
  }
  return result;
}

std::vector<double> chi2(const Breakdown* breakdown) {
  std::vector<double> result;
  if (breakdown) {
    for (const auto& cell : breakdown->cells) result.push_back(std::round(cell.chi2 * 1e9) / 1e9);
  }
  return result;
}

/// chi2: S1 1 + 4 + 9 + 0 = 14, S2 0 + 1 + 0 + 1 = 2. Lengths: RMS sqrt((1 + 16 + 9 + 0) / 4) um, max 4 um;
/// angles: sqrt((0 + 1 + 0 + 4) / 4) urad, max 2 urad.
TEST(Compare, TotalsAndSetups) {
  const Campaign campaign = small_campaign();
  const Comparison comparison = compare(campaign, small_records());
  EXPECT_EQ(comparison.total.observations, 8U);
  EXPECT_NEAR(comparison.total.chi2, 16.0, 1e-12);
  EXPECT_NEAR(comparison.total.lengths.rms, std::sqrt(26.0 / 4.0) * 1e-6, 1e-15);
  EXPECT_NEAR(comparison.total.lengths.max, 4e-6, 1e-15);
  EXPECT_NEAR(comparison.total.angles.rms, std::sqrt(5.0 / 4.0) * 1e-6, 1e-15);
  EXPECT_NEAR(comparison.total.angles.max, 2e-6, 1e-15);
  EXPECT_THAT(labels(comparison.find({By::Setup})), ElementsAre("S1", "S2"));
  EXPECT_THAT(chi2(comparison.find({By::Setup})), ElementsAre(14.0, 2.0));
  EXPECT_THAT(labels(comparison.find({By::Instrument})), ElementsAre("laser-tracer", "angle"));
  EXPECT_THAT(labels(comparison.find({By::Tool})), ElementsAre("a", "b"));
}

/// Ten bins of X, 100 mm each: 50 mm in the first (1 + 0), 450 mm in the fifth (4 + 0 + 1 + 1), 950 mm in the
/// tenth (9 + 0). Two blocks per axis: X below 500 with Y below 250: 1 + 4 + 0 + 1; X below, Y above: 0 + 1;
/// X above, Y above: 9 + 0.
TEST(Compare, PositionsAndRegions) {
  const Campaign campaign = small_campaign();
  const Comparison comparison = compare(campaign, small_records());
  EXPECT_THAT(labels(comparison.find({By::Position, AxisName::X})),
              ElementsAre("X 0 to 100 mm", "X 400 to 500 mm", "X 900 to 1000 mm"));
  EXPECT_THAT(chi2(comparison.find({By::Position, AxisName::X})), ElementsAre(1.0, 6.0, 9.0));
  EXPECT_THAT(labels(comparison.find({By::Region})),
              ElementsAre("X 0 to 500, Y 0 to 250 mm", "X 0 to 500, Y 250 to 500 mm",
                          "X 500 to 1000, Y 250 to 500 mm"));
  EXPECT_THAT(chi2(comparison.find({By::Region})), ElementsAre(6.0, 1.0, 9.0));
}

/// X of S1 in passes of two: 50 to 450 and 950 to 450 mm: + + - -. X of S2 in one pass: + + + -.
/// X+: 1 + 4 of S1, 0 + 1 + 0 of S2; X-: 9 + 0 of S1, 1 of S2. Columns go before the order.
TEST(Compare, Directions) {
  Campaign campaign = small_campaign();
  const Comparison by_order = compare(campaign, small_records());
  EXPECT_THAT(labels(by_order.find({By::Direction, AxisName::X})), ElementsAre("X+", "X-"));
  EXPECT_THAT(chi2(by_order.find({By::Direction, AxisName::X})), ElementsAre(6.0, 10.0));
  campaign.setups[0].readings.direction[0] = {1, 1, 1, 1};
  const Comparison by_column = compare(campaign, small_records());
  EXPECT_THAT(chi2(by_column.find({By::Direction, AxisName::X})), ElementsAre(15.0, 1.0));
}

/// Lines, runs and times exist in S1 alone. Time in ten parts of 10 s: 0 s in the first, 10 s in the second,
/// 90 and 100 s (the end) in the last.
TEST(Compare, LinesRunsAndTime) {
  const Campaign campaign = small_campaign();
  const Comparison comparison = compare(campaign, small_records());
  EXPECT_THAT(labels(comparison.find({By::Line})), ElementsAre("S1 line 1", "S1 line 2"));
  EXPECT_THAT(chi2(comparison.find({By::Line})), ElementsAre(5.0, 9.0));
  EXPECT_THAT(labels(comparison.find({By::Run})), ElementsAre("run 1", "run 2"));
  EXPECT_THAT(labels(comparison.find({By::Time})), ElementsAre("0 to 10 s", "10 to 20 s", "90 to 100 s"));
  EXPECT_THAT(chi2(comparison.find({By::Time})), ElementsAre(1.0, 4.0, 9.0));
}

TEST(Compare, WorstReadingsComeFirst) {
  ComparisonOptions options;
  options.worst = 3;
  const Campaign campaign = small_campaign();
  EXPECT_THAT(compare(campaign, small_records(), options).worst, ElementsAre(2, 1, 0));
}

TEST(Compare, RemovedReadingsAreCountedListedAndLeftOutOfChi2) {
  auto records = small_records();
  records[2].removed = true;
  const Campaign campaign = small_campaign();
  const Comparison comparison = compare(campaign, records);
  EXPECT_EQ(comparison.removed, 1U);
  EXPECT_NEAR(comparison.total.chi2, 7.0, 1e-12);
  EXPECT_EQ(comparison.worst.front(), 2U);
}

/// chi2 14 on 4 degrees of freedom: exp(-7) (1 + 7) = 0.0073. Two setups alone would call it significant at
/// 5 % / 2; over the 23 cells listed it is not. Ten times the residuals: chi2 1400, and it is. The campaign's
/// chi2/dof is then 1600 / 8 = 200; S1 by that measure has 1400 / 200 = 7 on 4: nothing remarkable.
TEST(Compare, SignificanceIsSharedOverAllCells) {
  const Campaign campaign = small_campaign();
  const Comparison calm = compare(campaign, small_records());
  const ComparisonCell& setup = calm.find({By::Setup})->cells[0];
  EXPECT_NEAR(setup.probability, 8.0 * std::exp(-7.0), 1e-9);
  std::size_t cells = 0;
  for (const Breakdown& breakdown : calm.breakdowns) cells += breakdown.cells.size();
  EXPECT_EQ(calm.cells, cells);
  EXPECT_GT(static_cast<double>(cells), 0.05 / setup.probability);
  EXPECT_FALSE(setup.significant);

  auto records = small_records();
  for (auto& one : records) one.reading *= 10.0;
  const ComparisonCell bad = compare(campaign, records).find({By::Setup})->cells[0];
  EXPECT_NEAR(bad.chi2, 1400.0, 1e-9);
  EXPECT_TRUE(bad.significant);
  EXPECT_FALSE(bad.stands_out);
}

/// S1 alone 100 times worse: it stands out against the rest. chi2 140,000 of 140,002 on 8: chi2/dof 17,500;
/// 140,000 / 17,500 = 8 on 4 would not; so 400 readings of S2 beside it: chi2/dof 140,000 / 404 = 346, and
/// 140,000 / 346 = 404 on 4 does.
TEST(Compare, OneBadSetupStandsOut) {
  Campaign campaign = small_campaign();
  auto records = small_records();
  for (std::size_t i = 0; i < 4; ++i) records[i].reading *= 100.0;
  for (int repeat = 0; repeat < 99; ++repeat) {
    for (std::size_t row = 0; row < 4; ++row) records.push_back(record(1, row, 1e-6, 1e-6));
  }
  const Comparison comparison = compare(campaign, records);
  EXPECT_TRUE(comparison.find({By::Setup})->cells[0].stands_out);
  EXPECT_FALSE(comparison.find({By::Setup})->cells[1].stands_out);
}

TEST(Compare, RedundancyIsTheExpectedChi2) {
  auto records = small_records();
  for (auto& one : records) one.redundancy = 0.5;
  const Campaign campaign = small_campaign();
  const Comparison comparison = compare(campaign, records);
  EXPECT_NEAR(comparison.total.dof, 4.0, 1e-12);
  EXPECT_NEAR(comparison.total.reduced_chi2(), 4.0, 1e-12);
}

TEST(Compare, AxesThatNeverMoveGetNoBreakdown) {
  Campaign campaign = small_campaign();
  for (volcal::Setup& setup : campaign.setups) setup.readings.position[1].assign(4, 0.2);
  const Comparison comparison = compare(campaign, small_records());
  EXPECT_EQ(comparison.find({By::Position, AxisName::Y}), nullptr);
  EXPECT_EQ(comparison.find({By::Direction, AxisName::Y}), nullptr);
  EXPECT_NE(comparison.find({By::Position, AxisName::X}), nullptr);
}

TEST(Grouping, IsNamedAsResultsWriteIt) {
  EXPECT_EQ(Grouping{By::Setup}.name(), "setup");
  EXPECT_EQ(Grouping{By::Instrument}.name(), "instrument");
  EXPECT_EQ(Grouping{By::Tool}.name(), "tool");
  EXPECT_EQ((Grouping{By::Position, AxisName::C}).name(), "C");
  EXPECT_EQ((Grouping{By::Direction, AxisName::X}).name(), "direction of X");
  EXPECT_EQ(Grouping{By::Region}.name(), "region");
  EXPECT_EQ(Grouping{By::Line}.name(), "line");
  EXPECT_EQ(Grouping{By::Run}.name(), "run");
  EXPECT_EQ(Grouping{By::Time}.name(), "time");
}

/// S1: (1 + 4 - 3 + 0) / 4 = 0.5 um; S2: (0 + 1 + 0 - 2) / 4 = -0.25 urad; lengths of all: those of S1.
TEST(Comparison, MeansKeepTheirSign) {
  const Campaign campaign = small_campaign();
  const Comparison comparison = compare(campaign, small_records());
  const Breakdown* setups = comparison.find({By::Setup});
  ASSERT_EQ(setups->cells.size(), 2U);
  EXPECT_NEAR(setups->cells[0].lengths.mean, 0.5e-6, 1e-15);
  EXPECT_NEAR(setups->cells[1].angles.mean, -0.25e-6, 1e-15);
  EXPECT_NEAR(comparison.total.lengths.mean, 0.5e-6, 1e-15);
  EXPECT_NEAR(comparison.total.angles.mean, -0.25e-6, 1e-15);
}

}  // namespace
}  // namespace volcal
