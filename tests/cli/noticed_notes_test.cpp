/// What is noticed while a campaign is read is said by every command that reads one, on the terminal and in
/// JSON.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::run_program;

/// The demo campaign with a column in one of its files that nobody reads, and a model that is quickly fitted.
class NoticedNotes : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy(VOLCAL_SOURCE_DIR "/datasets/demo/campaign", folder_.path() / "campaign",
             fs::copy_options::recursive);
    const fs::path file = folder_.path() / "campaign/body_ppp.csv";
    std::istringstream lines(testing::content(file));
    std::string text, line;
    for (int row = 0; std::getline(lines, line); ++row) text += line + (row == 0 ? ",gust\n" : ",0.5\n");
    std::ofstream(file) << text;
    std::ofstream(path("campaign/quick.toml"))
        << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\n"
           "default = { basis = \"bspline\", degree = 2, knots = 1 }\n";
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  void expect_note_in_text(const std::string& arguments) const {
    const auto run = run_program(arguments);
    EXPECT_THAT(run.output, HasSubstr("gust")) << arguments << run.errors;
    EXPECT_THAT(run.output, HasSubstr("! ")) << arguments;
    fs::remove_all(path("out"));
  }
  void expect_note_in_json(const std::string& arguments) const {
    const auto run = run_program(arguments + " --json");
    EXPECT_THAT(nlohmann::json::parse(run.output).at("notes").dump(), HasSubstr("gust")) << arguments;
    fs::remove_all(path("out"));
  }
  void expect_note(const std::string& arguments) const {
    expect_note_in_text(arguments);
    expect_note_in_json(arguments);
  }

 private:
  testing::ScratchFolder folder_;
};

TEST_F(NoticedNotes, AreSaidByEveryCommandThatReadsACampaign) {
  const std::string campaign = path("campaign/campaign.toml"), model = path("campaign/quick.toml"),
                    out = path("out");
  expect_note("diagnose " + campaign + " --list");
  expect_note("extend " + model + " --effect reversal:EXX --campaign " + campaign + " -o " + out);
  const std::string montecarlo = "montecarlo " + campaign + " --model " + model +
                                 " -n 20 --grid 0 --noise white -o " + out,
                    plan = "plan " + path("campaign/machine.toml") + " --model " + model +
                           " --readings 64 --stations 2 --with " + campaign;
  for (const std::string& command : {montecarlo, plan}) {
    expect_note_in_json(command);
    if (testing::long_tests()) expect_note_in_text(command);
  }
  expect_note("compare " + campaign + " nominal");
  expect_note_in_json("try " + campaign + " \"EXX: dir_x\"");
}

}  // namespace
}  // namespace volcal
