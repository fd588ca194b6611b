// The steps of a search, each on its own: a climb, and the comparison with rivals.

#include "volcal/identify/criticism/search/climb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/search/rivals.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;

const FittedStudy& study_of_reversal() {
  static const FittedStudy study(
      testing_support::hiding({testing_support::reversal("EXX", 0.7e-6)}, {5, 4, 4}));
  return study;
}

Reached nothing_added() {
  const LinearModel& model = study_of_reversal().model;
  const auto setting = std::make_shared<const SearchSetting>(model, std::vector<bool>(model.size(), false),
                                                             std::vector<std::string>{}, 1);
  return Reached(ModelState(model, setting));
}

const Reached& climbed_by_reversal() {
  static const Reached reached = Climb(nothing_added(), SearchOptions{}).run();
  return reached;
}

std::size_t family_of_reversal() {
  const std::vector<Family>& families = climbed_by_reversal().setting().families;
  const auto found = std::ranges::find_if(families, [](const Family& family) {
    return family.name().kind == "reversal" && family.name().target.name() == "EXX";
  });
  return static_cast<std::size_t>(found - families.begin());
}

TEST(Climb, AddsWhatExceeds) {
  EXPECT_TRUE(climbed_by_reversal().given.is_tested());
  EXPECT_TRUE(climbed_by_reversal().given.added().empty());
  EXPECT_TRUE(climbed_by_reversal().state.is_tested());
  EXPECT_TRUE(climbed_by_reversal().state.has(family_of_reversal()));
}

TEST(Climb, GoesNoFurtherThanItMay) {
  SearchOptions options;
  options.most = 0;
  const Reached reached = Climb(nothing_added(), options).run();
  EXPECT_TRUE(reached.state.is_tested());
  EXPECT_TRUE(reached.state.added().empty());
}

TEST(Rivals, KeepANameThatStands) {
  const SearchOptions options;
  const Reached settled =
      Rivals(climbed_by_reversal(), options).settle([](Reached changed) { return changed; });
  EXPECT_TRUE(settled.state.has(family_of_reversal()));
  EXPECT_FALSE(settled.dropped.contains(family_of_reversal()));
}

}  // namespace
}  // namespace volcal
