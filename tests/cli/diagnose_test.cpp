/// The commands that criticise and extend a model, and what they say of bad input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

const std::string kData = VOLCAL_SOURCE_DIR "/tests/data";

TEST(DiagnoseProgram, ListsEveryKind) {
  const auto run = run_program("diagnose --list");
  EXPECT_EQ(run.exit_code, 0);
  for (const char* kind : {"reversal", "lead-error", "scale-expansion", "axis-coupling", "length-scale",
                           "station-event", "custom", "foundation-tilt", "left-out"}) {
    EXPECT_THAT(run.output, HasSubstr(kind));
  }
}

TEST(DiagnoseProgram, AsksForACampaign) {
  const auto run = run_program("diagnose");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("no campaign is given"));
}

TEST(DiagnoseProgram, ProposesAMeasurementForWhatIsAsked) {
  const auto run =
      run_program("diagnose " + kData + "/small/campaign.toml --json --separate length-scale:readings");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  ASSERT_TRUE(json.at("next_measurement").is_array());
  for (const auto& proposal : json.at("next_measurement")) {
    for (const char* key :
         {"action", "setup", "separates", "makes_visible", "readings", "gain", "plain_gain", "words"}) {
      EXPECT_TRUE(proposal.contains(key)) << key;
    }
  }
  const auto& confounding = json.at("confounding");
  EXPECT_EQ(confounding.at("effects").size(), confounding.at("cosine").size());
  ASSERT_FALSE(json.at("ranking").empty());
  EXPECT_TRUE(json.at("ranking").front().contains("mib"));
}

TEST(DiagnoseProgram, RefusesToSeparateWhatDoesNotExist) {
  const auto unknown = run_program("diagnose " + kData + "/small/campaign.toml --separate gremlins:EXX");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("--separate gremlins:EXX"));
  const auto nothing = run_program("diagnose " + kData + "/small/campaign.toml --separate reversal:EC0Y");
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.errors, HasSubstr("names nothing that could act here"));
}

class ExtendProgram : public ::testing::Test {
 protected:
  auto extend(const std::vector<std::string>& effects) {
    std::string arguments = "extend " + kData + "/small/model.toml -o " + output_;
    for (const std::string& effect : effects) arguments += " --effect " + effect;
    return run_program(arguments);
  }

  testing::ScratchFolder scratch_;
  std::string output_ = (scratch_.path() / "extended.toml").string();
};

TEST_F(ExtendProgram, AddsAnEffectByName) {
  const auto run = extend({"axis-coupling:EAY:z:linear"});
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  const std::string text = content(output_);
  EXPECT_THAT(text, HasSubstr("kind = \"axis-coupling\""));
  EXPECT_THAT(text, HasSubstr("symbol = \"EAY\""));
  EXPECT_THAT(text, HasSubstr("shape = \"linear\""));
}

TEST_F(ExtendProgram, SaysWhatANameCouldMean) {
  const auto several = extend({"axis-coupling:EAY"});
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.errors, HasSubstr("axis-coupling:EAY:z:quadratic"));
  const auto none = extend({"reversal:EC0Y"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, HasSubstr("names nothing that could act here"));
  const auto unknown = extend({"gremlins:EXX"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("no kind of effect"));
  const auto by_hand = extend({"custom:EAY"});
  EXPECT_EQ(by_hand.exit_code, 2);
  EXPECT_THAT(by_hand.errors, HasSubstr("written into the model file"));
  EXPECT_FALSE(fs::exists(output_));
}

}  // namespace
}  // namespace volcal
