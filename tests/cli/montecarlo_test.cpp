/// `volcal montecarlo` as a user runs it: its files, an interruption by SIGKILL, and what it says of bad
/// input.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "tests/support/program.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

/// A tracer, a diagonal and a level on straight functions: a fit takes milliseconds.
class MonteCarloCommand : public ::testing::Test {
 protected:
  MonteCarloCommand() {
    std::ofstream(model_) << "format = \"volcal-model-1\"\nmachine = \"" << machine()
                          << "\"\n[functions]\ndefault = { basis = \"bspline\", degree = 3, knots = 2 }\n";
    std::ofstream(study_) << "format = \"volcal-study-1\"\nmachine = \"" << machine() << "\"\nseed = 5\n"
                          << "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [4, 4, 3]\n";
  }

  void SetUp() override {
    const testing::ProgramRun run = run_program("simulate " + study_ + " -o " + path("campaign"));
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }

  static std::string machine() { return VOLCAL_SOURCE_DIR "/datasets/demo/machine.toml"; }
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  std::string campaign() const { return path("campaign/campaign.toml"); }
  testing::ProgramRun montecarlo(const std::string& options) const {
    return run_program("montecarlo " + campaign() + " -m " + model_ + " --noise white " + options);
  }

  /// Starts a study and kills it once its checkpoint is there.
  bool killed_after_checkpoint(const std::string& output) const {
    const pid_t child = ::fork();
    if (child == 0) {
      const int nowhere = ::open("/dev/null", O_RDWR);
      ::dup2(nowhere, STDOUT_FILENO);
      ::dup2(nowhere, STDERR_FILENO);
      ::execl(VOLCAL_PROGRAM, "volcal", "montecarlo", campaign().c_str(), "-m", model_.c_str(), "--noise",
              "white", "--path", "chord", "-n", "6000", "--refits", "2", "--threads", "1",
              "--checkpoint-every", "0", "-o", output.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    int status = 0;
    while (!fs::exists(output + ".checkpoint")) {
      if (::waitpid(child, &status, WNOHANG) == child) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }

 private:
  testing::ScratchFolder scratch_;

 protected:
  std::string model_ = path("model.toml");
  std::string study_ = path("study.toml");
};

/// Each of two processes that know nothing of each other would make the whole study.
TEST_F(MonteCarloCommand, RefusesProcessesThatAreNoTeam) {
  ASSERT_EQ(::setenv("SLURM_STEP_NUM_TASKS", "2", 1), 0);
  const auto run = montecarlo("-n 1000 -o " + path("study"));
  ::unsetenv("SLURM_STEP_NUM_TASKS");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("2 processes were started together but know nothing of each other"));
}

TEST_F(MonteCarloCommand, KeepsCheckpointsBesideAFolderThatIsYetToBeMade) {
  const auto run =
      montecarlo("--path linear -n 1000 --refits 0 --checkpoint-every 0 -o " + path("new/study"));
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_TRUE(fs::exists(path("new/study/montecarlo.json")));
}

TEST_F(MonteCarloCommand, RefusesANegativeNumberOfDraws) {
  const auto run = montecarlo("-n -5 -o " + path("study"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("must not be negative"));
}

TEST_F(MonteCarloCommand, WritesDistributionsOfEveryQuantity) {
  const testing::ProgramRun run = montecarlo("-n 20000 --seed 3 -o " + path("mc"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("Monte Carlo, 20,000 draws, seed 3"));
  EXPECT_THAT(run.output, HasSubstr("Largest difference from full refits of the same 20 draws"));
  EXPECT_THAT(run.output, HasSubstr("Linear propagation (GUM Supplement 1, clause 8, 2 digits): "));
  const auto json = nlohmann::json::parse(content(path("mc/montecarlo.json")));
  EXPECT_EQ(json.at("format"), "volcal-montecarlo-1");
  EXPECT_EQ(json.at("draws"), 20000);
  std::map<std::string, int> kinds;
  for (const auto& quantity : json.at("quantities")) {
    ++kinds[quantity.at("kind").get<std::string>()];
    const double u = quantity.at("u").get<double>(), linear = quantity.at("u_linear").get<double>();
    EXPECT_GT(u, 0.0);
    if (quantity.at("kind") == "table") {
      EXPECT_NEAR(u / linear, 1.0, 0.03) << quantity;
    }
    EXPECT_LT(quantity.at("symmetric")[0].get<double>(), quantity.at("symmetric")[1].get<double>());
    EXPECT_LE(quantity.at("shortest")[1].get<double>() - quantity.at("shortest")[0].get<double>(),
              quantity.at("symmetric")[1].get<double>() - quantity.at("symmetric")[0].get<double>() + 1e-12);
  }
  EXPECT_EQ(json.at("sources").size(), json.at("quantities")[0].at("u_of_sources").size());
  EXPECT_THAT(run.output, HasSubstr("] noise of laser-tracer\n"));
  EXPECT_THAT(run.output, HasSubstr("If one source were half as large"));
  EXPECT_GT(kinds["table"], 300);
  EXPECT_GT(kinds["parameter"], 3);
  EXPECT_GT(kinds["volumetric"], 70);
  EXPECT_GE(kinds["volumetric-max"], 1);
  const std::string csv = content(path("mc/montecarlo.csv"));
  EXPECT_THAT(csv, ::testing::StartsWith("kind,name,axis,position,position_unit,direction,tool,"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            json.at("quantities").size() + 1);
  EXPECT_FALSE(fs::exists(path("mc.checkpoint")));
}

/// One station and one tool do not see every error: as fit, exit 1 and the same words; nothing is written.
/// The conditions that table values and the volume hold for, in the words of `volcal tables`.
TEST_F(MonteCarloCommand, StatesTheConditions) {
  std::ofstream(study_) << "format = \"volcal-study-1\"\nmachine = \"" << machine() << "\"\nseed = 5\n"
                        << "[[temperatures]]\nchannel = \"air\"\nstart_degC = 20.0\ndrift_K_per_hour = 2.0\n"
                        << "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [4, 4, 3]\n";
  const testing::ProgramRun made = run_program("simulate " + study_ + " -o " + path("warm"));
  ASSERT_EQ(made.exit_code, 0) << made.errors;
  std::ofstream(model_, std::ios::app)
      << "[[effects]]\nkind = \"thermal-drift\"\nsymbol = \"EXX\"\ntemperature = \"air\"\n";
  const auto drawn = [&](const std::string& options, const std::string& output) {
    return run_program("montecarlo " + path("warm/campaign.toml") + " -m " + model_ +
                       " --noise white --path linear -n 2000 --refits 1 " + options + " -o " + path(output));
  };
  const testing::ProgramRun usual = drawn("", "usual"), stated = drawn("--conditions T_air=30", "stated");
  ASSERT_EQ(usual.exit_code, 0) << usual.errors;
  ASSERT_EQ(stated.exit_code, 0) << stated.errors;
  EXPECT_THAT(usual.output, HasSubstr("(mean of the campaign)\n"));
  EXPECT_THAT(stated.output, HasSubstr("Stated for T_air 30 degC (as stated)\n"));
  EXPECT_THAT(stated.output, HasSubstr("! T_air = 30 degC is beyond the readings"));
  EXPECT_THAT(content(path("stated/montecarlo.txt")), HasSubstr("Stated for T_air 30 degC (as stated)\n"));
  const auto json = [&](const std::string& output) {
    return nlohmann::json::parse(content(path(output + "/montecarlo.json")));
  };
  EXPECT_EQ(json("usual").at("conditions").at("T_air_degC").at("origin"), "mean of the campaign");
  EXPECT_EQ(json("stated").at("conditions").at("T_air_degC").at("value"), 30.0);
  const auto largest_u = [&](const std::string& output) {
    double largest = 0.0;
    const nlohmann::json document = json(output);
    for (const auto& quantity : document.at("quantities")) {
      if (quantity.at("kind") == "table" && quantity.at("name") == "EXX")
        largest = std::max(largest, quantity.at("u_linear").get<double>());
    }
    return largest;
  };
  EXPECT_GT(largest_u("stated"), 2.0 * largest_u("usual"));
  const testing::ProgramRun unknown = drawn("--conditions T_row=20", "unknown");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("T_row"));
}

/// In the words of every other command, and before the model is read that the fit needs.
TEST_F(MonteCarloCommand, RefusesConditionsBeforeTheFit) {
  ASSERT_EQ(run_program("simulate " + study_ + " -o " + path("campaign")).exit_code, 0);
  const auto refused = [&](const std::string& conditions) {
    const testing::ProgramRun run = run_program("montecarlo " + campaign() + " -m " + path("no-model.toml") +
                                                " --conditions " + conditions + " -o " + path("refused"));
    EXPECT_EQ(run.exit_code, 2) << conditions;
    return run.errors;
  };
  EXPECT_THAT(refused("T_row=20"), HasSubstr("--conditions T_row: the result does not know this condition"));
  EXPECT_THAT(refused("T_row=20"), HasSubstr("its campaign recorded "));
  EXPECT_THAT(refused("time_s=late"), HasSubstr("--conditions time_s=late is not a number"));
}

TEST_F(MonteCarloCommand, SaysAsFitDoesWhatIsNotDetermined) {
  std::ofstream(study_, std::ios::app) << "stations = [{ name = \"P1\", position_mm = [-700, -500, -600] }]\n"
                                       << "runs = [{ station = \"P1\", tool = \"short\" }]\n";
  ASSERT_EQ(run_program("simulate " + study_ + " -o " + path("campaign")).exit_code, 0);
  const testing::ProgramRun fit =
      run_program("fit " + campaign() + " -m " + model_ + " --noise white --json -o " + path("fit"));
  ASSERT_EQ(fit.exit_code, 1) << fit.errors;
  const auto invisible = nlohmann::json::parse(fit.output).at("rank").at("invisible");
  ASSERT_FALSE(invisible.empty());
  const testing::ProgramRun run = montecarlo("-n 1000 -o " + path("mc"));
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_EQ(run.errors, "");
  EXPECT_THAT(run.output, HasSubstr("nothing is drawn, the readings do not determine every error"));
  EXPECT_THAT(run.output, HasSubstr("Measure what is named here and draw again.\n"));
  EXPECT_THAT(run.output, HasSubstr("Do not switch them off in the model"));
  EXPECT_THAT(run.output, ::testing::Not(HasSubstr("\"zero\""))) << "following it makes the fit worse";
  for (const auto& sentence : invisible)
    EXPECT_THAT(run.output, HasSubstr("! " + sentence.get<std::string>() + "\n"));
  const testing::ProgramRun document = montecarlo("-n 1000 --json -o " + path("mc"));
  EXPECT_EQ(document.exit_code, 1) << document.errors;
  const auto json = nlohmann::json::parse(document.output);
  EXPECT_EQ(json.at("status"), "rank_deficient");
  EXPECT_EQ(json.at("draws"), 0);
  EXPECT_EQ(json.at("rank").at("invisible"), invisible);
  EXPECT_FALSE(fs::exists(path("mc")));
}

TEST_F(MonteCarloCommand, JsonIsTheFileAndNothingElse) {
  const testing::ProgramRun run = montecarlo("-n 1000 --json -o " + path("mc"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_EQ(run.output, content(path("mc/montecarlo.json")));
  EXPECT_EQ(run.errors, "");
}

TEST_F(MonteCarloCommand, KilledStudyResumesToTheSameBits) {
  const std::string options = "--path chord -n 6000 --refits 2 ";
  ASSERT_EQ(montecarlo(options + "--threads 2 -o " + path("whole")).exit_code, 0);
  ASSERT_TRUE(killed_after_checkpoint(path("killed")));
  EXPECT_FALSE(fs::exists(path("killed")));
  const testing::ProgramRun again = montecarlo(options + "-o " + path("killed"));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("an interrupted study of this output folder is kept here"));
  EXPECT_THAT(again.errors, HasSubstr("give --resume to go on with it, or delete the file to begin anew"));
  const testing::ProgramRun other = montecarlo(options + "--seed 2 --resume -o " + path("killed"));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.errors, HasSubstr("the checkpoint belongs to another study"));
  const testing::ProgramRun resumed = montecarlo(options + "--resume -o " + path("killed"));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
  for (const char* file : {"montecarlo.json", "montecarlo.csv", "montecarlo.txt"})
    EXPECT_EQ(content(path("killed/") + file), content(path("whole/") + file)) << file;
  EXPECT_FALSE(fs::exists(path("killed.checkpoint")));
}

TEST_F(MonteCarloCommand, BadCheckpointsAreRefused) {
  const testing::ProgramRun none = montecarlo("-n 1000 --resume -o " + path("mc"));
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.errors, HasSubstr("there is no checkpoint to resume from"));
  ASSERT_TRUE(killed_after_checkpoint(path("cut")));
  const std::string whole = content(path("cut.checkpoint"));
  std::ofstream(path("cut.checkpoint"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  const testing::ProgramRun cut = montecarlo("-n 6000 --path chord --resume -o " + path("cut"));
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_THAT(cut.errors, HasSubstr("cut.checkpoint"));
  EXPECT_THAT(cut.errors, HasSubstr("the checkpoint is cut off or was changed"));
  std::ofstream(path("cut.checkpoint")) << "x_mm,y_mm\n";
  EXPECT_THAT(montecarlo("-n 6000 --path chord --resume -o " + path("cut")).errors,
              HasSubstr("the file is not a checkpoint of volcal montecarlo"));
}

TEST_F(MonteCarloCommand, DisturbancesWidenWhatTheFitBelieves) {
  const testing::ProgramRun run =
      montecarlo("-n 20000 --json --disturb 'length-scale:readings=+-3' -o " + path("mc"));
  if (run.exit_code != 0) GTEST_FAIL() << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  ASSERT_EQ(json.at("disturbances").size(), 1U);
  EXPECT_THAT(json.at("disturbances")[0].get<std::string>(), HasSubstr("within +- 3"));
  const auto plain = nlohmann::json::parse(montecarlo("-n 20000 --json -o " + path("plain")).output);
  double widest = 0.0;
  for (std::size_t i = 0; i < plain.at("quantities").size(); ++i) {
    const auto& quantity = json.at("quantities")[i];
    if (quantity.at("kind") == "table") {
      EXPECT_NEAR(quantity.at("u").get<double>() / quantity.at("u_linear").get<double>(), 1.0, 0.05)
          << quantity;
    }
    widest =
        std::max(widest, quantity.at("u").get<double>() / plain.at("quantities")[i].at("u").get<double>());
  }
  EXPECT_GT(widest, 1.5);
}

TEST_F(MonteCarloCommand, BadOptionsAreNamed) {
  const auto errors = [&](const std::string& options) {
    const testing::ProgramRun run = montecarlo(options + " -o " + path("bad"));
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_FALSE(fs::exists(path("bad"))) << options;
    return run.errors;
  };
  EXPECT_THAT(errors("--path straight"), HasSubstr("--path"));
  EXPECT_THAT(errors("--digits 3"), HasSubstr("--digits"));
  EXPECT_THAT(errors("-n 10 --disturb 'length-scale:readings'"),
              HasSubstr("how large the effect may be is missing or not positive"));
  EXPECT_THAT(errors("-n 10 --disturb 'length-scale:readings=-1'"),
              HasSubstr("write KIND:TARGET=U for a standard uncertainty"));
  EXPECT_THAT(errors("-n 10 --disturb 'moonlight:EXX=1'"),
              HasSubstr("\"moonlight\" is not a kind of effect"));
}

/// Two digits of every u take 20,000 draws at least; the limit comes first.
TEST_F(MonteCarloCommand, EndsAtItsLimitWithWhatItHasReached) {
  const std::string options = "--path chord --refits 2 --checkpoint-every 0 -o " + path("limited");
  const testing::ProgramRun run = montecarlo("--minutes 0.0001 " + options);
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("reached for "));
  EXPECT_THAT(run.output, HasSubstr("draws would settle all: --resume goes on where this ended"));
  const auto json = nlohmann::json::parse(content(path("limited/montecarlo.json")));
  EXPECT_FALSE(json.at("settled").get<bool>());
  EXPECT_LT(json.at("draws").get<int>(), 20000);
  ASSERT_TRUE(fs::exists(path("limited.checkpoint")));
  const testing::ProgramRun more = montecarlo("--resume --minutes 0.0001 " + options);
  EXPECT_EQ(more.exit_code, 1) << more.errors;
  EXPECT_GT(nlohmann::json::parse(content(path("limited/montecarlo.json"))).at("draws").get<int>(),
            json.at("draws").get<int>());
}

/// Two digits take two sequences of 10,000 draws at least, which ten draws say nothing against.
TEST_F(MonteCarloCommand, SaysThatMostDrawsEndedIt) {
  const testing::ProgramRun run = montecarlo("--path linear --refits 0 --most-draws 10 -o " + path("ten"));
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("Monte Carlo, 10 draws"));
  EXPECT_THAT(run.output, HasSubstr("draws would settle all: --most-draws 10 ended it, give more"));
  EXPECT_THAT(run.output, ::testing::Not(HasSubstr("about 10 draws")));
  EXPECT_THAT(run.output, HasSubstr("undecided: fewer than 40 draws have no ends"));
  EXPECT_FALSE(fs::exists(path("ten.checkpoint")));
}

TEST_F(MonteCarloCommand, InterruptedStudyNamesResume) {
  const std::string output = path("stopped"), said = path("said");
  const pid_t child = ::fork();
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_RDWR);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(::open(said.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    ::execl(VOLCAL_PROGRAM, "volcal", "montecarlo", campaign().c_str(), "-m", model_.c_str(), "--noise",
            "white", "--path", "chord", "-n", "1000000", "--refits", "2", "--threads", "1",
            "--checkpoint-every", "0", "-o", output.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  while (!fs::exists(output + ".checkpoint")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(content(said), HasSubstr("the same command with --resume goes on"));
  EXPECT_TRUE(fs::exists(output + ".checkpoint"));
}

}  // namespace
}  // namespace volcal
