/// What a result says of the run that made it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using testing::run_program;

const std::string kSmallCampaign = VOLCAL_SOURCE_DIR "/tests/data/small/campaign.toml";

/// SOURCE_DATE_EPOCH for as long as it lives.
class FixedTime {
 public:
  explicit FixedTime(const char* seconds) {
    if (const char* before = std::getenv(kName)) before_ = before;
    setenv(kName, seconds, 1);
  }
  ~FixedTime() { before_ ? setenv(kName, before_->c_str(), 1) : unsetenv(kName); }
  FixedTime(const FixedTime&) = delete;
  FixedTime& operator=(const FixedTime&) = delete;

 private:
  static constexpr const char* kName = "SOURCE_DATE_EPOCH";
  std::optional<std::string> before_;
};

nlohmann::json provenance_of(const std::filesystem::path& result) {
  return nlohmann::json::parse(content(result / "result.json")).at("provenance");
}

TEST(Provenance, NamesVersionTimeAndCommand) {
  const testing::ScratchFolder scratch;
  const std::string result = (scratch.path() / "my result").string();
  const FixedTime time("1700000000");
  const auto run = run_program("fit " + kSmallCampaign + " --noise white -o '" + result + "'");
  ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 1) << run.errors;
  const auto provenance = provenance_of(result);
  EXPECT_THAT(provenance.at("version").get<std::string>(), MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_EQ(provenance.at("date"), "2023-11-14T22:13:20Z");
  EXPECT_EQ(provenance.at("command"), "volcal fit " + kSmallCampaign + " --noise white -o '" + result + "'");
  if (std::filesystem::exists(result + "/report.html")) {
    const std::string page = content(result + "/report.html");
    EXPECT_THAT(page, HasSubstr("\"date\":\"2023-11-14\""));
    EXPECT_THAT(page, HasSubstr("volcal fit "));
  }
}

TEST(Provenance, RefusesATimeThatIsNone) {
  const testing::ScratchFolder scratch;
  for (const char* wrong : {"", "yesterday", "-5", "1e9", "99999999999999"}) {
    const FixedTime time(wrong);
    const auto run = run_program("fit " + kSmallCampaign + " -o " + (scratch.path() / "result").string());
    EXPECT_EQ(run.exit_code, 2) << wrong;
    EXPECT_THAT(run.errors, HasSubstr("SOURCE_DATE_EPOCH")) << wrong;
  }
}

}  // namespace
}  // namespace volcal
