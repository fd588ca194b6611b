/// The commands that criticise and extend a model, and what they say of bad input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/hand_made_diagnosis.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/report/report.h"

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

/// Before anything is computed: the campaign need not even exist.
TEST(DiagnoseProgram, APictureThatCannotBeDrawnIsRefusedFirst) {
  if (!report_available()) GTEST_SKIP() << "built without Node.js";
  const auto no_png = run_program("diagnose none.toml --picture found.svg");
  EXPECT_EQ(no_png.exit_code, 2);
  EXPECT_THAT(no_png.errors, HasSubstr("end it in .png"));
  const auto no_folder = run_program("diagnose none.toml --picture no-such-folder/found.png");
  EXPECT_EQ(no_folder.exit_code, 2);
  EXPECT_THAT(no_folder.errors, HasSubstr("make no-such-folder first"));
  const std::string path = std::getenv("PATH");
  const ::volcal::testing::ScratchFolder empty;
  ::setenv("PATH", empty.path().c_str(), 1);
  const auto no_browser = run_program("diagnose none.toml --picture found.png");
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(no_browser.exit_code, 2);
  EXPECT_THAT(no_browser.errors, HasSubstr("apt-get install chromium"));
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

/// The same as with "--formula model": beside the surface there would be nothing to explain.
TEST(DiagnoseProgram, LooksForALawInThePlaceOfTheModelsSurface) {
  const testing::ScratchFolder scratch;
  const std::string model = (scratch.path() / "model.toml").string();
  std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"" + kData + "/small/machine.toml\"\n"
                       << "[[effects]]\nkind = \"empirical\"\n"
                          "target = \"EYY\"\ndrivers = \"x y\"\n";
  const auto asked = [&](const std::string& formula) {
    const auto run = run_program("diagnose " + kData + "/small/campaign.toml --model " + model +
                                 " --json --formula \"" + formula + "\"");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_THAT(run.output, HasSubstr("\"diagnosis.without-surfaces\""));
    return nlohmann::json::parse(run.output).at("asked_laws");
  };
  const auto by_name = asked("EYY: y x");
  ASSERT_EQ(by_name.size(), 1U);
  EXPECT_EQ(by_name, asked("model"));
}

TEST(DiagnoseProgram, LooksForTheLawThatIsAskedFor) {
  const std::string command = "diagnose " + kData + "/small/campaign.toml ";
  const auto run = run_program(command + "--json --formula \"EXX: dir_x T_air\" --formula \"EYY: y x\"");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto asked = nlohmann::json::parse(run.output).at("asked_laws");
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_THAT(asked[0].at("label").get<std::string>(), HasSubstr("dir_x T_air"));
  for (const auto& laws : asked) {
    EXPECT_GT(laws.at("tried").get<int>(), 10);
    EXPECT_LE(laws.at("laws").size(), 10U);
  }
  const auto wrong = [&](const std::string& formula, const std::string& part) {
    const auto refused = run_program(command + "--formula " + formula);
    EXPECT_EQ(refused.exit_code, 2) << formula;
    EXPECT_THAT(refused.errors, HasSubstr(part)) << formula;
  };
  wrong("\"x y\"", "names no target");
  wrong("\"EXX: q\"", "\"q\" is not a variable");
  wrong("\"EXX: x y z t\"", "4 drivers");
  wrong("\"EXX: T_oil\"", "T_oil_degC is missing");
  wrong("model", "has no effect of kind \"empirical\"");
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

TEST_F(ExtendProgram, TheSameEffectTwiceIsRefused) {
  const auto run = extend({"axis-coupling:EAY:z:linear", "axis-coupling:EAY:z:linear"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("has axis-coupling:EAY:z:linear already"));
  EXPECT_FALSE(fs::exists(output_));
  ASSERT_EQ(extend({"axis-coupling:EAY:z:linear"}).exit_code, 0);
  const auto again = run_program("extend " + output_ + " --effect axis-coupling:EAY:z:linear -o " + output_);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("already"));
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
  EXPECT_THAT(unknown.errors, HasSubstr("not a kind of effect"));
  const auto by_hand = extend({"custom:EAY"});
  EXPECT_EQ(by_hand.exit_code, 2);
  EXPECT_THAT(by_hand.errors, HasSubstr("written into the model file"));
  EXPECT_FALSE(fs::exists(output_));
}

/// A folder with the diagnosis.json of hand_made_diagnosis.h.
class FromADiagnosis : public ::testing::Test {
 protected:
  FromADiagnosis() {
    write(testing::hand_made_diagnosis());
    fs::copy_file(kData + "/small/machine.toml", scratch_.path() / "machine.toml");
    std::ofstream(model_) << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n";
  }

  void write(const Diagnosis& diagnosis) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "diagnosis.json") << diagnosis_json(diagnosis);
  }
  auto extend(const std::string& arguments, const std::string& model = {}) {
    return run_program("extend " + (model.empty() ? model_ : model) + " --diagnosis " + folder_.string() +
                       " " + arguments + " -o " + output_);
  }

  testing::ScratchFolder scratch_;
  fs::path folder_ = scratch_.path() / "diagnosis";
  std::string model_ = (scratch_.path() / "model.toml").string();
  std::string output_ = (scratch_.path() / "model-1.toml").string();
};

TEST_F(FromADiagnosis, TheLadderIsShownAgain) {
  const auto shown = run_program("diagnose --show " + folder_.string());
  EXPECT_EQ(shown.exit_code, 0) << shown.errors;
  for (const char* part : {"NAMED_MORE_REMAINS", "Models compared on held-out lines", "reversal EXX",
                           "1.25 .. 1.75", "Below the detection limit", "Visit station P1"}) {
    EXPECT_THAT(shown.output, HasSubstr(part));
  }
  const auto as_json = run_program("diagnose --json --show " + (folder_ / "diagnosis.json").string());
  EXPECT_EQ(nlohmann::json::parse(as_json.output).at("ladder").size(), 2U);
  EXPECT_EQ(run_program("diagnose " + kData + "/small/campaign.toml --show " + folder_.string()).exit_code,
            2);
  const auto nowhere = run_program("diagnose --show " + scratch_.path().string());
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.errors, HasSubstr("holds no diagnosis.json"));
}

TEST_F(FromADiagnosis, RankOneIsWhatItAddedAndRankTwoItsRival) {
  const auto first = extend("--rank 1");
  EXPECT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_THAT(first.output, HasSubstr("added: reversal EXX"));
  EXPECT_THAT(content(output_), HasSubstr("symbol = \"EXX\""));
  EXPECT_THAT(content(output_), HasSubstr("amplitude_um = 4"));
  EXPECT_EQ(extend("--rank 2").exit_code, 0);
  EXPECT_THAT(content(output_), HasSubstr("symbol = \"EYY\""));
  EXPECT_EQ(extend("--rank 3").exit_code, 0) << "more of an error function is no effect and has no rank";
  EXPECT_THAT(content(output_), HasSubstr("symbol = \"EZZ\""));
  EXPECT_EQ(extend("--accepted").exit_code, 0);
  EXPECT_THAT(content(output_), HasSubstr("symbol = \"EXX\""));
}

TEST_F(FromADiagnosis, TheModelGetsTheNextNumberByDefault) {
  const std::string from = " --diagnosis " + folder_.string();
  EXPECT_THAT(run_program("extend " + model_ + from + " --rank 1").output,
              HasSubstr("model-1.toml (1 effect)"));
  EXPECT_THAT(run_program("extend " + output_ + from + " --rank 2").output,
              HasSubstr("model-2.toml (2 effects)"));
}

/// A model with a surface was criticised without it (--formula), and a surface of the same variables was
/// drawn anew: it replaces the old one. Another surface of the model stays.
TEST_F(FromADiagnosis, TheSurfaceInWhosePlaceLawsWereLookedForIsTakenOut) {
  std::ofstream(model_, std::ios::app)
      << "[[effects]]\nkind = \"empirical\"\ntarget = \"EYY\"\ndrivers = \"x y\"\n"
      << "[[effects]]\nkind = \"empirical\"\ntarget = \"EXX\"\ndrivers = \"z\"\n";
  Diagnosis diagnosis = testing::hand_made_diagnosis();
  EffectFinding drawn;
  drawn.spec.kind = "empirical";
  drawn.spec.options.set("target", std::string("EYY"));
  drawn.spec.options.set("drivers", std::string("x y"));
  drawn.name = EffectName::of_parts("empirical", "EYY", "x y", "");
  drawn.label = "surface EYY by x y";
  diagnosis.effects = {drawn};
  diagnosis.one_of.clear();
  diagnosis.further_one_of.clear();
  diagnosis.sets.clear();
  write(diagnosis);
  const auto beside = extend("--accepted");
  EXPECT_EQ(beside.exit_code, 2) << "the model has it";
  diagnosis.findings.push_back(
      {FindingCode::DiagnosisWithoutSurfaces, {{"effects", std::vector<std::string>{"surface EYY by x y"}}}});
  write(diagnosis);
  const auto run = extend("--accepted --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json.at("taken_out"), nlohmann::json({"surface EYY by x y"}));
  EXPECT_EQ(json.at("effects"), 2);
  EXPECT_THAT(content(output_), HasSubstr("target = \"EXX\""));
  EXPECT_THAT(extend("--accepted").output, HasSubstr("taken out: surface EYY by x y\nadded: "));
}

TEST_F(FromADiagnosis, EveryFailureSaysWhatToDo) {
  const auto expect = [](const testing::ProgramRun& run, const std::string& part) {
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.errors, HasSubstr(part));
  };
  expect(extend("--rank 4"), "ranks 3 effects");
  expect(extend(""), "--rank 1");
  expect(extend("--rank 1 --accepted"), "leave one of the two out");
  expect(run_program("extend " + model_ + " --rank 1 -o " + output_), "need a diagnosis");
  expect(run_program("extend " + model_ + " -o " + output_), "nothing to add is given");
  EXPECT_FALSE(fs::exists(output_));
  ASSERT_EQ(extend("--rank 1").exit_code, 0);
  expect(extend("--rank 1", output_), "has reversal EXX already");
  Diagnosis nothing = testing::hand_made_diagnosis();
  nothing.effects.clear();
  nothing.sets.clear();
  nothing.verdict = Verdict::NothingAbove;
  write(nothing);
  expect(extend("--accepted"), "its verdict is NOTHING_ABOVE");
  nothing.one_of.clear();
  nothing.further_one_of.clear();
  nothing.ranking.clear();
  write(nothing);
  expect(extend("--rank 1"), "ranks no effect");
}

}  // namespace
}  // namespace volcal
