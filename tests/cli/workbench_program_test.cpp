// The commands workbench and session, and how the workbench begins and ends.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <tuple>

#include "tests/support/program.h"

namespace volcal::testing {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// A workbench in the background on a campaign that cannot be read: it opens its page all the same.
class WorkbenchProgram : public ::testing::Test {
 protected:
  WorkbenchProgram() {
    fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21", folder_.path() / "campaign");
    fs::remove(folder_.path() / "campaign/P1_short.csv");
  }
  ~WorkbenchProgram() override { signal("KILL"); }
  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string campaign() const { return file("campaign/campaign.toml"); }
  static bool until(const std::function<bool()>& holds) {
    for (int look = 0; look < 400 && !holds(); ++look)
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
    return holds();
  }
  bool start(const std::string& arguments) {
    const std::string program =
        std::string("exec ") + VOLCAL_PROGRAM + " workbench " + campaign() + " --no-browser " + arguments;
    const std::string command = "(sh -c 'echo $$ > " + file("pid") + "; " + program + "' > " + file("said") +
                                " 2>&1; echo $? > " + file("ended") + ") &";
    return std::system(command.c_str()) == 0 &&
           until([&] { return content(file("said")).find("http://127.0.0.1:") != std::string::npos; });
  }
  void signal(const std::string& name) const {
    if (fs::exists(file("pid")))
      std::ignore = std::system(("kill -" + name + " $(cat " + file("pid") + ") 2> /dev/null").c_str());
  }

  ScratchFolder folder_;
};

TEST_F(WorkbenchProgram, EndsCleanlyOnASignal) {
  ASSERT_TRUE(start("--keep"));
  EXPECT_THAT(content(file("said")), HasSubstr("Ctrl-C"));
  signal("TERM");
  ASSERT_TRUE(until([&] { return !content(file("ended")).empty(); }));
  EXPECT_EQ(content(file("ended")), "0\n");
}

TEST_F(WorkbenchProgram, IsTheOnlyOneOnAFolder) {
  ASSERT_TRUE(start("--keep"));
  const ProgramRun second = run_program("workbench " + campaign() + " --no-browser");
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.errors, HasSubstr("another workbench is open on this folder"));
  EXPECT_THAT(second.errors, HasSubstr("--read-only"));
}

TEST_F(WorkbenchProgram, RefusesWhatIsNotThere) {
  const ProgramRun none = run_program("workbench " + file("nothing.toml") + " --no-browser");
  EXPECT_EQ(none.exit_code, 2);
  const ProgramRun port = run_program("workbench " + campaign() + " --port 0");
  EXPECT_EQ(port.exit_code, 2);
  const ProgramRun model =
      run_program("workbench " + campaign() + " --no-browser --model " + file("no.toml"));
  EXPECT_EQ(model.exit_code, 2);
}

TEST_F(WorkbenchProgram, ASessionNamesTheLineThatIsWrong) {
  const ProgramRun run = run_program("session " + campaign() + " --do jump");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("P1_short.csv")) << "files come first";
  const std::string whole = (fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21/campaign.toml").string();
  const ProgramRun wrong = run_program("session " + whole + " --do jump");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("\"jump\" is not a command of a session"));
}

/// A model file holds no readings: what was left out is in the result alone.
TEST_F(WorkbenchProgram, ASessionWritesItsResultWithoutWhatItLeftOut) {
  const std::string whole = (fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21/campaign.toml").string();
  const std::string leave_out = "session " + whole + " --do \"leave-out 0-11 cable moved\" ";
  const ProgramRun model = run_program(leave_out + "-o " + file("model.toml"));
  EXPECT_EQ(model.exit_code, 0) << model.errors;
  EXPECT_THAT(model.output, HasSubstr("takes these readings back"));
  EXPECT_THAT(content(file("model.toml")), HasSubstr("cable moved"));
  const ProgramRun run =
      run_program(leave_out + "--result " + file("result") + " --diagnosis " + file("diagnosis"));
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("written: " + file("result")));
  EXPECT_THAT(content(file("diagnosis/diagnosis.txt")), HasSubstr("cable moved"));
  EXPECT_THAT(content(file("result/residuals.csv")), HasSubstr(",1\n"));
  EXPECT_THAT(run_program("validate " + file("result") + " " + whole).output,
              HasSubstr("the fit was made from 1,524 of 1,536 readings, those of P1_short, "));
  EXPECT_THAT(
      run_program("session " + whole + " --result " + file("same") + " --diagnosis " + file("same")).errors,
      HasSubstr("name the same folder"));
}

TEST_F(WorkbenchProgram, ASessionSaysHowItsLinesGiveParameters) {
  const std::string whole = (fs::path(VOLCAL_SOURCE_DIR) / "datasets/hidden/21/campaign.toml").string();
  const std::string line = "session " + whole + " --do \"formula EXX += dir_x * sin(x / p)";
  EXPECT_THAT(run_program(line + "\"").errors,
              HasSubstr("end the line with p=250 (held) or with p=250+-50 (estimated)"));
  const ProgramRun wrong = run_program(line + " with p=many\"");
  EXPECT_THAT(wrong.errors, ::testing::Not(HasSubstr("--parameter")));
  EXPECT_THAT(wrong.errors, HasSubstr("with p=many"));
}

}  // namespace
}  // namespace volcal::testing
