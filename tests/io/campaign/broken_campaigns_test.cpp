#include "tests/support/broken_campaigns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <set>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::BrokenCampaign;
using ::testing::HasSubstr;

/// What the readers say about a campaign and its model; nothing when they accept both.
std::optional<InputError> refusal_of(const fs::path& folder) {
  try {
    const Campaign campaign = read_campaign((folder / "campaign.toml").string());
    read_model((folder / "model.toml").string(), campaign.machine);
  } catch (const InputError& error) {
    return error;
  }
  return std::nullopt;
}

fs::path copy_of_good_campaign(const testing::ScratchFolder& scratch) {
  fs::path folder = scratch.path() / "campaign";
  fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "tests/data/small", folder);
  return folder;
}

class BrokenCampaignTest : public ::testing::TestWithParam<BrokenCampaign> {};

TEST_P(BrokenCampaignTest, IsRefusedWithPlaceProblemAndRemedy) {
  const BrokenCampaign& broken = GetParam();
  const testing::ScratchFolder scratch;
  const fs::path folder = copy_of_good_campaign(scratch);
  testing::break_campaign(broken, folder);
  const auto error = refusal_of(folder);
  ASSERT_TRUE(error.has_value()) << "the campaign was accepted";
  EXPECT_EQ(fs::path(error->place().file).filename().string(), broken.place) << error->what();
  EXPECT_EQ(error->place().line, broken.line) << error->what();
  EXPECT_THAT(error->problem(), HasSubstr(broken.problem));
  EXPECT_THAT(error->remedy(), HasSubstr(broken.remedy));
}

INSTANTIATE_TEST_SUITE_P(All, BrokenCampaignTest, ::testing::ValuesIn(testing::broken_campaigns()),
                         [](const auto& test) { return test.param.name; });

TEST(GoodCampaign, IsAccepted) {
  const testing::ScratchFolder scratch;
  const auto error = refusal_of(copy_of_good_campaign(scratch));
  EXPECT_FALSE(error.has_value()) << error->what();
}

TEST(BrokenCampaigns, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const BrokenCampaign& broken : testing::broken_campaigns()) names.insert(broken.name);
  EXPECT_EQ(names.size(), testing::broken_campaigns().size());
  EXPECT_GE(names.size(), 45U);
}

/// What may look odd and is right: CRLF, a byte order mark, integers, comments, blank lines, a zero tool.
TEST(OddButGoodCampaign, IsAccepted) {
  const testing::ScratchFolder scratch;
  const fs::path folder = copy_of_good_campaign(scratch);
  for (const char* file :
       {"campaign.toml", "machine.toml", "model.toml", "S1.csv", "S2.csv", "diagonal.csv"}) {
    std::string text = "\xEF\xBB\xBF";
    for (const char c : testing::slurp(folder / file))
      text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    testing::spill(folder / file, text + "\r\n# the end\r\n\r\n");
  }
  const auto error = refusal_of(folder);
  EXPECT_FALSE(error.has_value()) << error->what();
}

}  // namespace
}  // namespace volcal
