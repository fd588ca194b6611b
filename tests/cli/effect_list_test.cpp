/// `volcal diagnose --list` against what a real diagnosis writes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::run_program;

const std::string kSmall = VOLCAL_SOURCE_DIR "/tests/data/small/campaign.toml";

/// First words of the indented lines below a title, up to the next empty line.
std::vector<std::string> listed(const std::string& text, const std::string& title) {
  std::istringstream lines(text.substr(text.find("\n" + title) + 1));
  std::vector<std::string> words;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty()) {
    words.push_back(line.substr(4, line.find("  ", 4) - 4));
  }
  return words;
}

/// What stands for names of the files becomes a wildcard: "station STATION" lists "station P1".
bool is_listed(const std::vector<std::string>& words, const std::string& name) {
  static const std::regex special("[().^$|*+?-]");
  static const std::regex place("[A-Z]{3,}");
  return std::ranges::any_of(words, [&](const std::string& word) {
    if (word == "TARGET" || word == "VARIABLES" || word == "EXPRESSION") return false;  // of custom effects
    const std::string literal = std::regex_replace(word, special, "\\$&");
    return std::regex_match(name, std::regex(std::regex_replace(literal, place, ".+")));
  });
}

TEST(EffectList, HoldsEveryIdentifierOfARealDiagnosis) {
  const std::string list = run_program("diagnose --list").output;
  const auto kinds = [&](const std::string& kind) {
    return list.find("\n" + kind + "\n") != std::string::npos;
  };
  const auto targets = listed(list, "Targets");
  const auto drivers = listed(list, "Drivers");
  const auto shapes = listed(list, "Shapes");
  const auto variables = listed(list, "Variables");
  ASSERT_GT(targets.size(), 5U);
  ASSERT_GT(drivers.size(), 5U);
  ASSERT_GT(shapes.size(), 5U);

  const auto run = run_program("diagnose " + kSmall + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json diagnosis = Json::parse(run.output);
  const auto named = run_program("diagnose " + kSmall + " --list --json");
  ASSERT_EQ(named.exit_code, 0) << named.errors;
  const Json testable = Json::parse(named.output).at("testable");
  std::size_t effects = 0;
  for (const char* key : {"effects", "one_of", "not_visible", "model_changes", "ranking", "detectable"}) {
    for (const Json& effect : diagnosis.at(key)) {
      ++effects;
      const std::string kind = effect.at("kind"), target = effect.at("target");
      const std::string driver = effect.at("driver"), shape = effect.at("shape");
      EXPECT_TRUE(kinds(kind)) << kind;
      EXPECT_TRUE(is_listed(targets, target)) << target;
      EXPECT_TRUE(is_listed(drivers, driver)) << driver;
      EXPECT_TRUE(is_listed(shapes, shape)) << shape;
      EXPECT_THAT(testable, Contains(kind + ":" + target + ":" + driver + ":" + shape)) << key;
    }
  }
  EXPECT_GT(effects, 50U);
  for (const Json& unknown : diagnosis.at("unknown")) {
    for (const Json& variable : unknown.at("variables")) {
      EXPECT_TRUE(is_listed(variables, variable.get<std::string>())) << variable;
    }
  }
}

TEST(EffectList, SaysWhatEveryWordMeans) {
  const auto run = run_program("diagnose --list --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json list = Json::parse(run.output);
  EXPECT_GT(list.at("kinds").size(), 20U);
  std::set<std::string> kinds;
  for (const Json& kind : list.at("kinds")) {
    EXPECT_FALSE(kind.at("summary").get<std::string>().empty());
    EXPECT_TRUE(kinds.insert(kind.at("kind")).second);
  }
  EXPECT_TRUE(kinds.contains("reversal"));
  for (const char* key : {"targets", "drivers", "shapes", "variables"}) {
    for (const Json& word : list.at(key)) {
      EXPECT_FALSE(word.at("name").get<std::string>().empty()) << key;
      EXPECT_FALSE(word.at("meaning").get<std::string>().empty()) << word;
    }
  }
  EXPECT_EQ(list.at("directions"), (Json{"X", "Y", "Z", "beam"}));
  EXPECT_FALSE(list.contains("testable"));
}

TEST(EffectList, OfACampaignHasItsOwnNames) {
  const std::string list = run_program("diagnose " + kSmall + " --list").output;
  EXPECT_THAT(list, HasSubstr("reversal:EXX:dir_x:step"));
  EXPECT_THAT(list, HasSubstr("resolution:EXX:x:finer"));
  const auto nowhere = run_program("diagnose nowhere.toml --list");
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.errors, HasSubstr("nowhere.toml"));
}

}  // namespace
}  // namespace volcal
