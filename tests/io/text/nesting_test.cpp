#include "volcal/identify/text/nesting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/io/results/result_json.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

std::string repeated(const std::string& piece, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += piece;
  return text;
}

template <class Read>
InputError refusal_of_nesting(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error;
  }
  return {{}, "nothing was refused", ""};
}

TEST(Nesting, TellsTheLineWhereItIsTooDeep) {
  const InputError error = refusal_of_nesting(
      [] { require_shallow("a = 1\nb = " + repeated("[", 10000) + "\n", NestedText::Toml, "machine.toml"); });
  EXPECT_THAT(error.problem(), HasSubstr("nested deeper than 100"));
  EXPECT_EQ(error.place().line, 2);
}

TEST(Nesting, CountsKeysJoinedByDots) {
  const std::string dots = repeated("a . ", 10000) + "a = 1\n";
  EXPECT_THAT(refusal_of_nesting([&] { require_shallow(dots, NestedText::Toml, "m"); }).problem(),
              HasSubstr("nested"));
}

TEST(Nesting, LeavesTextsAndCommentsAlone) {
  const std::string brackets = repeated("[{.", 1000);
  const std::string quoted = "a = \"" + brackets + "\\\"" + brackets + "\"\nb = '" + brackets +
                             "'\nc = \"\"\"\n" + brackets + "\n\"\"\"\nd = '''\n" + brackets + "'\n'''\n# " +
                             brackets + "\n" + repeated("e = [[1.5, 2.5]]\n", 200);
  EXPECT_NO_THROW(require_shallow(quoted, NestedText::Toml, "machine.toml"));
  EXPECT_NO_THROW(require_shallow("[\"" + brackets + "'\", 1.5]", NestedText::Json, "result.json"));
}

TEST(Nesting, EveryReaderAsksFirst) {
  const std::string deep = repeated("[", 100000);
  EXPECT_THAT(refusal_of_nesting([&] { parse_machine("a = " + deep, "machine.toml"); }).problem(),
              HasSubstr("nested"));
  EXPECT_THAT(
      refusal_of_nesting([&] { parse_machine("a = " + repeated("{a=", 10000), "machine.toml"); }).problem(),
      HasSubstr("nested"));
  EXPECT_THAT(refusal_of_nesting([&] { result_from_json(deep, "result.json"); }).problem(),
              HasSubstr("nested"));
  EXPECT_THAT(refusal_of_nesting([&] { diagnosis_from_json(deep, "diagnosis.json"); }).problem(),
              HasSubstr("nested"));
}

TEST(JsonInput, SaysInWordsWhatIsWrong) {
  const auto problem = [](const std::string& text) {
    return refusal_of_nesting([&] { result_from_json(text, "result.json"); }).problem();
  };
  EXPECT_THAT(problem("{}"), HasSubstr("the key format is missing"));
  EXPECT_THAT(problem("[1]"), HasSubstr("a value is of another type than volcal writes"));
  EXPECT_THAT(problem("{\"format\": 1}"), HasSubstr("a value is of another type than volcal writes"));
  EXPECT_THAT(problem("{\"format\": 1e999}"), HasSubstr("too large"));
  EXPECT_THAT(problem("{\"format\": "), HasSubstr("not complete JSON"));
}

}  // namespace
}  // namespace volcal
