// A campaign that verifies a compensation: planned off the places and positions of the one that it was made
// from, measured on the compensated machine, judged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/planning/registry.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

/// A cradle measured with spheres, its linear axes perfect.
class VerifiedCradle : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_program("init \"w C' A' b X Y Z t\" -o " + in("five")).exit_code, 0);
    std::ofstream(in("five/study.toml")) << R"(format = "volcal-study-1"
machine = "machine.toml"
seed = 4
[truth]
volumetric_rms_um = [0.0, 0.0]
reversal_max_um = 0.0
angular_reversal_max_urad = 0.0
[[measurements]]
kind = "r-test"
tools = ["short", "long", "side"]
positions = { A = 7, C = 8 }
noise = { constant_um = 0.5, repeatability_um = 0.5 }
[[measurements.spheres]]
name = "S1"
position_mm = [120.0, 0.0, -370.0]
[[measurements.spheres]]
name = "S2"
position_mm = [-60.0, 100.0, -370.0]
[[measurements.spheres]]
name = "S3"
position_mm = [-60.0, -100.0, -320.0]
)";
    std::ofstream(in("five/rotary.toml")) << rotary_model();
    ok("simulate " + in("five/study.toml") + " -o " + in("measured"));
    ok("fit " + in("measured/campaign.toml") + " --model " + in("five/rotary.toml") + " -o " + in("result"));
    ok("tables " + in("result") + " --format neutral-csv --type R-VOL --tool short -o " + in("tables"));
  }

  std::string in(const std::string& name) const { return (scratch_.path() / name).string(); }

  static testing::ProgramRun ok(const std::string& arguments) {
    const auto run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 0) << arguments << "\n" << run.errors << run.output;
    return run;
  }

  static std::string rotary_model() {
    std::string text = "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\n";
    for (const char axis : {'X', 'Y', 'Z'}) {
      for (const char* component : {"EX", "EY", "EZ", "EA", "EB", "EC"})
        text += std::string(component) + axis + " = { basis = \"zero\" }\n";
    }
    return text + "[locations]\nEC0Y = \"zero\"\nEB0Z = \"zero\"\nEA0Z = \"zero\"\n";
  }

  testing::ScratchFolder scratch_;
};

TEST_F(VerifiedCradle, IsPlannedApartAndJudged) {
  const auto plan =
      ok("plan " + in("five/machine.toml") + " --instrument r-test --stations 2 --readings 160 --tools " +
         "short --region-mm=-150,150,-150,150,-400,-300 --verify " + in("measured/campaign.toml") +
         " --seed 4 -o " + in("verification"));
  EXPECT_THAT(plan.output, HasSubstr("ISO/TR 16907, 11.3"));
  EXPECT_THAT(plan.output, HasSubstr("--tables"));
  const Campaign before = read_campaign(in("measured/campaign.toml"));
  const Campaign planned = read_campaign(in("verification/campaign/campaign.toml"));
  const PlanInstrument& r_test = *find_plan_instrument("r-test");
  for (const volcal::Setup& setup : planned.setups) {
    const Eigen::Vector3d place = r_test.place_of(setup, planned.machine)->place_w;
    for (const volcal::Setup& old : before.setups)
      EXPECT_GT((r_test.place_of(old, before.machine)->place_w - place).norm(), 0.0299) << setup.name;
    const auto at = [](const volcal::Setup& each, AxisName axis, std::size_t row) {
      return each.readings.position[index_of(axis)][row];
    };
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      for (const volcal::Setup& old : before.setups) {
        for (std::size_t other = 0; other < old.readings.size(); ++other) {
          const double apart = std::max(std::abs(at(setup, AxisName::A, row) - at(old, AxisName::A, other)),
                                        std::abs(at(setup, AxisName::C, row) - at(old, AxisName::C, other)));
          ASSERT_GT(apart, 0.0174) << setup.name;
        }
      }
    }
  }
  // The same seed is the same machine; now with the tables active.
  ok("simulate " + in("verification/study.toml") + " --compensation " + in("tables") + " -o " + in("after"));
  const auto judged = [&](const std::string& options) {
    return nlohmann::json::parse(
        ok("validate " + in("result") + " " + in("after/campaign.toml") + " --json " + options).output);
  };
  const auto with_tables = judged("--tables " + in("tables"));
  EXPECT_LT(with_tables["compensated_rms_um"].get<double>(), 2.0) << "of readings on the compensated machine";
  EXPECT_GT(with_tables["rms_before_um"].get<double>(), 8.0) << "of the same machine without tables";
  EXPECT_LT(with_tables["reduced_chi2"].get<double>(), 1.3);
  EXPECT_GT(with_tables["coverage95"].get<double>(), 0.9);
  EXPECT_GT(judged("")["reduced_chi2"].get<double>(), 10.0) << "taken for readings without tables";
  ok("tables " + in("result") + " --format neutral-csv --type R-POS --tool short -o " + in("others"));
  EXPECT_GT(judged("--tables " + in("others"))["reduced_chi2"].get<double>(), 10.0) << "other tables";
}

/// A head and one tool on the spindle's axis: what cannot be seen, and what would help, in words.
TEST(PlanOfAHead, SaysWhatItCannotSeeAndWhatWouldHelp) {
  const testing::ScratchFolder scratch;
  const std::string head = (scratch.path() / "head").string();
  ASSERT_EQ(run_program("init \"w X' b Y Z C B t\" -o " + head).exit_code, 0);
  const auto run = run_program("plan " + head +
                               "/machine.toml --instrument r-test --stations 3 --readings 240 --tools short");
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("ECB: not visible"));
  EXPECT_THAT(run.output, HasSubstr("add a mandrel whose tip lies 60 mm or more to the side"));
  EXPECT_THAT(run.output, HasSubstr("with tool side"));
}

TEST(Verification, IsOfOneCampaign) {
  const auto run = run_program("plan machine.toml --verify a.toml --with b.toml --readings 100");
  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.errors, HasSubstr("two campaigns"));
}

}  // namespace
}  // namespace volcal
