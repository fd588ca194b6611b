#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// A kind without these words says nothing to who is to mend the machine: `plain` and `usual_causes` of its
/// schema.
TEST(EffectMeanings, EveryKindIsExplainedWithItsUsualCauses) {
  std::set<std::string> sentences;
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSchema& schema = kind->schema();
    EXPECT_TRUE(std::regex_match(schema.plain, std::regex("[A-Z][^\\n]{20,150}\\."))) << schema.kind;
    EXPECT_TRUE(std::regex_match(schema.usual_causes, std::regex("[a-z][^\\n]{15,300}[^.; ]")))
        << schema.kind;
    EXPECT_TRUE(sentences.insert(schema.plain).second) << schema.kind << ": said of another kind, too";
  }
}

TEST(EffectMeanings, WhatIsNoEffectHasNone) {
  EXPECT_EQ(find_effect("resolution"), nullptr);
  EXPECT_EQ(find_effect(""), nullptr);
}

}  // namespace
}  // namespace volcal
