#include "volcal/identify/words/effect_meanings.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// A kind without an entry says nothing to who is to mend the machine: its line belongs into
/// identify/words/effect_meanings.cpp.
TEST(EffectMeanings, EveryKindIsExplainedWithItsUsualCauses) {
  std::set<std::string> sentences;
  for (const EffectKind* kind : effect_kinds()) {
    const std::string& name = kind->schema().kind;
    const EffectMeaning* meaning = find_meaning(name);
    ASSERT_NE(meaning, nullptr) << name;
    EXPECT_TRUE(std::regex_match(std::string(meaning->plain), std::regex("[A-Z][^\\n]{20,150}\\."))) << name;
    EXPECT_TRUE(std::regex_match(std::string(meaning->usual_causes), std::regex("[a-z][^\\n]{15,300}[^.; ]")))
        << name;
    EXPECT_TRUE(sentences.insert(std::string(meaning->plain)).second)
        << name << ": said of another kind, too";
  }
}

TEST(EffectMeanings, WhatIsNoEffectHasNone) {
  EXPECT_EQ(find_meaning("resolution"), nullptr);
  EXPECT_EQ(find_meaning(""), nullptr);
}

}  // namespace
}  // namespace volcal
