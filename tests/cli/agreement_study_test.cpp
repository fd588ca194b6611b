// A small count of what `volcal study agreement` says in full; docs/studies.md has that.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace volcal {
namespace {

using testing::run_program;

TEST(AgreementStudy, LinearPropagationMonteCarloAndScatterAgreeWithinChance) {
  constexpr double kCampaigns = 40.0, kDraws = 2000.0, kSigmas = 5.0;
  const auto run = run_program("study agreement -n 40 --draws 2000 --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  const auto& values = json.at("values");
  ASSERT_GT(values.size(), 100U);
  double mean_scatter = 0.0;
  for (const auto& value : values) {
    const auto scatter = value.at("scatter_over_linear").get<double>();
    EXPECT_NEAR(value.at("montecarlo_over_linear").get<double>(), 1.0, kSigmas / std::sqrt(2.0 * kDraws))
        << value;
    EXPECT_NEAR(scatter, 1.0, kSigmas / std::sqrt(2.0 * kCampaigns)) << value;
    mean_scatter += scatter / static_cast<double>(values.size());
  }
  EXPECT_NEAR(mean_scatter, 1.0, 0.05);
}

TEST(AgreementStudy, RefusesWhatIsNoNumberOfCampaigns) {
  EXPECT_EQ(run_program("study agreement -n 1").exit_code, 2);
}

}  // namespace
}  // namespace volcal
