/// The user's way through datasets/hidden, campaign by campaign: fit, compare, diagnose, extend, fit again,
/// and only then the sealed answer. What is asked of an answer stands in sealed/answers.json.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/support/dataset_files.h"
#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::content;
using testing::run_program;

const fs::path kHiddenCampaigns = fs::path(VOLCAL_SOURCE_DIR) / "datasets" / "hidden";

const Json& answers() {
  static const Json all = Json::parse(content(kHiddenCampaigns / "sealed" / "answers.json"));
  return all;
}

std::vector<std::string> campaigns() {
  std::vector<std::string> names;
  for (const auto& [name, answer] : answers().items()) names.push_back(name);
  return names;
}

std::set<std::string> names_of(const Json& findings) {
  std::set<std::string> names;
  for (const auto& each : findings) {
    names.insert(each.at("kind").get<std::string>() + ":" + each.at("target").get<std::string>() + ":" +
                 each.at("driver").get<std::string>());
  }
  return names;
}

class HiddenCampaign : public ::testing::TestWithParam<std::string> {
 protected:
  const Json& answer() const { return answers().at(GetParam()); }
  std::string campaign() const { return (kHiddenCampaigns / GetParam() / "campaign.toml").string(); }
  std::string in_scratch(const std::string& name) const { return (scratch_.path() / name).string(); }

  /// Exit code 1 = a result with a warning: rank deficient, lack of fit.
  std::string done(const std::string& arguments) const {
    const auto run = run_program(arguments);
    EXPECT_LE(run.exit_code, 1) << arguments << "\n" << run.errors;
    return run.output;
  }

  /// Root mean square over noise-free readings at positions that were not measured, um.
  double unseen_error(const std::string& result) const {
    const Json compared = Json::parse(
        done("compare " + in_scratch("truth/truth/unseen/campaign.toml") + " " + result + " --json"));
    return compared.at("models").at(0).at("total").at("lengths_um").at("rms").get<double>();
  }

  testing::ScratchFolder scratch_;
};

TEST_P(HiddenCampaign, IsWhatItsSealedStudyMakes) {
  done("simulate " + (kHiddenCampaigns / "sealed" / (GetParam() + ".toml")).string() + " -o " +
       in_scratch("made"));
  for (const std::string& name : testing::files_below(kHiddenCampaigns / GetParam())) {
    testing::expect_same_numbers(name, content(kHiddenCampaigns / GetParam() / name),
                                 content(scratch_.path() / "made" / name));
  }
}

/// A few of them always; all with VOLCAL_LONG_TESTS=1.
TEST_P(HiddenCampaign, IsDiagnosedAndItsErrorFalls) {
  if (!answer().at("quick").get<bool>() && !testing::long_tests()) {
    GTEST_SKIP() << "VOLCAL_LONG_TESTS=1 runs all";
  }
  if (answer().contains("open")) GTEST_SKIP() << "open: " << answer().at("open");
  done("fit " + campaign() + " -o " + in_scratch("given"));
  EXPECT_THAT(done("compare " + campaign() + " " + in_scratch("given")), ::testing::HasSubstr("chi2/dof"));
  const Json diagnosis =
      Json::parse(done("diagnose " + campaign() + " --auto --json -o " + in_scratch("diagnosis")));
  const auto verdict = diagnosis.at("verdict").get<std::string>();
  EXPECT_THAT(answer().at("verdicts").get<std::vector<std::string>>(), ::testing::Contains(verdict));

  const std::set<std::string> named = names_of(diagnosis.at("effects"));
  const auto right = answer().at("effects").get<std::set<std::string>>();
  for (const std::string& name : named) EXPECT_THAT(right, ::testing::Contains(name)) << "a wrong name";
  if (verdict == "NAMED") {
    EXPECT_EQ(named.size(), answer().at("count").get<std::size_t>());
  }
  if (verdict == "ONE_OF") {
    const std::set<std::string> set = names_of(diagnosis.at("one_of"));
    EXPECT_TRUE(std::ranges::any_of(set, [&](const auto& name) { return right.contains(name); }))
        << ::testing::PrintToString(set);
  }
  if (verdict == "UNKNOWN") {
    const Json& unknown = diagnosis.at("unknown").at(0);
    const auto variables = answer().at("variables").get<std::set<std::string>>();
    EXPECT_TRUE(std::ranges::any_of(unknown.at("variables").get<std::vector<std::string>>(),
                                    [&](const auto& name) { return variables.contains(name); }))
        << unknown;
  }
  if (named.empty() && diagnosis.at("surfaces").empty() && diagnosis.at("one_of").empty()) return;

  done("fit " + campaign() + " --model " + in_scratch("diagnosis/extended.toml") + " -o " +
       in_scratch("extended"));
  done("simulate " + (kHiddenCampaigns / "sealed" / (GetParam() + ".toml")).string() + " -o " +
       in_scratch("truth"));
  const double before = unseen_error(in_scratch("given")), after = unseen_error(in_scratch("extended"));
  const bool alternatives_alone = named.empty() && diagnosis.at("surfaces").empty();
  EXPECT_LT(after, (alternatives_alone ? 1.02 : answer().value("share", 0.8)) * before)
      << "the simplest of a set may be another one, and must not harm";
  const Json& ladder = diagnosis.at("ladder");
  EXPECT_LT(ladder.back().at("rms_heldout_um").get<double>(),
            1.01 * ladder.front().at("rms_heldout_um").get<double>());
  RecordProperty("unseen", fmt::format("{:.3f} -> {:.3f} um", before, after));
}

INSTANTIATE_TEST_SUITE_P(All, HiddenCampaign, ::testing::ValuesIn(campaigns()),
                         [](const auto& each) { return "N" + each.param; });

}  // namespace
}  // namespace volcal
