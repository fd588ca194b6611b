/// `volcal fit` killed while it writes: the result folder is the old one or the new one, and the next run
/// works.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "tests/support/program.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::content;

const std::string kCampaign = std::string(VOLCAL_SOURCE_DIR) + "/tests/data/small/campaign.toml";

std::size_t entries(const fs::path& folder) {
  std::error_code error;
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder, error), fs::directory_iterator()));
}

/// Files in the temporary folder of a run that writes `.result.tmp-...`, -1 when there is none.
int files_being_written(const fs::path& parent) {
  for (const auto& entry : fs::directory_iterator(parent)) {
    if (entry.path().filename().string().starts_with(".result.tmp-"))
      return static_cast<int>(entries(entry.path()));
  }
  return -1;
}

class KilledFit : public ::testing::Test {
 protected:
  KilledFit() {
    std::ofstream(model_) << "format = \"volcal-model-1\"\nmachine = \""
                          << VOLCAL_SOURCE_DIR "/tests/data/small/machine.toml\"\n"
                          << "[functions]\ndefault = { basis = \"bspline\", degree = 1, knots = 1 }\n";
  }

  testing::ProgramRun fit(const fs::path& output, const std::string& more) const {
    return testing::run_program("fit " + kCampaign + " --noise white -m " + model_ + " -o " +
                                output.string() + more);
  }

  /// True when the program was killed while its temporary folder held `files` files or more.
  bool kill_while_writing(int files) const {
    const pid_t child = ::fork();
    if (child == 0) {
      const int nowhere = ::open("/dev/null", O_RDWR);
      ::dup2(nowhere, STDOUT_FILENO);
      ::dup2(nowhere, STDERR_FILENO);
      ::execl(VOLCAL_PROGRAM, "volcal", "fit", kCampaign.c_str(), "--noise", "white", "-m", model_.c_str(),
              "--keep-stated-sigma", "-o", result_.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    int status = 0;
    while (files_being_written(scratch_.path()) < files) {
      if (::waitpid(child, &status, WNOHANG) == child) return false;
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }

  static std::string tables_of(const fs::path& folder) {
    return content(folder / "residuals.csv") + content(folder / "error_tables.csv") +
           content(folder / "identified.toml");
  }

  testing::ScratchFolder scratch_;
  std::string model_ = (scratch_.path() / "model.toml").string();
  fs::path result_ = scratch_.path() / "result";
};

TEST_F(KilledFit, LeavesTheOldResultOrTheNewOne) {
  ASSERT_EQ(fit(scratch_.path() / "expected", " --keep-stated-sigma").exit_code, 0);
  ASSERT_EQ(fit(result_, "").exit_code, 0);
  const std::string before = tables_of(result_), after = tables_of(scratch_.path() / "expected");
  ASSERT_NE(before, after);
  int killed = 0;
  for (const int files : {0, 1, 3, 6}) {
    killed += kill_while_writing(files) ? 1 : 0;
    EXPECT_THAT(tables_of(result_), ::testing::AnyOf(before, after));
    EXPECT_EQ(testing::run_program("tables " + result_.string() + " -o " + (scratch_.path() / "t").string())
                  .exit_code,
              0)
        << "result.json is complete";
  }
  EXPECT_GT(killed, 0);
  ASSERT_EQ(fit(result_, " --keep-stated-sigma").exit_code, 0);
  EXPECT_EQ(tables_of(result_), after);
  EXPECT_EQ(files_being_written(scratch_.path()), -1) << "the next run removes what killed runs left";
}

}  // namespace
}  // namespace volcal
