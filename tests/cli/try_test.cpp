/// `volcal try` and `extend --custom`: an effect of the user's own. datasets/hidden/21 hides a reversal of
/// EXX with an RMS of 0.5 um and ECX by z; amplitudes are those of its sealed answer.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using testing::run_program;
using ::testing::StartsWith;

const std::string kHidden = VOLCAL_SOURCE_DIR "/datasets/hidden/21/campaign.toml";
const std::string kTriedCampaign = VOLCAL_SOURCE_DIR "/tests/data/small";
const std::string kTriedModel = kTriedCampaign + "/model.toml";

TEST(TryProgram, FindsAReversalAndSaysWhatRemains) {
  VOLCAL_FOR_THE_NIGHT("guide_add-an-effect, which quotes the same lines");
  const auto run = run_program("try " + kHidden + " 'EXX: dir_x / 2'");
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_EQ(std::ranges::count(run.output, '\n'), 3) << run.output;
  EXPECT_THAT(run.output, StartsWith("EXX: dir_x / 2: amplitude 1.3"));
  EXPECT_THAT(run.output, HasSubstr("\nheld out: RMS "));
  EXPECT_THAT(run.output, HasSubstr("it predicts better\n"));
  EXPECT_THAT(run.output, HasSubstr("\nremains: still above the noise: ECX by z"));
}

/// The two ways to write one effect are one effect; with both hidden effects nothing is left.
TEST(TryProgram, SaysThatNothingRemains) {
  const testing::ScratchFolder scratch;
  const std::string extended = (scratch.path() / "with-tilt.toml").string();
  const auto extend = run_program(
      "extend " VOLCAL_SOURCE_DIR "/datasets/hidden/21/model.toml --custom 'ECX: z / 1000' -o " + extended);
  ASSERT_EQ(extend.exit_code, 0) << extend.errors;
  EXPECT_THAT(extend.output, HasSubstr("added: ECX by z / 1000"));
  EXPECT_THAT(content(extended), HasSubstr("expression = \"z / 1000\""));
  const auto run = run_program("try " + kHidden + " 'EXX += dir_x / 2' --model " + extended + " --json");
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json.at("verdict_of_what_remains"), "NOTHING_ABOVE");
  EXPECT_TRUE(json.at("remains").empty());
  EXPECT_TRUE(json.at("visible").get<bool>());
  const auto& amplitude = json.at("values").at(0);
  EXPECT_EQ(amplitude.at("unit"), "um");
  EXPECT_NEAR(amplitude.at("value").get<double>(), 1.38, 0.12);
  EXPECT_GT(amplitude.at("u").get<double>(), 0.0);
  EXPECT_LT(amplitude.at("u").get<double>(), 0.1);
  const auto& held_out = json.at("held_out");
  EXPECT_GT(held_out.at("without").at("chi2").get<double>(),
            held_out.at("with").at("chi2").get<double>() + 50.0);
  EXPECT_EQ(held_out.at("without").at("observations"), held_out.at("with").at("observations"));
}

/// (1 - exp(-|x| / p)) with a small p is 1 nearly everywhere: p is held where it is given without an
/// uncertainty. The prior of p is the same whatever the readings show, in every run of a small campaign,
/// which leaves the amplitude invisible.
TEST(TryProgram, ParametersAreHeldOrEstimated) {
  const std::string campaign =
      testing::short_or_long(kTriedCampaign + "/campaign.toml --model " + kTriedModel, kHidden);
  const std::string effect = "try " + campaign + " 'EXX: dir_x / 2 * (1 + p)' --json --parameter ";
  const int code = testing::short_or_long(1, 0);
  const auto held = run_program(effect + "p=0");
  ASSERT_EQ(held.exit_code, code) << held.errors;
  const auto parameter = nlohmann::json::parse(held.output).at("values").at(1);
  EXPECT_EQ(parameter.at("name"), "p");
  EXPECT_EQ(parameter.at("value"), 0.0);
  EXPECT_TRUE(parameter.at("u").is_null());
  const auto estimated = run_program(effect + "p=0+-0.1");
  ASSERT_EQ(estimated.exit_code, code) << estimated.errors;
  const auto found = nlohmann::json::parse(estimated.output).at("values").at(1);
  EXPECT_NEAR(found.at("u").get<double>(), 0.1, 0.02);  // the amplitude takes it all: the prior stays
}

/// 100 points with 0.1 um of noise, EZX of 20 um by x y, no reading above z = 0.
std::string campaign_of_points(const std::filesystem::path& folder) {
  std::ofstream points(folder / "points.csv");
  points << "line,x_mm,y_mm,z_mm,ex_um,ey_um,ez_um\n";
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (int i = 0; i < 100; ++i) {
    const double x = 125.0 * (i % 5), y = 100.0 * (i / 5 % 5), z = -100.0 * (i / 25);
    points << i / 5 << ',' << x << ',' << y << ',' << z << ',' << noise(random) << ',' << noise(random) << ','
           << x * y / 1e4 + noise(random) << '\n';
  }
  std::filesystem::copy_file(kTriedCampaign + "/machine.toml", folder / "machine.toml");
  std::ofstream(folder / "campaign.toml")
      << "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"V\"\n"
         "instrument = \"volumetric-points\"\ndata = \"points.csv\"\ntool = \"none\"\n"
         "noise = { constant_um = 0.1 }\n";
  std::ofstream(folder / "model.toml")
      << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\n"
         "default = { basis = \"legendre\", degree = 1 }\n[[effects]]\nkind = \"custom\"\n"
         "target = \"EZX\"\nexpression = \"x * y / 10000 * max(0, z - 1000)\"\n";
  return (folder / "campaign.toml").string() + " --model " + (folder / "model.toml").string();
}

/// The model has an effect that never acts, and whose text begins like what is tried.
TEST(TryProgram, AnotherEffectThatIsNotVisibleIsNoReason) {
  const testing::ScratchFolder scratch;
  const std::string campaign = campaign_of_points(scratch.path());
  const auto seen = run_program("try " + campaign + " 'EZX: x * y / 10000' --json");
  ASSERT_EQ(seen.exit_code, 0) << seen.errors;
  const auto json = nlohmann::json::parse(seen.output);
  EXPECT_TRUE(json.at("visible").get<bool>());
  EXPECT_NEAR(json.at("values").at(0).at("value").get<double>(), 1.0, 0.05);
  EXPECT_GT(json.at("held_out").at("chi2_less_by"), json.at("held_out").at("chi2_by_chance"));
  const auto absent = run_program("try " + campaign + " 'EZX: x * z / 10000'");
  EXPECT_THAT(absent.output, ::testing::Not(HasSubstr("it predicts better"))) << absent.errors;
  const auto unseen = run_program("try " + campaign + " 'EZX: x * max(0, z - 900)'");
  EXPECT_THAT(unseen.output, HasSubstr("NOT VISIBLE: no reading changes when it changes")) << unseen.errors;
}

struct Refusal {
  const char* arguments;
  const char* place;
  const char* remedy;
};

TEST(TryProgram, RefusesWithTheColumn) {
  const Refusal refusals[] = {
      {"'EXX: dir_k / 2'", "column 6: a variable of this name is not known, \"dir_k\"",
       "variables are x y z"},
      {"'EXX: foo(x)'", "column 6: a function of this name is not known, \"foo\"", "functions are"},
      {"'EXX += x * (y'", "column 14: its parentheses do not match, at the end", "variables are"},
      {"'EXX: x +'", "column 9: it ends where a value is expected", "variables are"},
      {"'EXX: 3'", "column 6: ", "write a variable into it"},
      {"'EXX: x * p'", "column 10: the expression uses p, which has no value", "--parameter p=250"},
      {"'gremlin: x'", "column 1: ", "write an error motion"},
      {"' : x'", "column 1: it names no target", "EZX: abs(x) / 400 * dir_x"},
      {"'EXX:'", "column 5: the expression is missing", "TARGET += expression"},
      {"'x * 2'", "column 6: it names no target", "TARGET: expression"},
      {"'EXX: x' --parameter p=1", "--parameter p=1: the expression does not use p", "leave it out"},
      {"'EXX: x * p' --parameter p", "--parameter p: it has no value", "p=250+-50"},
      {"'EXX: x * p' --parameter r=1", "parameters of an expression are p and q", "p=250"},
      {"'EXX: x * p' --parameter p=1+-0", "not a number greater than 0", "p=250"},
      {"'EXX: x * p' --parameter p=nan", "its value is not a number", "p=250"},
      {"'EXX: x * p' --parameter p=1 --parameter p=2", "p is given twice", "leave one out"},
      {"'EXX: x * T_oil'", "column 10: ", "column T_oil_degC is missing, but the expression uses T_oil (add"},
      {"'EXX: x * T_oil'", "column 10: ", "channels"},
      {"'EXA: x'", "column 1: ", "the machine has no axis A"},
      {"'EXX += log(x)'", "column 8: ", "is not finite at"},
  };
  for (const Refusal& refusal : refusals) {
    const auto run = run_program("try " + kTriedCampaign + "/campaign.toml " + refusal.arguments);
    EXPECT_EQ(run.exit_code, 2) << refusal.arguments << run.output;
    EXPECT_THAT(run.errors, HasSubstr(refusal.place)) << refusal.arguments;
    EXPECT_THAT(run.errors, HasSubstr(refusal.remedy)) << refusal.arguments;
  }
}

TEST(TryProgram, RefusesWhatTheModelHasAlready) {
  const testing::ScratchFolder scratch;
  const std::string model = (scratch.path() / "model-1.toml").string();
  ASSERT_EQ(
      run_program("extend " VOLCAL_SOURCE_DIR "/datasets/hidden/21/model.toml --custom 'EXX: dir_x' -o " +
                  model)
          .exit_code,
      0);
  const auto again = run_program("try " + kHidden + " 'EXX:dir_x' --model " + model);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("the model has this effect already, as EXX by dir_x"));
  const auto twice = run_program("extend " + model + " --custom 'EXX: dir_x'");
  EXPECT_EQ(twice.exit_code, 2);
  const auto alone = run_program("extend " + model + " --effect reversal:EXX --parameter p=1");
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.errors, HasSubstr("--parameter needs an expression"));
  const auto no_axis = run_program("extend " + model + " --custom 'EXA: x'");
  EXPECT_EQ(no_axis.exit_code, 2);
  EXPECT_THAT(no_axis.errors, HasSubstr("an axis that the model's machine does not have"));
}

/// An expression that says what an effect of the catalogue says, by every command that takes one.
TEST(TryProgram, RefusesAnEffectOfTheModelInOtherWords) {
  const testing::ScratchFolder scratch;
  const std::string model = (scratch.path() / "model-1.toml").string();
  ASSERT_EQ(run_program("extend " VOLCAL_SOURCE_DIR
                        "/datasets/hidden/21/model.toml --effect axis-coupling:ECX:z:linear -o " +
                        model)
                .exit_code,
            0);
  const std::string campaign = " " VOLCAL_SOURCE_DIR "/datasets/hidden/21/campaign.toml --model " + model;
  for (const std::string& command :
       {"try" + campaign + " 'ECX: z'", "extend " + model + " --custom 'ECX: z'",
        "diagnose" + campaign + " --try 'ECX: z'", "session" + campaign + " --do 'formula ECX += z'"}) {
    const auto run = run_program(command);
    EXPECT_EQ(run.exit_code, 2) << command;
    EXPECT_THAT(run.errors, ::testing::ContainsRegex("the model has .* already")) << command;
    EXPECT_THAT(run.errors, ::testing::Not(HasSubstr("given twice"))) << command;
  }
}

/// Where the readings hold a plain reversal, the time constant wants to be 0: a step of the adjustment that
/// takes it through 0 is not taken.
TEST(TryProgram, ATimeConstantDoesNotGoThroughZero) {
  const testing::ScratchFolder scratch;
  const std::string model = (scratch.path() / "model-1.toml").string(),
                    result = (scratch.path() / "result").string();
  ASSERT_EQ(run_program("extend " VOLCAL_SOURCE_DIR
                        "/datasets/hidden/21/model.toml --custom 'EXX: dir_x*(1-exp(-t/p))' "
                        "--parameter p=1800+-600 -o " +
                        model)
                .exit_code,
            0);
  const auto run = run_program("fit " VOLCAL_SOURCE_DIR
                               "/datasets/hidden/21/campaign.toml --noise white "
                               "--json --model " +
                               model + " -o " + result);
  ASSERT_LE(run.exit_code, 1) << run.errors;
  const std::string identified = testing::content(result + "/identified.toml");
  const std::size_t at = identified.find("\np = ");
  ASSERT_NE(at, std::string::npos);
  const double p = std::stod(identified.substr(at + 5));
  EXPECT_GT(p, 0.0);
  EXPECT_LT(p, 200.0);
}

}  // namespace
}  // namespace volcal
