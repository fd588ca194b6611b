#include "volcal/identify/criticism/data/search_rules.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace volcal {
namespace {

TEST(SearchRules, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  std::set<SearchRule> rules;
  for (const SearchRule rule : search_rules()) {
    EXPECT_TRUE(names.insert(name_of(rule)).second) << name_of(rule);
    EXPECT_FALSE(description_of(rule).empty());
    EXPECT_EQ(search_rule_of(name_of(rule)), rule);
    rules.insert(rule);
  }
  EXPECT_EQ(rules.size(), static_cast<std::size_t>(SearchRule::CertainVariable) + 1) << "every rule once";
  EXPECT_EQ(search_rule_of("gut-feeling"), std::nullopt);
}

TEST(SearchRules, DecideWhereTheyAreFollowedAndTheirConditionHolds) {
  std::vector<SearchRule> told;
  const SearchRules rules{{SearchRule::Recheck}, [&told](SearchRule rule) { told.push_back(rule); }};
  EXPECT_TRUE(rules.decide(SearchRule::Exchange, [] { return true; }));
  EXPECT_FALSE(rules.decide(SearchRule::Departure, [] { return false; }));
  bool asked = false;
  EXPECT_FALSE(rules.decide(SearchRule::Recheck, [&asked] { return asked = true; }));
  EXPECT_FALSE(asked) << "what is left out is not asked for";
  EXPECT_EQ(told, std::vector{SearchRule::Exchange});
}

}  // namespace
}  // namespace volcal
