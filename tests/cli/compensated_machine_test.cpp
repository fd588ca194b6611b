/// Measure, identify, compensate, measure again, superimpose: the program on a machine that applies its
/// tables.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "tests/support/program.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

class CompensatedCampaign : public ::testing::Test {
 protected:
  void SetUp() override {
    simulated_.simulate(8,
                        "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [6, 5, 5]\n"
                        "[validation]\npoints = 60\n",
                        3, 6);
    ASSERT_EQ(simulated_.fit("--noise white").exit_code, 0);
  }
  std::string path(const std::string& name) const { return simulated_.path(name); }
  void run(const std::string& command) const {
    const auto run = run_program(command);
    ASSERT_EQ(run.exit_code, 0) << command << "\n" << run.errors;
  }
  /// RMS of the volumetric error of a campaign's machine at its fresh points, um.
  double volumetric_rms(const std::string& campaign) const {
    const auto run =
        run_program("validate " + path("result") + " " + path(campaign) + "/truth/campaign.toml --json");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return nlohmann::json::parse(run.output).at("rms_before_um");
  }

  /// Simulates the machine again with the result's tables active.
  void measure_with_tables(const std::string& tables, const std::string& campaign) const {
    run("tables " + path("result") + " --format neutral-csv -o " + path(tables));
    run("simulate " + path("study.toml") + " --compensation " + path(tables) + " -o " + path(campaign));
  }
  nlohmann::json validated(const std::string& result, const std::string& campaign,
                           const std::string& options) const {
    const auto run = run_program("validate " + path(result) + " " + path(campaign) + " --json " + options);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return nlohmann::json::parse(run.output);
  }

  testing::SimulatedCampaign simulated_;
};

/// A campaign file with the guess of every station moved by as much along X, Y and Z.
std::string with_moved_guesses(const std::string& campaign, double millimetres) {
  const std::regex station(R"(station_mm = \[([^,]+), ([^,]+), ([^\]]+)\])");
  std::string text;
  auto rest = campaign.cbegin();
  for (std::sregex_iterator found(campaign.begin(), campaign.end(), station), end; found != end; ++found) {
    text.append(rest, (*found)[0].first).append("station_mm = [");
    for (const std::size_t k : {1U, 2U, 3U})
      text += std::to_string(std::stod((*found)[k]) + millimetres) + (k < 3 ? ", " : "]");
    rest = (*found)[0].second;
  }
  return text.append(rest, campaign.cend());
}

TEST_F(CompensatedCampaign, IsMeasuredAgainIdentifiedAndSuperimposed) {
  run("tables " + path("result") + " --format neutral-csv --type L-POS -o " + path("positioning"));
  run("simulate " + path("study.toml") + " --compensation " + path("positioning") + " -o " + path("second"));
  EXPECT_THAT(content(path("second/campaign.toml")),
              HasSubstr("active_compensations = \"neutral-csv tables of"));
  EXPECT_LT(volumetric_rms("second"), 0.98 * volumetric_rms("campaign"));

  run("fit " + path("second/campaign.toml") + " --model " + path("model.toml") + " --noise white -o " +
      path("result-2"));
  run("tables " + path("result-2") + " -o " + path("native"));
  EXPECT_THAT(content(path("native/metadata.csv")), HasSubstr("active_compensations,neutral-csv tables of"));

  const auto refused =
      run_program("tables " + path("result-2") + " --format neutral-csv --type L-STR --superimpose " +
                  path("positioning") + " -o " + path("volume"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("L-STR does not hold"));
  const auto native = run_program("tables " + path("result-2") + " --superimpose " + path("positioning") +
                                  " -o " + path("volume"));
  EXPECT_EQ(native.exit_code, 2);
  EXPECT_THAT(native.errors, HasSubstr("csv cannot be superimposed"));

  run("tables " + path("result-2") + " --format neutral-csv --superimpose " + path("positioning") + " -o " +
      path("volume"));
  run("simulate " + path("study.toml") + " --compensation " + path("volume") + " -o " + path("third"));
  EXPECT_LT(volumetric_rms("third"), 1.0);
}

TEST_F(CompensatedCampaign, ShowsStepsAndAWrongTool) {
  run("tables " + path("result") + " --format linuxcnc-grid -o " + path("tables"));
  run("simulate " + path("study.toml") + " --compensation " + path("tables") + " -o " + path("after"));
  run("simulate " + path("study.toml") + " --compensation " + path("tables") + " --least-increment 5 -o " +
      path("steps"));
  run("simulate " + path("study.toml") + " --compensation " + path("tables") + " --wrong-tool-length 90 -o " +
      path("tool"));
  const double after = volumetric_rms("after");
  EXPECT_LT(after, 1.0);
  // Each component is off by up to half a step, uniformly: 5 um / sqrt(12) of each, sqrt(3) of all.
  EXPECT_NEAR(volumetric_rms("steps"), std::hypot(after, 2.5), 0.5);
  EXPECT_GT(volumetric_rms("tool"), 1.2 * after);
  EXPECT_THAT(content(path("steps/campaign.toml")), HasSubstr("least increment 5 um"));
}

TEST_F(CompensatedCampaign, IsAskedForByTheStudyToo) {
  run("tables " + path("result") + " --format sinumerik -o " + path("tables"));
  run("simulate " + path("study.toml") + " --compensation " + path("tables") + " -o " + path("by-option"));
  std::ofstream(path("study.toml"), std::ios::app) << "[compensation]\ntables = \"tables\"\n";
  run("simulate " + path("study.toml") + " -o " + path("by-study"));
  int readings = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("by-option"))) {
    if (entry.path().extension() != ".csv") continue;
    const std::string file = std::filesystem::relative(entry.path(), path("by-option")).string();
    EXPECT_EQ(content(path("by-option/" + file)), content(path("by-study/" + file))) << file;
    ++readings;
  }
  EXPECT_GT(readings, 1);
  EXPECT_NEAR(volumetric_rms("by-option"), volumetric_rms("by-study"), 1e-9);
  const auto missing =
      run_program("simulate " + path("study.toml") + " --compensation " + path("none") + " -o " + path("x"));
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.errors, HasSubstr("there is no such folder"));
  const auto foreign = run_program("simulate " + path("study.toml") + " --compensation " + path("result") +
                                   " -o " + path("x"));
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.errors, HasSubstr("holds no tables"));
}

TEST_F(CompensatedCampaign, IsJudgedAlikeWhereverItsStationsWereGuessed) {
  measure_with_tables("tables", "after");
  const std::string campaign = content(path("after/campaign.toml"));
  std::ofstream(path("after/moved.toml")) << with_moved_guesses(campaign, 60.0);
  ASSERT_NE(content(path("after/moved.toml")), campaign);
  const auto near = validated("result", "after/campaign.toml", "--tables " + path("tables"));
  const auto far = validated("result", "after/moved.toml", "--tables " + path("tables"));
  EXPECT_LT(near.at("reduced_chi2").get<double>(), 1.3);
  for (const char* figure : {"rms_before_um", "rms_after_um", "max_after_um", "reduced_chi2"})
    EXPECT_NEAR(far.at(figure).get<double>(), near.at(figure).get<double>(), 0.002) << figure;
}

/// Codes of what `validate` has noticed.
std::set<std::string> codes_of(const nlohmann::json& figures) {
  std::set<std::string> codes;
  for (const auto& finding : figures.value("notes_findings", nlohmann::json::array()))
    codes.insert(finding.at("code").get<std::string>());
  return codes;
}

TEST_F(CompensatedCampaign, IsNotTakenForOneWithoutTables) {
  measure_with_tables("tables", "after");
  const std::string differ = "compensation.active-differ", unstated = "compensation.active-unstated";
  EXPECT_EQ(codes_of(validated("result", "after/campaign.toml", "")).count(differ), 1U);
  EXPECT_EQ(codes_of(validated("result", "after/truth/campaign.toml", "")).count(differ), 1U);
  EXPECT_EQ(codes_of(validated("result", "campaign/truth/campaign.toml", "")).count(differ), 0U);
  const auto stated = codes_of(validated("result", "after/campaign.toml", "--tables " + path("tables")));
  EXPECT_EQ(stated.count(differ) + stated.count(unstated), 0U);

  const std::string campaign = content(path("after/campaign.toml"));
  const std::regex statement("active_compensations = [^\n]*\n");
  for (const char* instead : {"", "active_compensations = \"none\"\n"}) {
    std::ofstream(path("after/other.toml")) << std::regex_replace(campaign, statement, instead);
    const auto codes = codes_of(validated("result", "after/other.toml", "--tables " + path("tables")));
    EXPECT_EQ(codes.count(unstated), 1U) << instead;
    EXPECT_EQ(codes_of(validated("result", "after/other.toml", "")).count(differ), 0U) << instead;
  }
}

/// Errors identified with tables active, judged with those that were superimposed on them: what the former
/// tables corrected stays in.
TEST_F(CompensatedCampaign, IsJudgedByErrorsThatWereIdentifiedWithTheFormerTables) {
  run("tables " + path("result") + " --format neutral-csv --type L-POS -o " + path("former"));
  run("simulate " + path("study.toml") + " --compensation " + path("former") + " -o " + path("second"));
  run("fit " + path("second/campaign.toml") + " --model " + path("model.toml") + " --noise white -o " +
      path("result-2"));
  for (const std::string format : {"neutral-csv", "linuxcnc-grid"}) {
    run("tables " + path("result-2") + " --format " + format + " --superimpose " + path("former") + " -o " +
        path(format));
    run("simulate " + path("study.toml") + " --compensation " + path(format) + " -o " + path("third"));
    const std::string tables = "--tables " + path(format);
    const auto by_second = validated("result-2", "third/campaign.toml", tables);
    const auto by_first = validated("result", "third/campaign.toml", tables);
    EXPECT_EQ(codes_of(by_second).count("compensation.active-in-tables"), 0U) << format;
    EXPECT_LT(by_second.at("reduced_chi2").get<double>(), 1.3) << format;
    EXPECT_LT(by_first.at("reduced_chi2").get<double>(), 1.3) << format;
    EXPECT_LT(by_second.at("rms_before_um").get<double>(), 0.98 * by_first.at("rms_before_um").get<double>())
        << "the machine with the former tables errs by less";
    std::filesystem::remove_all(path(format) + "/superimposed_on");
    const auto unknown = validated("result-2", "third/campaign.toml", tables);
    EXPECT_EQ(codes_of(unknown).count("compensation.active-in-tables"), 1U) << format;
    EXPECT_GT(unknown.at("reduced_chi2").get<double>(), 2.0) << format;
  }
}

/// Tables that say that they are superimposed on none stand beside what was active.
TEST_F(CompensatedCampaign, TablesBesideACompensationAreNotDoubtful) {
  measure_with_tables("control", "second");
  run("fit " + path("second/campaign.toml") + " --model " + path("model.toml") + " --noise white -o " +
      path("result-2"));
  run("tables " + path("result-2") + " --format csv -o " + path("beside"));
  EXPECT_THAT(content(path("beside/metadata.csv")), HasSubstr("superimposed_on,none\n"));
  const auto judged = validated("result-2", "second/campaign.toml", "--tables " + path("beside"));
  EXPECT_EQ(codes_of(judged).count("compensation.active-in-tables"), 0U);
}

/// Whether tables stand in place of those that were active or beside them, words alone do not tell.
TEST_F(CompensatedCampaign, OfErrorsIdentifiedWithTablesIsDoubtfulWithSuperimposedOnes) {
  measure_with_tables("tables", "second");
  run("fit " + path("second/campaign.toml") + " --model " + path("model.toml") + " --noise white -o " +
      path("result-2"));
  const auto doubtful = codes_of(validated("result-2", "second/campaign.toml", "--tables " + path("tables")));
  EXPECT_EQ(doubtful.count("compensation.active-in-tables"), 1U);
  const std::string differ = "compensation.active-differ";
  EXPECT_EQ(codes_of(validated("result-2", "second/truth/campaign.toml", "")).count(differ), 0U);
  EXPECT_EQ(codes_of(validated("result-2", "campaign/truth/campaign.toml", "")).count(differ), 1U);
}

/// docs/studies.md has all formats on full campaigns.
TEST(CompensationStudy, EveryFormatLeavesWhatItsIdealLeaves) {
  const auto run = run_program("study compensation -n 1 --seed 5 --small --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  const auto& summary = json.at("summary");
  EXPECT_GE(summary.at("least_before_um").get<double>(), 15.0);
  EXPECT_LE(summary.at("worst_ratio").get<double>(), 1.2);
  EXPECT_LE(summary.at("volumetric_left_um").get<double>(), 1.0);
  std::set<std::string> formats;
  for (const auto& row : json.at("rows")) {
    formats.insert(row.at("format").get<std::string>());
    if (!row.contains("read_after_um")) continue;
    EXPECT_LT(row.at("read_after_um").get<double>(), row.at("read_before_um").get<double>()) << row.dump();
  }
  EXPECT_EQ(formats.size(), 13U);
}

TEST(CompensationStudy, DoesNotDependOnTheNumberOfThreads) {
  const std::string study = "study compensation -n 2 --small --format sinumerik --json --threads ";
  const auto one = run_program(study + "1");
  ASSERT_EQ(one.exit_code, 0) << one.errors;
  EXPECT_EQ(one.output, run_program(study + "2").output);
}

}  // namespace
}  // namespace volcal
