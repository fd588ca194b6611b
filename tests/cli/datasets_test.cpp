/// datasets/demo is what its study makes: the files are the committed ones, and the program makes them again.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "tests/support/dataset_files.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::content;
using testing::expect_same_numbers;
using testing::files_below;
using testing::words;

const fs::path kDemo = fs::path(VOLCAL_SOURCE_DIR) / "datasets" / "demo";
int exit_code(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Datasets, DemoHasItsChecksums) {
  EXPECT_EQ(exit_code("cd " + kDemo.string() + " && sha256sum --check --quiet SHA256SUMS"), 0)
      << "run scripts/regenerate-datasets after a change of the study or the simulator";
  std::set<std::string> listed;
  for (const std::string& word : words(content(kDemo / "SHA256SUMS"))) {
    if (word.find('.') != std::string::npos) listed.insert(word);
  }
  auto present = files_below(kDemo);
  present.erase("SHA256SUMS");
  EXPECT_EQ(present, listed);
}

TEST(Datasets, DemoIsWhatItsStudyMakes) {
  const ::volcal::testing::ScratchFolder scratch;
  const fs::path made = scratch.path() / "campaign";
  ASSERT_EQ(exit_code(std::string(VOLCAL_PROGRAM) + " simulate " + (kDemo / "study.toml").string() + " -o " +
                      made.string() + " >/dev/null"),
            0);
  const auto names = files_below(kDemo / "campaign");
  EXPECT_EQ(names, files_below(made));
  for (const std::string& name : names) {
    expect_same_numbers(name, content(kDemo / "campaign" / name), content(made / name));
  }
}

}  // namespace
}  // namespace volcal
