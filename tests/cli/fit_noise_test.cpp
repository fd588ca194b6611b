/// Noise of a fit on the command line: what is looked for, printed and written.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

/// A campaign whose readings drift and whose lines have offsets.
class FitNoiseProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    simulated_.simulate(5,
                        "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [4, 4, 4]\n"
                        "noise = { constant_um = 0.25, per_metre_um = 0.3, repeatability_um = 0.6, "
                        "wander_um = 1.2, wander_time_s = 60.0, line_um = 0.8 }\n"
                        "[validation]\npoints = 5\n",
                        3, 3);
  }

  std::string path(const std::string& name) const { return simulated_.path(name); }
  auto fit(const std::string& options) const { return simulated_.fit(options); }

 private:
  testing::SimulatedCampaign simulated_;
};

TEST_F(FitNoiseProgram, PrintsAndWritesWhatIsFound) {
  const auto run = fit("--verbose");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("Noise by restricted maximum likelihood"));
  EXPECT_THAT(run.output, ::testing::ContainsRegex("correlated drift of [0-9.]+ um over [0-9]+ s"));
  EXPECT_THAT(run.output, HasSubstr("its noise is not independent"));
  const auto noise = nlohmann::json::parse(content(path("result/result.json"))).at("noise");
  EXPECT_TRUE(noise.at("more_than_white").get<bool>());
  EXPECT_NEAR(noise.at("whitened_chi2_per_dof").get<double>(), 1.0, 0.1);
  bool drift = false;
  for (const auto& row : noise.at("terms")) {
    if (row.at("term") != "wander") continue;
    drift = true;
    EXPECT_EQ(row.at("instrument"), "laser-tracer");
    EXPECT_NEAR(row.at("value").get<double>(), 1.2e-6, 0.4e-6);
    EXPECT_LT(row.at("low").get<double>(), row.at("value").get<double>());
    EXPECT_GT(row.at("high").get<double>(), row.at("value").get<double>());
  }
  EXPECT_TRUE(drift);
  // Other commands read the result.
  EXPECT_EQ(run_program("tables " + path("result") + " --format csv -o " + path("tables")).exit_code, 0);
}

TEST_F(FitNoiseProgram, TakesReadingsAsIndependentWhenAsked) {
  const auto run = fit("--noise white");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("readings taken as independent"));
  EXPECT_THAT(run.output, Not(HasSubstr("correlated drift")));
  const auto noise = nlohmann::json::parse(content(path("result/result.json"))).at("noise");
  EXPECT_FALSE(noise.at("estimated").get<bool>());
  EXPECT_TRUE(noise.at("terms").empty());
}

TEST_F(FitNoiseProgram, RefusesAnUnknownNoise) {
  const auto run = fit("--noise pink");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("--noise"));
  EXPECT_THAT(run.errors, HasSubstr("pink"));
}

}  // namespace
}  // namespace volcal
