// The scans that a fit ends with: silent where nothing is missing, and a word where something is.

#include "volcal/identify/criticism/screening.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/hidden_studies.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;
using testing_support::hiding;

sim::HiddenEffect tilt_by_temperature() {
  sim::HiddenEffect effect{.kind = "thermal-tilt", .options = {}, .rms = 1.5e-6};
  effect.options.set("symbol", std::string("EBX"));
  effect.options.set("channel", std::string("column"));
  return effect;
}

TEST(Screening, IsSilentWhereNothingIsMissing) {
  FittedStudy study(hiding({}));
  const Screening screening = screen(study.simulated.campaign, study.result, 1);
  EXPECT_FALSE(screening.contradicts) << screening.leading << " " << screening.log10_p;
  EXPECT_GT(screening.tests, 500U);
  EXPECT_FALSE(finding_of(screening));
  judge(screening, study.result);
  EXPECT_EQ(study.result.status, FitStatus::Ok);
}

TEST(Screening, ContradictsAFitThatLacksAnEffect) {
  for (const sim::HiddenEffect& effect : {testing_support::reversal("EYY", 1.2e-6), tilt_by_temperature()}) {
    FittedStudy study(hiding({effect}));
    const Screening screening = screen(study.simulated.campaign, study.result, 1);
    EXPECT_TRUE(screening.contradicts) << effect.kind << " " << screening.log10_p;
    EXPECT_GT(screening.rms, 0.3e-6) << effect.kind;
    const std::size_t before = study.result.findings.size();
    study.result.status = FitStatus::Ok;
    judge(screening, study.result);
    EXPECT_EQ(study.result.status, FitStatus::LackOfFit);
    ASSERT_EQ(study.result.findings.size(), before + 1);
    EXPECT_EQ(study.result.findings.back().code, FindingCode::ModelContradicted);
    EXPECT_EQ(study.result.findings.back().text("leading"), screening.leading);
  }
}

TEST(Screening, DoesNotDependOnThreads) {
  const FittedStudy study(hiding({testing_support::reversal("EYY", 1.2e-6)}));
  const Screening one = screen(study.simulated.campaign, study.result, 1);
  const Screening three = screen(study.simulated.campaign, study.result, 3);
  EXPECT_EQ(one.leading, three.leading);
  EXPECT_EQ(one.log10_p, three.log10_p);
}

}  // namespace
}  // namespace volcal
