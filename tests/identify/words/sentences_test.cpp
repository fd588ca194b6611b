// Findings: every code has one name, one sentence and keeps its data in JSON.

#include "volcal/identify/words/sentences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>
#include <stdexcept>

#include "tests/identify/words/finding_examples.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One at least of every code.
const std::vector<WordedFinding>& examples() {
  static const std::vector<WordedFinding> all = [] {
    std::vector<WordedFinding> joined = {{verbatim("as it was"), "as it was"}};
    for (const auto& part :
         {examples_of_readings(), examples_of_fit(), examples_of_criticism(), examples_of_errors()})
      joined.insert(joined.end(), part.begin(), part.end());
    return joined;
  }();
  return all;
}

TEST(FindingCodes, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const FindingCodeRow& row : finding_codes()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(row.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz.-"), std::string_view::npos) << row.name;
    EXPECT_EQ(finding_code(row.name), row.code);
  }
  EXPECT_EQ(finding_codes().size(), static_cast<std::size_t>(FindingCode::End));
  EXPECT_EQ(finding_code("rank"), std::nullopt);
}

TEST(Sentences, AreMadeByOneFunctionForEveryCode) {
  std::set<FindingCode> codes;
  for (const SentenceMaker& maker : sentence_makers())
    EXPECT_TRUE(codes.insert(maker.code).second) << to_string(maker.code);
  EXPECT_EQ(codes.size(), finding_codes().size());
}

TEST(Sentences, SayWhatIsFoundOfEveryCode) {
  std::set<FindingCode> seen;
  for (const WordedFinding& example : examples()) {
    EXPECT_EQ(sentence(example.finding), example.sentence);
    seen.insert(example.finding.code);
  }
  EXPECT_EQ(seen.size(), finding_codes().size());
}

/// "{}", "{0}", "{:.2f}" of a format that was never applied; "{ dir_x = -1 }" is TOML.
TEST(Sentences, HoldNoPlaceholder) {
  const std::regex placeholder(R"(\{[0-9]*(:[^}]*)?\})");
  for (const WordedFinding& example : examples())
    EXPECT_FALSE(std::regex_search(sentence(example.finding), placeholder)) << sentence(example.finding);
}

/// Sources that may find something: all but those that name and word the codes.
std::string sources_that_find() {
  std::string text;
  const std::filesystem::path root = VOLCAL_SOURCE_DIR;
  for (const char* part : {"model", "identify", "studies"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / part)) {
      const std::string path = entry.path().generic_string();
      const bool words =
          path.find("identify/words") != std::string::npos || path.ends_with("/finding_codes.h");
      if (words || !(path.ends_with(".cpp") || path.ends_with(".h"))) continue;
      std::ifstream file(entry.path());
      text.append(std::istreambuf_iterator<char>(file), {});
    }
  }
  return text;
}

/// Names of the enumeration in its order, from its header.
std::vector<std::string> names_of_codes() {
  std::ifstream file(std::filesystem::path(VOLCAL_SOURCE_DIR) / "model/description/finding_codes.h");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto from = text.find("enum class FindingCode"), to = text.find("  End,", from);
  const std::string enumeration = text.substr(from, to - from);
  const std::regex name(R"(\n  (\w+),)");
  std::vector<std::string> names;
  for (std::sregex_iterator found(enumeration.begin(), enumeration.end(), name), end; found != end; ++found)
    names.push_back((*found)[1]);
  return names;
}

/// docs/findings.md has a row of every code, with the sentence of its first example.
TEST(FindingCodes, StandOnTheirPage) {
  std::ifstream file(std::filesystem::path(VOLCAL_SOURCE_DIR) / "docs/findings.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  for (const FindingCodeRow& row : finding_codes()) {
    const auto example = std::ranges::find_if(
        examples(), [&](const WordedFinding& each) { return each.finding.code == row.code; });
    const std::string as = row.code == FindingCode::Verbatim ? "" : example->sentence + " |\n";
    EXPECT_THAT(page, HasSubstr("\n| `" + std::string(row.name) + "` | " +
                                std::string(to_string(row.severity)) + " | " + as));
  }
}

TEST(FindingCodes, AreAllFoundSomewhere) {
  const std::string sources = sources_that_find();
  const std::vector<std::string> names = names_of_codes();
  ASSERT_EQ(names.size(), finding_codes().size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::regex use("FindingCode::" + names[i] + R"(\b)");
    EXPECT_TRUE(std::regex_search(sources, use)) << names[i] << ", " << finding_codes()[i].name;
  }
}

TEST(Sentences, AreRefusedWithoutTheirData) {
  EXPECT_THROW(sentence({FindingCode::ReadingsRemoved}), std::invalid_argument);
  EXPECT_THROW(sentence({FindingCode::ReadingsRemoved, {{"readings", "many"}}}), std::invalid_argument);
  EXPECT_THROW(sentence({FindingCode::NotVisibleExchangeable,
                         {{"error", "EXX"}, {"partners", Texts{"EYX"}}, {"remedies", Texts{"pray"}}}}),
               std::invalid_argument);
  EXPECT_THROW(explanation(Finding{FindingCode::FitNotConverged}), std::invalid_argument);
  EXPECT_THAT(explanation(std::nullopt).reason, IsEmpty());
}

TEST(FindingJson, ReturnsEveryFinding) {
  for (const WordedFinding& example : examples()) {
    const auto json = nlohmann::ordered_json::parse(finding_json(example.finding).dump());
    EXPECT_EQ(json.at("code"), to_string(example.finding.code));
    EXPECT_EQ(json.at("severity"), to_string(example.finding.severity()));
    EXPECT_EQ(finding_from(json, verbatim("")), example.finding) << json;
  }
  const Finding none{
      FindingCode::NoiseSeveralTimesStated,
      {{"instrument", "angle"}, {"times", FindingNumber{std::numeric_limits<double>::infinity()}}}};
  EXPECT_EQ(finding_from(finding_json(none), verbatim("")), none);
}

TEST(FindingJson, TakesTheSentenceWhereTheCodeIsNotKnown) {
  const nlohmann::ordered_json later = {{"code", "rank.of-another-version"}, {"data", {{"x", 1}}}};
  EXPECT_EQ(finding_from(later, verbatim("in words")), verbatim("in words"));
  EXPECT_THAT(findings_from({}, {"one", "two"}), ::testing::ElementsAre(verbatim("one"), verbatim("two")));
  EXPECT_THROW(findings_from(nlohmann::ordered_json::array({later}), {"one", "two"}), std::invalid_argument);
  EXPECT_ANY_THROW(
      finding_from({{"code", "readings.removed"}, {"data", {{"readings", "many"}}}}, verbatim("")));
}

TEST(FindingJson, NotesStandInWordsAndAsCodes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  add_notes({}, json);
  EXPECT_TRUE(json.empty());
  add_notes({{FindingCode::ReadingsDuplicated, {{"setup", "X2"}, {"first_setup", "X"}}}}, json);
  EXPECT_THAT(json.at("notes").at(0).get<std::string>(), EndsWith("they count twice; remove one of them"));
  EXPECT_EQ(json.at("notes_findings").at(0).at("code"), "readings.duplicated");
}

}  // namespace
}  // namespace volcal
