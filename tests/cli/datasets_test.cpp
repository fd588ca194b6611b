/// datasets/demo is what its study makes: the files are the committed ones, and the program makes them again.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;

const fs::path kDemo = fs::path(VOLCAL_SOURCE_DIR) / "datasets" / "demo";
constexpr double kLastDigits = 2.5e-7;  // two of the seventh decimal, with which lengths are written

int exit_code(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::set<std::string> files_below(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename() != ".volcal") {
      names.insert(fs::relative(entry.path(), folder).string());
    }
  }
  return names;
}

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> all;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of(", \n[]", begin), text.size());
    all.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return all;
}

bool same_word(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char* end_a = nullptr;
  char* end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a);
  const double y = std::strtod(b.c_str(), &end_b);
  return !a.empty() && !b.empty() && *end_a == '\0' && *end_b == '\0' &&
         std::abs(x - y) <= kLastDigits * std::max(1.0, std::abs(x) * 1e-3);
}

void expect_same_numbers(const std::string& name, const std::string& committed, const std::string& made) {
  const auto expected = words(committed);
  const auto found = words(made);
  ASSERT_EQ(expected.size(), found.size()) << name;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_TRUE(same_word(expected[i], found[i])) << name << ": " << expected[i] << " became " << found[i];
  }
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
