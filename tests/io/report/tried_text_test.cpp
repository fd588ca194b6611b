/// The verdict of `volcal try` on readings that no fit has seen.

#include "volcal/identify/report/text/criticism/tried_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TriedEffect tried_with(double chi2_without, double chi2_with) {
  TriedEffect tried;
  tried.values = {{"amplitude", "um", 1.4, 0.1}};
  tried.judged = true;
  for (Comparison* comparison : {&tried.without, &tried.with}) {
    comparison->total.observations = 200;
    comparison->total.lengths = {200, 0.0, 1e-6, 3e-6};
  }
  tried.without.total.chi2 = chi2_without;
  tried.with.total.chi2 = chi2_with;
  tried.gain = {chi2_without - chi2_with, 3.84};
  return tried;
}

std::string said_of(const TriedEffect& tried) { return tried_text("EXX: dir_x", tried); }

TEST(TriedText, PredictsBetterOrWorseByMoreThanChance) {
  EXPECT_THAT(said_of(tried_with(300.0, 210.0)),
              HasSubstr("chi2 less by 90.0, by chance up to 3.8: it predicts better\n"));
  EXPECT_THAT(said_of(tried_with(210.0, 300.0)),
              HasSubstr("chi2 more by 90.0, by chance up to 3.8: it predicts worse\n"));
  for (const double change : {0.0946, 0.3, 3.8, -3.8}) {
    const std::string said = said_of(tried_with(210.0, 210.0 - change));
    EXPECT_THAT(said, HasSubstr(": no difference that the held-out readings could show\n")) << change;
    EXPECT_THAT(said, Not(HasSubstr("it predicts"))) << change;
  }
}

/// 1.96 u as everywhere; u itself in the file for programs.
TEST(TriedText, TheUncertaintyIsExpanded) {
  const TriedEffect tried = tried_with(300.0, 210.0);
  EXPECT_THAT(said_of(tried), HasSubstr("EXX: dir_x: amplitude 1.40 +- 0.20 um\n"));
  const auto json = nlohmann::json::parse(tried_json("EXX: dir_x", tried));
  EXPECT_EQ(json.at("values").at(0).at("u"), 0.1);
  EXPECT_NEAR(json.at("held_out").at("chi2_less_by").get<double>(), 90.0, 1e-9);
  EXPECT_EQ(json.at("held_out").at("chi2_by_chance"), 3.84);
}

TEST(TriedText, RoundingIsNoVerdict) {
  for (const double change : {4.8e-9, 0.0, -4.8e-9}) {
    const std::string said = said_of(tried_with(210.0, 210.0 - change));
    EXPECT_THAT(said, HasSubstr("chi2 the same: it predicts neither better nor worse\n")) << change;
  }
}

TEST(TriedText, NoVerdictOnWhatIsNotVisible) {
  for (const double change : {4.8e-9, 20.0, -20.0}) {
    TriedEffect tried = tried_with(210.0, 210.0 - change);
    tried.not_visible = "no reading changes with it";
    const std::string said = said_of(tried);
    EXPECT_THAT(said, HasSubstr("no verdict on an effect that is not visible\n")) << change;
    EXPECT_THAT(said, Not(HasSubstr("it predicts"))) << change;
  }
}

}  // namespace
}  // namespace volcal
