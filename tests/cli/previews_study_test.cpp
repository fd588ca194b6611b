// The study of linear previews, small enough for every test run; docs/studies.md has the full one.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using testing::content;
using testing::run_program;

class PreviewsStudy : public ::testing::Test {
 protected:
  static std::string command(const std::string& more) {
    return "study previews --rows listed --seed 41 --readings 700 --most 2 --threads 2 --json " +
           testing::short_or_long<std::string>("-n 3 ", "-n 20 ") + more;
  }
};

TEST_F(PreviewsStudy, CountsPreviewsThatHoldAndThoseThatTheSessionNames) {
  const testing::ScratchFolder folder;
  const auto run = run_program(command("-o " + (folder.path() / "kept").string()));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json study = Json::parse(run.output);
  int held = 0, refits = 0, all = 0, said = 0;
  for (const Json& campaign : study["campaigns"]) {
    if (!campaign.contains("previews")) continue;
    for (const Json& preview : campaign["previews"]) {
      const bool holds = preview["refit_miss"].get<double>() < 0.25;
      ++all;
      held += preview["miss"].get<double>() < 0.25 ? 1 : 0;
      refits += holds ? 1 : 0;
      said += preview["said"].get<bool>() ? 1 : 0;
      EXPECT_EQ(preview["said"].get<bool>(), !holds) << preview.dump();
      EXPECT_LT(preview["miss"].get<double>(), 2.0) << "a preview is of the size of the full fit";
      EXPECT_LT(preview["refit_miss"].get<double>(), 1.0) << preview.dump();
    }
  }
  ASSERT_GE(all, testing::short_or_long(1, 10)) << "something is hidden in these campaigns";
  EXPECT_EQ(study["held"]["count"], held);
  EXPECT_EQ(study["held"]["of"], all);
  EXPECT_EQ(study["refits_held"]["count"], refits);
  EXPECT_EQ(study["misses_said"]["of"], all - refits);
  EXPECT_EQ(study["misses_said"]["count"], said);
}

TEST_F(PreviewsStudy, GoesOnBehindItsLastCampaign) {
  const testing::ScratchFolder folder;
  const std::string kept = (folder.path() / "kept").string();
  const std::string small =
      "study previews --rows null -n 2 --seed 5 --readings 500 --most 1 --json -o " + kept;
  const auto first = run_program(small);
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(run_program(small).exit_code, 2) << "campaigns of an earlier run are not overwritten";
  const std::filesystem::path archive = std::filesystem::path(kept) / "previews.jsonl";
  const std::string lines = content(archive);
  std::ofstream(archive) << lines.substr(0, lines.find('\n') + 1) << "{\"campaign\": \"null:1\", \"se";
  const auto resumed = run_program(small + " --resume");
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  EXPECT_EQ(Json::parse(resumed.output), Json::parse(first.output));
  EXPECT_EQ(content(archive), lines);
  const auto other =
      run_program("study previews --rows null -n 2 --seed 6 --readings 500 --resume -o " + kept);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.errors.find("--seed 5"), std::string::npos) << other.errors;
}

}  // namespace
}  // namespace volcal
