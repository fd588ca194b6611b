/// What pages name exists, and the code of docs/guides/from-a-campaign-to-tables.md is the one that
/// tests/consumer runs. What the pages' commands print is compared by scripts/check-guides.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using testing::content;

const fs::path kSource = VOLCAL_SOURCE_DIR;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Lines of the fenced block of the guide that begins with `fence` and holds the line `with`.
std::vector<std::string> block_of_guide(const std::string& fence, const std::string& with,
                                        const std::string& guide = "from-a-campaign-to-tables.md") {
  std::vector<std::string> block;
  bool open = false, inside = false;
  for (const std::string& line : lines_of(content(kSource / "docs/guides" / guide))) {
    if (line.starts_with("```")) {
      for (const std::string& each : block) {
        if (inside && each.find(with) != std::string::npos) return block;
      }
      open = !open;
      inside = open && line == fence;
      block.clear();
    } else if (inside) {
      block.push_back(line);
    }
  }
  return {};
}

/// Suites and tests that the sources define: "Suite.Test".
std::set<std::string> tests_of_the_sources() {
  static const std::regex kTest(R"(\nTEST(?:_F|_P)?\((\w+),\s*(\w+)\))");
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string source = content(entry.path());
    for (std::sregex_iterator match(source.begin(), source.end(), kTest), end; match != end; ++match)
      names.insert((*match)[1].str() + "." + (*match)[2].str());
  }
  return names;
}

TEST(EvidencePage, NamesTestsAndScriptsThatExist) {
  static const std::regex kTest("`([A-Z]\\w+\\.[A-Z]\\w+)`"), kScript("`(scripts/[a-z0-9-]+)");
  const std::set<std::string> tests = tests_of_the_sources();
  const std::string page = content(kSource / "docs/evidence.md");
  std::size_t named = 0;
  for (std::sregex_iterator match(page.begin(), page.end(), kTest), end; match != end; ++match, ++named)
    EXPECT_TRUE(tests.contains((*match)[1].str())) << (*match)[1].str();
  EXPECT_GT(named, 60U);
  for (std::sregex_iterator match(page.begin(), page.end(), kScript), end; match != end; ++match)
    EXPECT_TRUE(fs::exists(kSource / (*match)[1].str())) << (*match)[1].str();
}

TEST(Guide, ShowsTheProgramThatTheConsumerTestRuns) {
  const auto consumer = lines_of(content(kSource / "tests/consumer/main.cpp"));
  const auto shown = block_of_guide("```cpp", "read_campaign");
  ASSERT_FALSE(shown.empty());
  EXPECT_THAT(consumer, ::testing::IsSupersetOf(shown));
}

}  // namespace
}  // namespace volcal
