/// What `volcal init` writes for machines with rotary axes, rehearsed: simulated, fitted, diagnosed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/planning/expected_result.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

struct RehearsedMachine {
  const char* name;
  const char* structure;
  bool for_the_night = false;
};

class InitRehearsal : public ::testing::TestWithParam<RehearsedMachine> {
 protected:
  std::string in(const std::string& name) const { return (scratch_.path() / name).string(); }
  testing::ScratchFolder scratch_;
};

/// The model that the fit begins with explains the machine that the study draws; for the night a diagnosis
/// finds nothing, too.
TEST_P(InitRehearsal, EndsWithoutLackOfFit) {
  if (GetParam().for_the_night) {
    VOLCAL_FOR_THE_NIGHT("another table, and the guide \"Calibrate a five-axis machine\"");
  }
  const std::string structure = GetParam().structure;
  ASSERT_EQ(run_program("init \"" + structure + "\" -o " + in("five")).exit_code, 0);
  const auto simulated = run_program("simulate " + in("five/study.toml") + " -o " + in("rehearsal"));
  ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
  EXPECT_THAT(simulated.output, Not(HasSubstr("left out")));
  const auto fit = run_program("fit " + in("rehearsal/campaign.toml") + " --json -o " + in("result"));
  const auto result = nlohmann::json::parse(fit.output);
  EXPECT_NE(result.at("status"), "lack_of_fit") << fit.output.substr(0, 2000);
  if (!testing::long_tests()) return;
  const auto diagnosis =
      run_program("diagnose " + in("rehearsal/campaign.toml") + " --json -o " + in("diagnosis"));
  EXPECT_EQ(diagnosis.exit_code, 0) << diagnosis.errors;
  EXPECT_EQ(nlohmann::json::parse(diagnosis.output).at("verdict"), "NOTHING_ABOVE")
      << diagnosis.output.substr(0, 2000);
}

INSTANTIATE_TEST_SUITE_P(All, InitRehearsal,
                         ::testing::Values(RehearsedMachine{"trunnion", "w C' A' Y' b X Z t", true},
                                           RehearsedMachine{"table_on_table", "w C' B' b X Y Z t"},
                                           RehearsedMachine{"head", "w X' b Y Z C B t"},
                                           RehearsedMachine{"table_and_head", "w C' X' b Y Z B t"},
                                           RehearsedMachine{"one_table", "w C' b X Y Z t", true},
                                           RehearsedMachine{"lathe", "w C' b Z X t"},
                                           RehearsedMachine{"plane", "w B' X' b Z t"}),
                         [](const auto& each) { return std::string(each.param.name); });

/// Every combination of the positions of three axes, some 130, with three spheres and three tools: as many
/// readings as of two axes, and by the rank analysis of their positions no error that they do not show.
TEST(InitTemplates, ThreeRotaryAxesNeedAFewThousandReadings) {
  for (const char* structure : {"w C' A' b X Y Z B t", "w b X Y Z C B A t"}) {
    const testing::ScratchFolder scratch;
    const std::string folder = scratch.path().string();
    ASSERT_EQ(run_program("init \"" + std::string(structure) + "\" -o " + folder + "/six").exit_code, 0);
    const auto simulated = run_program("simulate " + folder + "/six/study.toml -o " + folder + "/rehearsal");
    ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
    const Campaign campaign = read_campaign(folder + "/rehearsal/campaign.toml");
    EXPECT_GT(campaign.reading_count(), 4500U) << structure;
    EXPECT_LT(campaign.reading_count(), 6000U) << structure;
    const FitResult expected = expected_result(campaign, {}, {});
    EXPECT_GT(expected.rank.errors.size(), 45U);
    for (const Observability& error : expected.rank.errors)
      EXPECT_TRUE(error.visible) << structure << " " << error.symbol.name();
  }
}

/// A slide on a turntable on the tool's side: its spheres are within reach.
TEST(InitTemplates, AColumnThatTurnsIsSimulated) {
  const testing::ScratchFolder scratch;
  const std::string folder = scratch.path().string();
  ASSERT_EQ(run_program("init \"w b C X Z t\" -o " + folder + "/five").exit_code, 0);
  const auto simulated = run_program("simulate " + folder + "/five/study.toml -o " + folder + "/rehearsal");
  EXPECT_EQ(simulated.exit_code, 0) << simulated.errors;
}

}  // namespace
}  // namespace volcal
