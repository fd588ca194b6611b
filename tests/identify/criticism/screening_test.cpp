// The scans that a fit ends with: silent where nothing is missing, and a word where something is.

#include "volcal/identify/criticism/screening.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

/// Screened once, by one thread.
const FittedStudy& study_with_backlash() {
  static const FittedStudy study(hiding({testing_support::reversal("EYY", 1.2e-6)}));
  return study;
}
const Screening& screening_of_backlash() {
  static const Screening made =
      screen(study_with_backlash().simulated.campaign, study_with_backlash().result, 1);
  return made;
}

double residual_rms(const FitResult& result) {
  double squares = 0.0;
  for (const ResidualRecord& record : result.residuals) squares += record.residual() * record.residual();
  return std::sqrt(squares / static_cast<double>(result.residuals.size()));
}

void expect_contradiction(const Screening& screening, FitResult result) {
  EXPECT_TRUE(screening.contradicts) << screening.leading << " " << screening.log10_p;
  EXPECT_GT(screening.rms, 0.1e-6) << screening.leading;
  EXPECT_LT(screening.rms, residual_rms(result)) << "nothing explains more than there is";
  const std::size_t before = result.findings.size();
  result.status = FitStatus::Ok;
  judge(screening, result);
  EXPECT_EQ(result.status, FitStatus::LackOfFit);
  ASSERT_EQ(result.findings.size(), before + 1);
  EXPECT_EQ(result.findings.back().code, FindingCode::ModelContradicted);
  EXPECT_EQ(result.findings.back().text("leading"), screening.leading);
}

TEST(Screening, ContradictsAFitThatLacksAnEffect) {
  expect_contradiction(screening_of_backlash(), study_with_backlash().result);
  const FittedStudy tilted(hiding({tilt_by_temperature()}));
  expect_contradiction(screen(tilted.simulated.campaign, tilted.result, 1), tilted.result);
}

TEST(Screening, SeesASampleOfManyReadings) {
  const FittedStudy& study = study_with_backlash();
  const std::size_t all = study.result.residuals.size();
  const Screening sampled = screen(study.simulated.campaign, study.result, 1, all / 3);
  EXPECT_EQ(sampled.observations, all / 3);
  EXPECT_TRUE(sampled.of_a_sample);
  expect_contradiction(sampled, study.result);
  EXPECT_EQ(finding_of(sampled)->count("sampled"), static_cast<std::int64_t>(all / 3));
  EXPECT_FALSE(screening_of_backlash().of_a_sample);
  EXPECT_FALSE(finding_of(screening_of_backlash())->has("sampled"));
}

TEST(Screening, SeesASampleOfManySetups) {
  const FittedStudy& study = study_with_backlash();
  constexpr std::size_t kFew = 5;
  ASSERT_GT(study.simulated.campaign.setups.size(), kFew);
  const std::size_t all = study.result.residuals.size();
  const Screening sampled = screen(study.simulated.campaign, study.result, 1, all, kFew);
  EXPECT_LT(sampled.observations, all);
  EXPECT_GT(sampled.observations, all / 3);
  EXPECT_TRUE(sampled.of_a_sample);
  expect_contradiction(sampled, study.result);
}

TEST(Screening, DoesNotDependOnThreads) {
  const Screening& one = screening_of_backlash();
  const Screening three = screen(study_with_backlash().simulated.campaign, study_with_backlash().result, 3);
  EXPECT_EQ(one.leading, three.leading);
  EXPECT_EQ(one.log10_p, three.log10_p);
}

}  // namespace
}  // namespace volcal
