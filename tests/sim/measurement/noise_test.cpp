#include "volcal/sim/measurement/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

SetupPlan long_plan(int readings, double seconds) {
  SetupPlan plan;
  plan.name = "S";
  plan.instrument = "laser-tracer";
  plan.points.resize(static_cast<std::size_t>(readings));
  plan.seconds_per_reading = seconds;
  return plan;
}

TEST(Drift, HasItsSizeAndCorrelationTime) {
  constexpr int kNoiseReadings = 200000;
  constexpr int kLag = 20;  // 20 readings of 5 s are the correlation time
  SetupPlan plan = long_plan(kNoiseReadings, 5.0);
  plan.noise.drift = 0.4e-6;
  plan.noise.drift_time = 100.0;
  const CorrelatedNoise noise(plan, 11);
  double square = 0.0;
  double product = 0.0;
  for (std::size_t row = 0; row + kLag < kNoiseReadings; ++row) {
    square += noise.slow(row, 0) * noise.slow(row, 0);
    product += noise.slow(row, 0) * noise.slow(row + kLag, 0);
  }
  // 2,000 correlation times: the autocorrelation at one of them is known to 0.02 (k = 1), the variance to
  // 1 %.
  EXPECT_NEAR(product / square, std::exp(-1.0), 0.03);
  EXPECT_NEAR(std::sqrt(square / kNoiseReadings), 0.4e-6, 0.4e-6 * 0.02);
}

TEST(Drift, AutocorrelationHoldsOverManySetups) {
  constexpr int kSetups = 4000;
  constexpr std::size_t kLag = 15;
  double start = 0.0;
  double end = 0.0;
  double product = 0.0;
  for (int i = 0; i < kSetups; ++i) {
    SetupPlan plan = long_plan(static_cast<int>(kLag) + 1, 4.0);
    plan.name = "S" + std::to_string(i);
    plan.noise.drift = 1e-6;
    plan.noise.drift_time = 60.0;
    const CorrelatedNoise noise(plan, 5);
    start += noise.slow(0, 0) * noise.slow(0, 0) / kSetups;
    end += noise.slow(kLag, 0) * noise.slow(kLag, 0) / kSetups;
    product += noise.slow(0, 0) * noise.slow(kLag, 0) / kSetups;
  }
  // Standard errors of 4,000 independent draws: 2.2 % of a variance, 0.017 of the correlation.
  EXPECT_NEAR(start, 1e-12, 0.09e-12);
  EXPECT_NEAR(end, 1e-12, 0.09e-12);
  EXPECT_NEAR(product / 1e-12, std::exp(-1.0), 0.07);
}

TEST(LineOffsets, AreCommonInALineAndIndependentBetweenLines) {
  constexpr int kLines = 4000;
  SetupPlan plan = long_plan(3 * kLines, 1.0);
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    plan.points[row].line =
        static_cast<std::int32_t>(row % kLines);  // lines come back: their offset with them
  }
  plan.noise.line = 0.5e-6;
  const CorrelatedNoise noise(plan, 2);
  double square = 0.0;
  double product = 0.0;
  for (std::size_t line = 0; line < kLines; ++line) {
    EXPECT_EQ(noise.slow(line, 0), noise.slow(line + kLines, 0));
    EXPECT_EQ(noise.slow(line, 0), noise.slow(line + std::size_t{2} * kLines, 0));
    square += noise.slow(line, 0) * noise.slow(line, 0) / kLines;
    product += noise.slow(line, 0) * noise.slow((line + 1) % kLines, 0) / kLines;
  }
  EXPECT_NEAR(std::sqrt(square), 0.5e-6, 0.5e-6 * 0.05);
  EXPECT_NEAR(product / square, 0.0, 0.07);
}

TEST(Outliers, HaveTheirShare) {
  SetupPlan plan = long_plan(100000, 1.0);
  plan.noise.outlier_share = 0.003;
  const CorrelatedNoise noise(plan, 4);
  int wrong = 0;
  int positive = 0;
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    wrong += std::abs(noise.outlier(row, 0));
    positive += noise.outlier(row, 0) > 0 ? 1 : 0;
  }
  EXPECT_NEAR(wrong, 300, 70);  // 4 standard deviations of a binomial
  EXPECT_NEAR(positive, 0.5 * wrong, 40);
}

Study small_study() {
  Study study;
  study.machine = reference_machines()[0];
  study.seed = 8;
  Tracking tracer;
  tracer.grid = {5, 4, 3};
  Tracking tracker = tracer;
  tracker.instrument = "laser-tracker";
  study.measurements = {{"", tracer}, {"tracker", tracker}, {"", PointGrid{}}};
  return study;
}

void set_noise(Study& study, const NoiseLevel& noise) {
  std::get<Tracking>(study.measurements[0].settings).noise = noise;
  std::get<Tracking>(study.measurements[1].settings).noise = noise;
  std::get<PointGrid>(study.measurements[2].settings).noise = noise;
}

using Values = std::vector<std::vector<std::vector<double>>>;

Values values(const Campaign& campaign) {
  Values all;
  for (const volcal::Setup& setup : campaign.setups) all.push_back(setup.readings.value);
  return all;
}

/// What adding one part of the noise adds to each reading does not depend on the other parts.
TEST(CorrelatedParts, AreAddedToWhatIsThereAlready) {
  const NoiseLevel plain{0.3e-6, 0.2e-6, 2e-6, 0.5e-6};
  const auto with = [&](double drift, double line, double outliers) {
    NoiseLevel noise = plain;
    noise.drift = drift;
    noise.line = line;
    noise.outlier_share = outliers;
    Study study = small_study();
    set_noise(study, noise);
    return values(simulate(study).campaign);
  };
  const Values none = with(0, 0, 0);
  const Values drift = with(0.4e-6, 0, 0);
  const Values line = with(0, 0.6e-6, 0);
  const Values outliers = with(0, 0, 0.1);
  const Values all = with(0.4e-6, 0.6e-6, 0.1);
  int moved = 0;
  for (std::size_t i = 0; i < none.size(); ++i) {
    for (std::size_t k = 0; k < none[i].size(); ++k) {
      for (std::size_t row = 0; row < none[i][k].size(); ++row) {
        const double base = none[i][k][row];
        EXPECT_NEAR(all[i][k][row] - base,
                    (drift[i][k][row] - base) + (line[i][k][row] - base) + (outliers[i][k][row] - base),
                    1e-14);
        moved += outliers[i][k][row] != base ? 1 : 0;
      }
    }
  }
  EXPECT_GT(moved, 0);
}

TEST(CorrelatedParts, ArePartOfNoStatementAndOfTheSealedTruth) {
  NoiseLevel noise{0.3e-6, 0.2e-6, 2e-6, 0.5e-6};
  noise.drift = 0.4e-6;
  noise.line = 0.6e-6;
  noise.outlier_share = 0.1;
  noise.outlier_size = 10.0;
  Study study = small_study();
  set_noise(study, noise);
  const SimulatedCampaign noisy = simulate(study);
  noise.outlier_share = 0.0;
  set_noise(study, noise);
  const SimulatedCampaign clean = simulate(study);
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < noisy.campaign.setups.size(); ++i) {
    const volcal::Setup& setup = noisy.campaign.setups[i];
    index[setup.name] = i;
    EXPECT_EQ(setup.noise.all().size(), setup.instrument == "laser-tracker" ? 3U : 2U);
    EXPECT_EQ(setup.noise.number("constant"), 0.3e-6);
  }
  ASSERT_FALSE(noisy.outliers.empty());
  Values difference = values(noisy.campaign);
  const Values without = values(clean.campaign);
  for (const GrossError& error : noisy.outliers) {
    const std::size_t i = index.at(error.setup);
    const double jump = difference[i][error.channel][error.row] - without[i][error.channel][error.row];
    EXPECT_GT(jump * error.sign, 10.0 * 0.58e-6);  // ten times hypot(0.3, 0.5) at least
    difference[i][error.channel][error.row] = without[i][error.channel][error.row];
  }
  EXPECT_EQ(difference, without);  // every other reading is the same
  EXPECT_TRUE(clean.outliers.empty());
}

}  // namespace
}  // namespace volcal::sim
