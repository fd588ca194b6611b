/// Every broken campaign through the program, as a user meets it: exit code 2, nothing on standard output,
/// one line on standard error that names file, line, problem and remedy, and no result folder.

#include "tests/support/broken_campaigns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::BrokenCampaign;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

testing::ProgramRun run_fit(const fs::path& folder, const fs::path& scratch) {
  return testing::run_program("fit " + (folder / "campaign.toml").string() + " --model " +
                              (folder / "model.toml").string() + " -o " + (scratch / "result").string());
}

class ProgramRefuses : public ::testing::TestWithParam<BrokenCampaign> {};

TEST_P(ProgramRefuses, WithExitCode2AndAMessage) {
  const BrokenCampaign& broken = GetParam();
  const testing::ScratchFolder scratch;
  const fs::path folder = scratch.path() / "campaign";
  fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "tests/data/small", folder);
  testing::break_campaign(broken, folder);
  const testing::ProgramRun run = run_fit(folder, scratch.path());
  EXPECT_EQ(run.exit_code, 2) << run.errors;
  EXPECT_THAT(run.output, IsEmpty());
  const std::string place =
      (folder / broken.place).string() + (broken.line > 0 ? ":" + std::to_string(broken.line) : "");
  EXPECT_THAT(run.errors, HasSubstr(place + ": "));
  EXPECT_THAT(run.errors, HasSubstr(broken.problem));
  EXPECT_THAT(run.errors, HasSubstr(broken.remedy));
  EXPECT_FALSE(fs::exists(scratch.path() / "result"));
}

INSTANTIATE_TEST_SUITE_P(All, ProgramRefuses, ::testing::ValuesIn(testing::broken_campaigns()),
                         [](const auto& test) { return test.param.name; });

TEST(Program, DoesNotReplaceAForeignFolder) {
  const testing::ScratchFolder scratch;
  fs::create_directory(scratch.path() / "result");
  testing::spill(scratch.path() / "result" / "thesis.txt", "years of work");
  const testing::ProgramRun run = run_fit(fs::path(VOLCAL_SOURCE_DIR) / "tests/data/small", scratch.path());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("holds files that volcal did not write"));
  EXPECT_EQ(testing::slurp(scratch.path() / "result" / "thesis.txt"), "years of work");
}

}  // namespace
}  // namespace volcal
