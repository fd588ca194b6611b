/// The verdict of `volcal try` on readings that no fit has seen.

#include "volcal/identify/report/text/criticism/tried_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  return tried;
}

std::string said_of(const TriedEffect& tried) { return tried_text("EXX: dir_x", tried); }

TEST(TriedText, PredictsBetterOrNoBetter) {
  EXPECT_THAT(said_of(tried_with(300.0, 210.0)), HasSubstr("chi2 less by 90.0: it predicts better\n"));
  EXPECT_THAT(said_of(tried_with(210.0, 300.0)), HasSubstr("chi2 more by 90.0: it predicts no better\n"));
  EXPECT_THAT(said_of(tried_with(210.0, 209.99)), HasSubstr("it predicts better\n"));
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
