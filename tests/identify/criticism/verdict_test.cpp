// Verdicts of diagnoses made by hand.

#include "volcal/identify/criticism/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

EffectFinding backlash() {
  EffectFinding finding;
  finding.name = EffectName::of_parts("reversal", "EYY", "dir_y", "step");
  finding.label = "EYY reversal";
  finding.amplitudes = {{"EYY reversal", 1.5e-6, 0.1e-6, 0.4e-6, "um", 1e-6}};
  return finding;
}

/// Systematic errors of held-out readings before and after, m, and the lower end of the last one's interval.
std::vector<LadderStep> ladder(double before, double after, double low) {
  LadderStep first, last;
  first.systematic = before;
  last.systematic = after;
  last.systematic_low = low;
  return {first, last};
}

Diagnosis named() {
  Diagnosis diagnosis;
  diagnosis.effects = {backlash()};
  diagnosis.ladder = ladder(2e-6, 0.1e-6, 0.0);
  return diagnosis;
}

UnknownFinding unknown(const std::vector<std::string>& variables, double log10_p) {
  UnknownFinding finding;
  finding.variables = testing_support::variables_named(variables);
  finding.direction = ScanDirection::X;
  finding.rms = 0.5e-6;
  finding.log10_p = log10_p;
  return finding;
}

TEST(Verdict, NamedWithAmplitudeAndU) {
  Diagnosis diagnosis = named();
  conclude({}, diagnosis);
  EXPECT_EQ(to_string(diagnosis.verdict), "NAMED");
  EXPECT_THAT(sentences(diagnosis.findings),
              ElementsAre("The missing effect is: EYY reversal (reversal), EYY reversal = 1.50 +- 0.20 um"));
}

/// 0.8 of the systematic error must be gone where what is left is more than noise.
TEST(Verdict, NamesKeepAReserveWhileSomethingIsOpen) {
  Diagnosis not_reduced = named();
  not_reduced.ladder = ladder(1e-6, 0.81e-6, 0.5e-6);
  conclude({}, not_reduced);
  EXPECT_EQ(to_string(not_reduced.verdict), "NAMED_MORE_REMAINS");
  EXPECT_EQ(not_reduced.findings.back().code, FindingCode::DiagnosisHeldoutNotReduced);
  Diagnosis reduced = named();
  reduced.ladder = ladder(1e-6, 0.79e-6, 0.5e-6);
  conclude({}, reduced);
  EXPECT_EQ(to_string(reduced.verdict), "NAMED");
  Diagnosis further = named();
  conclude({.more_is_known = true, .rejected = {}, .removed_by_fit = 0}, further);
  EXPECT_EQ(to_string(further.verdict), "NAMED_MORE_REMAINS");
  Diagnosis beside = named();
  beside.unknown = {unknown({"z"}, -5.0)};
  conclude({}, beside);
  EXPECT_EQ(to_string(beside.verdict), "NAMED_MORE_REMAINS");
  EXPECT_EQ(sentence(beside.findings.back()),
            "More remains: it depends on z, and acts along X; its strongest test explains 0.5 um RMS of "
            "the readings");
}

TEST(Verdict, WhatHasNoNameGoesBeforeSetsAndSetsBeforeNothing) {
  Diagnosis diagnosis;
  diagnosis.one_of = {backlash(), backlash()};
  diagnosis.ladder = ladder(1e-6, 1e-6, 0.0);
  Diagnosis with_unknown = diagnosis;
  with_unknown.unknown = {unknown({"z"}, -5.0)};
  conclude({}, diagnosis);
  EXPECT_EQ(to_string(diagnosis.verdict), "ONE_OF");
  conclude({}, with_unknown);
  EXPECT_EQ(to_string(with_unknown.verdict), "UNKNOWN");
}

/// Two of four effects that do not show are not most of them, three are.
TEST(Verdict, NotVisibleWhereMostWouldNotShow) {
  Diagnosis diagnosis;
  diagnosis.detectable.resize(4);
  diagnosis.not_visible.resize(2);
  Diagnosis blind = diagnosis;
  blind.not_visible.resize(3);
  conclude({}, diagnosis);
  EXPECT_EQ(to_string(diagnosis.verdict), "NOTHING_ABOVE");
  conclude({}, blind);
  EXPECT_EQ(to_string(blind.verdict), "NOT_VISIBLE");
}

TEST(Verdict, SaysWhatIsNoNameAndWhatIsInUseAgain) {
  Diagnosis diagnosis;
  diagnosis.removed_readings.resize(2);
  conclude({.more_is_known = false,
            .rejected = {{FindingCode::RejectedDriverStillMoves,
                          {{"effect", "EAX by z^2"}, {"drivers", std::vector<std::string>{"z"}}}}},
            .removed_by_fit = 5},
           diagnosis);
  EXPECT_THAT(
      sentences(diagnosis.findings),
      ElementsAre(HasSubstr("Nothing is above the noise"),
                  "Not named EAX by z^2: z still moves what it leaves.", HasSubstr("3 of 5 readings")));
}

/// 5 % of 40 decades are two; of 10 decades half a one, less than the one that is allowed anyway.
TEST(UnknownFindings, ASecondVariableIsCertainWhereNoOtherDoesAsWell) {
  std::vector<UnknownFinding> findings = {unknown({"dir_x", "T_air"}, -40.0),
                                          unknown({"dir_x", "time"}, -38.1), unknown({"dir_x", "z"}, -37.9),
                                          unknown({"dir_x"}, -39.0)};
  report_what_is_certain(findings);
  EXPECT_THAT(names_of(findings[0].variables), ElementsAre("dir_x"));
  EXPECT_THAT(names_of(findings[0].with_one_of), ElementsAre("T_air", "time"));
  findings = {unknown({"dir_x", "T_air"}, -10.0), unknown({"dir_x", "time"}, -8.9)};
  report_what_is_certain(findings);
  EXPECT_THAT(names_of(findings[0].variables), ElementsAre("dir_x", "T_air"));
  EXPECT_THAT(names_of(findings[0].with_one_of), IsEmpty());
  findings[1].log10_p = -9.1;
  report_what_is_certain(findings);
  EXPECT_THAT(names_of(findings[0].variables), ElementsAre("dir_x"));
}

}  // namespace
}  // namespace volcal
