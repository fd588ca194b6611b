/// A reading that the campaign leaves out changes nothing, whatever its value, and is listed with its reason.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

constexpr int kRow = 12;  // line of the file

/// Equal but for rounding: the iteration starts from guesses that readings give, also one that is left out.
void expect_same_numbers(const nlohmann::json& actual, const nlohmann::json& expected) {
  const nlohmann::json all = actual.flatten(), wanted = expected.flatten();
  ASSERT_EQ(all.size(), wanted.size());
  for (const auto& [key, value] : wanted.items()) {
    ASSERT_TRUE(all.contains(key)) << key;
    if (value.is_number_float()) {
      const double number = value.get<double>();
      EXPECT_NEAR(all.at(key).get<double>(), number, 1e-6 * (1.0 + std::abs(number))) << key;
    } else {
      EXPECT_EQ(all.at(key), value) << key;
    }
  }
}

class LeaveOutProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    simulated_.simulate(11,
                        "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [4, 4, 4]\n"
                        "[truth]\nkind = \"perfect\"\n[validation]\npoints = 5\n",
                        2, 1);
    name_ = first_setup();
  }

  std::string path(const std::string& name) const { return simulated_.path(name); }

  void leave_out() const {
    const std::string campaign = content(path("campaign/campaign.toml"));
    const std::size_t at = campaign.find("data = ");
    std::ofstream(path("campaign/campaign.toml")) << campaign.substr(0, at) << "leave_out = [{ rows = ["
                                                  << kRow << "], reason = \"beam interrupted\" }]\n"
                                                  << campaign.substr(at);
  }

  /// Adds 0.5 mm to the reading, the last cell of its line.
  void spoil() const {
    const std::string file = path("campaign/" + name_ + ".csv");
    std::istringstream lines(content(file));
    std::ofstream spoilt(file);
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      if (++number == kRow) {
        const std::size_t comma = line.rfind(',');
        line = line.substr(0, comma + 1) + std::to_string(std::stod(line.substr(comma + 1)) + 0.5);
      }
      spoilt << line << "\n";
    }
  }

  testing::ProgramRun fit(const std::string& options = "") const {
    return simulated_.fit("--noise white --verbose " + options);
  }
  std::string judged(const std::string& command) const {
    const auto run = run_program(command);
    EXPECT_LE(run.exit_code, 1) << run.errors;
    return run.output;
  }

  testing::SimulatedCampaign simulated_;
  std::string name_;

 private:
  std::string first_setup() const {
    const std::string campaign = content(path("campaign/campaign.toml"));
    const std::size_t begin = campaign.find("name = \"") + 8;
    return campaign.substr(begin, campaign.find('"', begin) - begin);
  }
};

TEST_F(LeaveOutProgram, TakesNoPartInAFitOrAJudgement) {
  const std::string campaign = path("campaign/campaign.toml");
  const std::string compare = "compare " + campaign + " " + path("result") + " --json";
  const std::string validate = "validate " + path("result") + " " + campaign + " --json";
  leave_out();
  ASSERT_EQ(fit("--outliers remove").exit_code, 0);
  const auto functions = nlohmann::json::parse(content(path("result/result.json"))).at("functions");
  const auto total = nlohmann::json::parse(judged(compare)).at("models")[0].at("total");
  const auto figures = nlohmann::json::parse(judged(validate));
  spoil();
  const auto run = fit("--outliers remove");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  expect_same_numbers(nlohmann::json::parse(content(path("result/result.json"))).at("functions"), functions);
  EXPECT_THAT(run.output, HasSubstr("setup \"" + name_ + "\" leaves out row 12: beam interrupted"));
  EXPECT_THAT(run.output, ::testing::ContainsRegex(name_ + " +12 .*left out"));
  EXPECT_THAT(run.output, ::testing::Not(HasSubstr("removed by the w-test")));
  EXPECT_THAT(content(path("result/residuals.csv")),
              ::testing::ContainsRegex(name_ + ",12,[^\n]*,length_mm,1\n"));
  expect_same_numbers(nlohmann::json::parse(judged(compare)).at("models")[0].at("total"), total);
  expect_same_numbers(nlohmann::json::parse(judged(validate)), figures);
}

/// Whichever of the two, fit and campaign, leaves it out.
TEST_F(LeaveOutProgram, IsNoReadingThatTheFitWasMadeFrom) {
  const std::string whole = content(path("campaign/campaign.toml"));
  const std::string validate =
      "validate " + path("result") + " " + path("campaign/campaign.toml") + " --json";
  const auto fitted = [&] { return nlohmann::json::parse(judged(validate)).at("fitted_readings"); };
  ASSERT_EQ(fit().exit_code, 0);
  const std::size_t all = fitted();
  leave_out();
  EXPECT_EQ(fitted(), all - 1);
  ASSERT_EQ(fit().exit_code, 0);
  EXPECT_EQ(fitted(), all - 1);
  std::ofstream(path("campaign/campaign.toml")) << whole;
  EXPECT_EQ(fitted(), all - 1);
  const auto run = run_program("validate " + path("result") + " " + path("campaign/campaign.toml"));
  EXPECT_THAT(run.output, HasSubstr(", without 1 that it left out; "));
  EXPECT_THAT(run.output, HasSubstr("Readings, some of which the fit was made from"));
}

TEST_F(LeaveOutProgram, IsNotTakenUpByADiagnosis) {
  leave_out();
  ASSERT_EQ(fit().exit_code, 0);
  const std::string diagnose = "diagnose " + path("campaign/campaign.toml") + " --model " +
                               path("model.toml") + " --json -o " + path("diagnosis");
  const std::string before = judged(diagnose);
  spoil();
  const auto sound = nlohmann::json::parse(before), spoilt = nlohmann::json::parse(judged(diagnose));
  EXPECT_TRUE(spoilt.at("removed_readings").empty());
  EXPECT_EQ(spoilt.at("verdict"), sound.at("verdict"));
  expect_same_numbers(spoilt.at("noise"), sound.at("noise"));
}

TEST_F(LeaveOutProgram, WithoutItTheFitComplains) {
  spoil();
  EXPECT_THAT(fit().output, HasSubstr("flagged by the w-test"));
}

}  // namespace
}  // namespace volcal
