#include "volcal/identify/solve/residuals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace volcal {
namespace {

struct Reading {
  std::size_t setup;
  std::size_t row;
  int channel;
  double residual;
  bool removed = false;
};

/// A tracker of three readings and an autocollimator of two, predicted as zero; sigma 1e-6.
class SetupSummaries : public ::testing::Test {
 protected:
  SetupSummaries() {
    campaign_.machine.tools = {{"probe", Eigen::Vector3d::Zero(), 0.0}};
    campaign_.setups.resize(2);
    campaign_.setups[0].instrument = "laser-tracker";
    campaign_.setups[0].readings.value.assign(3, std::vector<double>(3));
    campaign_.setups[1].instrument = "angle";
    campaign_.setups[1].readings.value.assign(1, std::vector<double>(2));
  }

  std::vector<SetupSummary> of(const std::vector<Reading>& readings) const {
    std::vector<ResidualRecord> records;
    for (const Reading& each : readings) {
      ResidualRecord record;
      record.setup = each.setup;
      record.row = each.row;
      record.channel = each.channel;
      record.reading = each.residual;
      record.removed = each.removed;
      record.redundancy = 0.5;
      records.push_back(record);
    }
    return setup_summaries(campaign_, records, std::vector<double>(records.size(), 1e-6));
  }

  Campaign campaign_;
};

std::vector<ResidualRecord> flagged_records(const std::vector<double>& w, std::size_t setup,
                                            std::size_t removed) {
  std::vector<ResidualRecord> records;
  for (std::size_t i = 0; i < w.size(); ++i) {
    ResidualRecord record;
    record.setup = setup;
    record.row = i;
    record.w = w[i];
    record.flagged = std::abs(w[i]) > 4.0;
    record.removed = i < removed;
    records.push_back(record);
  }
  return records;
}

/// Of w = 9, -8, 5 the first two leave with a share of 0.7; the 12 that is out already counts for nothing.
TEST(WorstOutliers, LeaveWithThoseOfNearlyTheirSize) {
  auto records = flagged_records({12.0, 9.0, 1.0, -8.0, 5.0, 0.5, 0.2, 0.1}, 0, 1);
  EXPECT_EQ(worst_outliers(records, 0.7, 0.25), (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(worst_outliers(records, 1.0, 0.25), (std::vector<std::size_t>{1}));
  const auto other = flagged_records({4.5, 0.0}, 1, 0);
  records.insert(records.end(), other.begin(), other.end());
  EXPECT_EQ(worst_outliers(records, 0.7, 0.25), (std::vector<std::size_t>{1, 3, 8})) << "setup by setup";
}

/// Two of eight are a quarter and may go on; three are more.
TEST(WorstOutliers, StopWhereTooMuchOfASetupHasLeft) {
  const std::vector<double> w = {12.0, 12.0, 12.0, 9.0, 0.3, 0.5, 0.2, 0.1};
  EXPECT_EQ(worst_outliers(flagged_records(w, 0, 2), 0.7, 0.25), (std::vector<std::size_t>{2, 3}));
  EXPECT_TRUE(worst_outliers(flagged_records(w, 0, 3), 0.7, 0.25).empty());
}

/// What the campaign asked for says nothing against the model.
TEST(WorstOutliers, DoNotCountWhatTheCampaignLeavesOut) {
  auto records = flagged_records({12.0, 12.0, 12.0, 9.0, 0.3, 0.5, 0.2, 0.1}, 0, 3);
  records[0].left_out = true;
  EXPECT_EQ(worst_outliers(records, 0.7, 0.25), (std::vector<std::size_t>{3}));
}

/// Lengths of 3, 4 and 5 um and angles, of which some are removed: sqrt((9 + 16 + 25) / 3) um.
TEST_F(SetupSummaries, OfATrackerAreMeansOfItsLengths) {
  const auto summaries = of({{0, 0, 0, 3e-6},
                             {0, 0, 1, 90e-6},
                             {0, 0, 2, 80e-6},
                             {0, 1, 0, 4e-6},
                             {0, 1, 1, 70e-6, true},
                             {0, 1, 2, 60e-6, true},
                             {0, 2, 0, -5e-6},
                             {0, 2, 1, 2e-6},
                             {0, 2, 2, 1e-6}});
  EXPECT_EQ(summaries[0].reading_unit, "um");
  EXPECT_EQ(summaries[0].observations, 7U);
  EXPECT_NEAR(summaries[0].rms_residual, std::sqrt(50.0 / 3.0) * 1e-6, 1e-15);
  EXPECT_NEAR(summaries[0].max_residual, 5e-6, 1e-18);
  EXPECT_NEAR(summaries[0].chi2, 9 + 8100 + 6400 + 16 + 25 + 4 + 1, 1e-6);
  EXPECT_EQ(summaries[0].redundancy, 3.5);
  EXPECT_EQ(summaries[1].rms_residual, 0.0);  // no readings
}

TEST_F(SetupSummaries, OfAnAutocollimatorAreMeansOfItsAngles) {
  const auto summaries = of({{1, 0, 0, 3e-6}, {1, 1, 0, 1e-6}});
  EXPECT_EQ(summaries[1].reading_unit, "urad");
  EXPECT_NEAR(summaries[1].rms_residual, std::sqrt(5.0) * 1e-6, 1e-15);
}

/// Lengths alone removed: there is no RMS to tell.
TEST_F(SetupSummaries, AnglesThatRemainMakeNoLength) {
  const auto summaries = of({{0, 0, 0, 3e-6, true}, {0, 0, 1, 90e-6}, {0, 0, 2, 80e-6}});
  EXPECT_EQ(summaries[0].observations, 2U);
  EXPECT_EQ(summaries[0].rms_residual, 0.0);
  EXPECT_EQ(summaries[0].max_residual, 0.0);
}

}  // namespace
}  // namespace volcal
