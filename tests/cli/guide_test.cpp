/// Guides quote the program: their lines are those that the program prints, and the code of
/// docs/guides/from-a-campaign-to-tables.md is the one that tests/consumer runs.

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

void expect_quoted(const std::vector<std::string>& block, const std::string& text) {
  const auto printed = lines_of(text);
  ASSERT_FALSE(block.empty());
  for (const std::string& line : block) {
    if (line == "  ...") continue;
    const auto quoted = [&](const std::string& each) { return each.starts_with(line); };
    EXPECT_TRUE(std::ranges::any_of(printed, quoted))
        << "the guide quotes \"" << line << "\", the program prints\n"
        << text;
  }
}

std::string run(const std::string& arguments) {
  const auto outcome = testing::run_program(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  return outcome.output;
}

TEST(Guide, QuotesWhatTheProgramPrints) {
  const testing::ScratchFolder scratch;
  const std::string demo = (kSource / "datasets/demo/campaign").string();
  const std::string result = (scratch.path() / "result").string();
  expect_quoted(block_of_guide("```", "Demo: cross-table"),
                run("fit " + demo + "/campaign.toml --model " + demo + "/model.toml -o " + result));
  const std::string validation = run("validate " + result + " " + demo + "/truth/campaign.toml");
  expect_quoted(block_of_guide("```", "RMS before"), validation);
  std::string comparison = run("compare " + demo + "/campaign.toml " + result);
  ASSERT_TRUE(comparison.starts_with(result));
  comparison.replace(0, result.size(), "out/demo/result");
  expect_quoted(block_of_guide("```", "no failure found"), comparison);
  expect_quoted(block_of_guide("```", "Circular tests"), comparison);
}

TEST(Guide, PlansTheCampaignThatItQuotes) {
  const testing::ScratchFolder scratch;
  const std::string guide = "plan-a-campaign.md", machine = (kSource / "datasets/demo/machine.toml").string();
  expect_quoted(block_of_guide("```", "may be off", guide),
                run("plan " + machine + " --stations 4 --readings 960"));
  const auto one_tool = testing::run_program("plan " + machine + " --tools short --readings 480");
  EXPECT_EQ(one_tool.exit_code, 1) << one_tool.errors;
  expect_quoted(block_of_guide("```", "makes visible", guide), one_tool.output);
}

TEST(Guide, PlansTheBallBarCampaignThatItQuotes) {
  const testing::ScratchFolder scratch;
  const std::string guide = "plan-a-campaign.md", machine = (kSource / "datasets/demo/machine.toml").string();
  const std::string model = (scratch.path() / "quadratic.toml").string();
  std::ofstream file(model);
  for (const std::string& line : block_of_guide("```toml", "legendre", guide))
    file << (line.starts_with("machine") ? "machine = \"" + machine + "\"" : line) << "\n";
  file.close();
  const std::string bar =
      "plan " + machine + " --model " + model + " --instrument ball-bar --bar-mm 150 --bar-sigma-um 0.5";
  expect_quoted(block_of_guide("```", "3 places of ball-bar", guide),
                run(bar + " --stations 3 --readings 1200"));
  const auto two_places = testing::run_program(bar + " --stations 2 --readings 1200");
  EXPECT_EQ(two_places.exit_code, 1) << two_places.errors;
  expect_quoted(block_of_guide("```", "a further place", guide), two_places.output);
}

/// A command of a guide and the lines that it quotes of what is printed.
struct Quotation {
  std::string command;
  std::vector<std::string> lines;
};

/// Commands of volcal in the fenced blocks, in their order; those of other programs are left out.
std::vector<Quotation> quotations_of(const std::string& guide) {
  const std::string prompt = "$ ";
  std::vector<Quotation> all;
  bool open = false, ours = false;
  for (const std::string& line : lines_of(content(kSource / "docs/guides" / guide))) {
    if (line.starts_with("```")) {
      open = !open;
      ours = false;
    } else if (open && line.starts_with(prompt)) {
      const std::string command = line.substr(0, line.find(" #")).substr(prompt.size());
      ours = command.starts_with("volcal ");
      if (ours) all.push_back({command.substr(std::string("volcal ").size()), {}});
    } else if (ours && !line.empty()) {
      all.back().lines.push_back(line);
    }
  }
  return all;
}

/// Every command of the story, one after another in one folder, prints what the guide quotes.
TEST(Guide, FindsTheMissingEffectAsItTells) {
  const testing::ScratchFolder scratch;
  fs::create_directory_symlink(kSource / "datasets", scratch.path() / "datasets");
  const fs::path before = fs::current_path();
  fs::current_path(scratch.path());
  const std::vector<Quotation> story = quotations_of("find-the-missing-effect.md");
  EXPECT_GE(story.size(), 9U);
  for (const auto& [command, lines] : story) {
    const auto outcome = testing::run_program(command);
    EXPECT_EQ(outcome.exit_code, 0) << command << "\n" << outcome.errors;
    if (!lines.empty()) expect_quoted(lines, outcome.output);
  }
  fs::current_path(before);
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
