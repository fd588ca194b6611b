/// The study of model criticism, small enough for every test run; docs/studies.md has the full one. Campaigns
/// with nothing hidden are diagnosed once for all tests that only need some.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

const Json& figure(const Json& study, const std::string& name) {
  const auto& figures = study.at("figures");
  const auto found =
      std::ranges::find_if(figures, [&](const Json& each) { return each.at("figure") == name; });
  if (found == figures.end()) throw std::out_of_range("no figure " + name);
  return *found;
}

std::string layout_of_listed() {
  return testing::short_or_long<std::string>("--seed 41 --readings 700", "--seed 40 --readings 1000");
}

/// Six campaigns for the night, of which two or more have a strong effect; one with a reversal in every run.
/// Made once.
const Json& listed_study() {
  static const Json study = [] {
    const auto run = run_program("study criticism --rows listed --json " +
                                 testing::short_or_long<std::string>("-n 1 ", "-n 6 ") + layout_of_listed());
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return Json::parse(run.output);
  }();
  return study;
}

TEST(CriticismStudy, NamesWhatIsTwentyTimesTheNoise) {
  int strong = 0;
  for (const auto& campaign : listed_study().at("campaigns")) {
    if (campaign.at("hidden")[0].at("signal").get<double>() < 11.9) continue;
    ++strong;
    // With two tools an offset of one is the opposite offset of the other, and nearly a load.
    EXPECT_THAT(campaign.at("outcome").get<std::string>(),
                ::testing::AnyOf(::testing::StartsWith("right"), ::testing::StartsWith("in a set of")))
        << campaign.dump(1);
    if (campaign.at("verdict") != "NAMED") continue;
    const double possible = campaign.at("ms_given").get<double>() - campaign.at("ms_oracle").get<double>();
    const double reached = campaign.at("ms_given").get<double>() - campaign.at("ms_named").get<double>();
    EXPECT_GT(reached, 0.8 * possible) << campaign.dump(1);
  }
  EXPECT_GE(strong, testing::short_or_long(1, 2));
}

/// A servo mismatch twenty times the noise, of which correlated drift of some seconds on the ball-bar leaves
/// so little that it is above the noise by chi-squared and not by F.
TEST(CriticismStudy, NamesWhatAShortDriftHasTakenUp) {
  VOLCAL_FOR_THE_NIGHT("Search.FindsWhatTheNoiseHasTakenUp, the same on a smaller campaign");
  const testing::ScratchFolder folder;
  const std::string output = (folder.path() / "kept").string();
  const auto kept = run_program("study criticism --one listed:97 --seed 1947 -o " + output);
  ASSERT_EQ(kept.exit_code, 0) << kept.errors;
  const auto run =
      run_program("diagnose " + output + "/campaign.toml -m " + output + "/model.toml --auto --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json diagnosis = Json::parse(run.output);
  EXPECT_EQ(diagnosis.at("verdict"), "NAMED");
  ASSERT_EQ(diagnosis.at("effects").size(), 1U);
  EXPECT_EQ(diagnosis.at("effects")[0].at("kind"), "servo-mismatch");
}

void expect_no_wrong_name(const Json& campaign) {
  if (campaign.at("row") == "null") {
    EXPECT_THAT(campaign.at("verdict"), ::testing::AnyOf("NOTHING_ABOVE", "NOT_VISIBLE")) << campaign;
  }
  EXPECT_EQ(campaign.at("failure"), "");
  EXPECT_NE(campaign.at("outcome"), "wrong name") << campaign;
  for (const auto& hidden : campaign.at("hidden")) {
    EXPECT_GE(hidden.at("signal").get<double>(), 4.99);
    EXPECT_NE(hidden.at("right"), "");
  }
}

/// One campaign for a closer look is the one that the study counts.
TEST(CriticismStudy, WritesOneCampaign) {
  const testing::ScratchFolder scratch;
  const std::string one = (scratch.path() / "one").string();
  const auto written = run_program("study criticism --one listed:0 " + layout_of_listed() + " -o " + one);
  ASSERT_EQ(written.exit_code, 0) << written.errors;
  EXPECT_THAT(written.output, HasSubstr("volcal diagnose"));
  const Json hidden = Json::parse(content(std::filesystem::path(one) / "truth" / "hidden.json"));
  const Json& record = listed_study().at("campaigns").at(0);
  expect_no_wrong_name(record);
  EXPECT_NEAR(record.at("hidden").at(0).at("rms_um").get<double>(),
              hidden.at("effects").at(0).at("rms_um").get<double>(), 1e-3);
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(one) / "campaign.toml"));
  for (const char* wrong : {"listed", "listed:x", "gremlins:1", "listed:-1"}) {
    const auto refused = run_program(std::string("study criticism --one ") + wrong + " -o " + one);
    EXPECT_EQ(refused.exit_code, 2) << wrong;
    EXPECT_THAT(refused.errors, HasSubstr("listed:11")) << wrong;
  }
  const auto nowhere = run_program("study criticism --one listed:0");
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.errors, HasSubstr("-o FOLDER"));
}

/// A backlash that is named and falls, and a campaign with nothing hidden, which has no share.
TEST(CriticismStudy, CountsWhatTheOfferedModelRemovesOfADataset) {
  const std::string sealed = std::string(VOLCAL_SOURCE_DIR) + "/datasets/hidden/sealed";
  const std::string campaigns = testing::short_or_long<std::string>("02", "02,04");
  const auto run = run_program("study hidden " + sealed + " --json --campaign " + campaigns);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json study = Json::parse(run.output);
  const Json& nothing = study.at("campaigns").at(0);
  EXPECT_EQ(nothing.at("verdict"), "NOTHING_ABOVE");
  EXPECT_TRUE(nothing.at("removed").is_null());
  EXPECT_EQ(nothing.at("signal"), 0.0);
  EXPECT_TRUE(nothing.at("rules_decided").is_array());
  EXPECT_NEAR(nothing.at("given_um").get<double>(), nothing.at("nothing_hidden_um").get<double>(), 1e-9);
  if (testing::long_tests()) {
    const Json& backlash = study.at("campaigns").at(1);
    EXPECT_GT(backlash.at("removed").get<double>(), 0.9);
    EXPECT_THAT(backlash.at("rules_decided"), ::testing::Contains("estimated-noise"));
    EXPECT_LT(backlash.at("offered_um").get<double>(), backlash.at("given_um").get<double>());
  }
  for (const auto& [arguments, part] :
       {std::pair<std::string, std::string>{sealed + " --campaign 99", "holds no 99.toml"},
        {std::string(VOLCAL_SOURCE_DIR) + "/docs", "holds no study files"}}) {
    const auto refused = run_program("study hidden " + arguments);
    EXPECT_EQ(refused.exit_code, 2) << arguments;
    EXPECT_THAT(refused.errors, HasSubstr(part)) << arguments;
  }
}

class CriticismStudyFolder : public ::testing::Test {
 protected:
  /// A study of five campaigns with nothing hidden, by one thread.
  static const testing::ProgramRun& nothing_hidden() {
    static const testing::ProgramRun run = run_program(
        "study criticism --rows null --readings 400 -n 1 --json --threads 1 -o " + nothing_kept());
    return run;
  }
  static std::string nothing_kept() {
    static const testing::ScratchFolder folder;
    return (folder.path() / "kept").string();
  }
  static testing::ProgramRun study(const std::string& arguments) {
    return run_program("study criticism --rows null --readings 400 " + arguments);
  }
  /// As if the study had been made by this test.
  void copy_nothing_hidden() const {
    ASSERT_EQ(nothing_hidden().exit_code, 0) << nothing_hidden().errors;
    std::filesystem::copy(nothing_kept(), output_, std::filesystem::copy_options::recursive);
  }
  std::vector<Json> kept() const {
    std::vector<Json> records;
    std::istringstream lines(content(file_));
    for (std::string line; std::getline(lines, line);) records.push_back(Json::parse(line));
    return records;
  }
  void keep(const std::vector<Json>& records) const {
    std::ofstream file(file_, std::ios::trunc);
    for (const Json& record : records) file << record.dump() << '\n';
  }

  testing::ScratchFolder scratch_;
  std::string output_ = (scratch_.path() / "kept").string();
  std::filesystem::path file_ = std::filesystem::path(output_) / "campaigns.jsonl";
};

TEST_F(CriticismStudyFolder, SaysNothingOfNothing) {
  ASSERT_EQ(nothing_hidden().exit_code, 0) << nothing_hidden().errors;
  const Json study = Json::parse(nothing_hidden().output);
  ASSERT_EQ(study.at("campaigns").size(), 5U);
  for (const auto& campaign : study.at("campaigns")) {
    expect_no_wrong_name(campaign);
    EXPECT_NEAR(campaign.at("readings").get<double>(), 400.0, 300.0);
  }
  EXPECT_EQ(figure(study, "false alarm, nothing hidden").at("count"), 0);
}

/// For the night.
TEST(CriticismStudy, SaysNothingOfNothingAndNamesNoWrongEffect) {
  if (!testing::long_tests()) GTEST_SKIP() << "VOLCAL_LONG_TESTS=1 runs it";
  const auto run = run_program("study criticism --rows null,listed -n 1 --seed 1 --readings 700 --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json study = Json::parse(run.output);
  ASSERT_EQ(study.at("campaigns").size(), 6U);
  for (const auto& campaign : study.at("campaigns")) {
    expect_no_wrong_name(campaign);
    EXPECT_NEAR(campaign.at("readings").get<double>(), 700.0, 300.0);
  }
  EXPECT_EQ(figure(study, "false alarm, nothing hidden").at("count"), 0);
  EXPECT_EQ(figure(study, "wrong confident name, any s").at("of"), 1);
}

/// Two of the campaigns of nothing_hidden(); for the night, campaigns with an effect.
TEST_F(CriticismStudyFolder, DoesNotDependOnTheNumberOfThreads) {
  if (testing::long_tests()) {
    const std::string command = "study criticism --rows listed -n 2 --readings 400 --json --threads ";
    EXPECT_EQ(run_program(command + "1").output, run_program(command + "2").output);
  }
  copy_nothing_hidden();
  std::vector<Json> records = kept();
  ASSERT_EQ(records.size(), 5U);
  keep({records[0], records[1], records[3]});
  const auto two = study("-n 1 --json --resume --threads 2 -o " + output_);
  ASSERT_EQ(two.exit_code, 0) << two.errors;
  EXPECT_EQ(two.output, nothing_hidden().output);
}

TEST_F(CriticismStudyFolder, GoesOnWhereItWasInterrupted) {
  copy_nothing_hidden();
  const std::vector<Json> records = kept();
  ASSERT_EQ(records.size(), 5U);
  // Of one half a line was written.
  keep({records[0], records[2], records[3], records[4]});
  std::ofstream(file_, std::ios::app) << records[1].dump().substr(0, 200);
  const auto resumed = study("-n 1 --json --resume -o " + output_);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_EQ(resumed.output, nothing_hidden().output);
  EXPECT_EQ(kept().size(), 5U);
}

TEST_F(CriticismStudyFolder, RefusesCampaignsOfAnotherRun) {
  copy_nothing_hidden();
  const auto again = study("-n 1 -o " + output_);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("--resume"));
  const auto seed = study("-n 1 --resume --seed 2 -o " + output_);
  EXPECT_EQ(seed.exit_code, 2);
  EXPECT_THAT(seed.errors, HasSubstr("--seed 1"));
  std::ofstream(file_, std::ios::app) << "{\"row\": 1}\n";
  const auto damaged = study("-n 1 --resume -o " + output_);
  EXPECT_EQ(damaged.exit_code, 2);
  EXPECT_THAT(damaged.errors, HasSubstr("campaigns.jsonl:6"));
  const auto row = run_program("study criticism --rows gremlins");
  EXPECT_EQ(row.exit_code, 2);
  EXPECT_THAT(row.errors, HasSubstr("gremlins"));
}

TEST_F(CriticismStudyFolder, CountsFalseAlarmsWithWilsonIntervals) {
  copy_nothing_hidden();
  std::vector<Json> records = kept();
  const Json alarm = Json::parse(R"({"name": "reversal:EXX:dir_x:step", "hidden": -1, "by_name": false,
      "resolution": false, "scanned": false, "explains": 0.0, "log10_p": -4.0, "gain": 9.0, "amplitudes": []})");
  records[3]["verdict"] = "NAMED";
  records[3]["named"] = Json::array({alarm});
  keep(records);
  const auto counted = study("-n 1 --json --resume -o " + output_);
  ASSERT_EQ(counted.exit_code, 0) << counted.errors;
  const Json total = figure(Json::parse(counted.output), "false alarm, nothing hidden");
  EXPECT_EQ(total.at("count"), 1);
  EXPECT_EQ(total.at("of"), 5);
  // (p + z2/2n -+ z sqrt(p (1 - p) / n + z2/4n2)) / (1 + z2/n) with p = 0.2, n = 5, z = 1.96
  EXPECT_NEAR(total.at("low95").get<double>(), 0.0362, 1e-4);
  EXPECT_NEAR(total.at("high95").get<double>(), 0.6245, 1e-4);
  EXPECT_THAT(study("-n 1 --resume -o " + output_).output, HasSubstr("wrong name: reversal"));
}

/// Of two hidden effects one is named; the other stands in a set.
TEST_F(CriticismStudyFolder, CountsWhatIsFoundOfTwo) {
  copy_nothing_hidden();
  const auto hidden = [](const char* name) {
    return Json{{"text", name},
                {"right", name},
                {"signal", 12.0},
                {"visible_fraction", 1},
                {"rms_um", 1.0},
                {"drivers", Json::array()},
                {"companions", Json::array()},
                {"directions", Json::array()}};
  };
  const auto answer = [](const std::string& name, int of, double gain) {
    return Json{{"name", name},        {"hidden", of},     {"by_name", of >= 0},
                {"resolution", false}, {"scanned", false}, {"explains", 1.0},
                {"log10_p", -20.0},    {"gain", gain},     {"amplitudes", Json::array()}};
  };
  Json pair = kept().at(0);
  pair["row"] = "pairs";
  pair["index"] = 0;
  pair["hidden"] = {hidden("a"), hidden("b")};
  pair["verdict"] = "NAMED_MORE_REMAINS";
  pair["named"] = Json::array({answer("a", 0, 100.0)});
  const auto outcome = [&](const std::vector<Json>& set) {
    pair["sets"] = Json::array({set});
    keep({pair});
    const auto counted =
        run_program("study criticism --rows pairs -n 1 --readings 400 --json --resume -o " + output_);
    EXPECT_EQ(counted.exit_code, 0) << counted.errors;
    return Json::parse(counted.output).at("campaigns").at(0).at("outcome").get<std::string>();
  };
  const Json b = answer("b", 1, 90.0), twin = answer("b2", 1, 90.0), other = answer("c", -1, 88.0);
  EXPECT_EQ(outcome({b, other}), "right, in a set of up to 3");
  EXPECT_EQ(outcome({b, twin, twin, other}), "right, in a set of up to 3 that differ");
  EXPECT_EQ(outcome({b, other, answer("d", -1, 87.0), answer("e", -1, 86.0)}), "in a set of over 3");
  EXPECT_EQ(outcome({other, other}), "right, more remains");
  pair["unknown"] = Json::array({{{"variables", {"x"}}, {"direction", "X"}, {"log10_p", -4.0}}});
  EXPECT_EQ(outcome({b, other}), "right, more remains");
}

}  // namespace
}  // namespace volcal
