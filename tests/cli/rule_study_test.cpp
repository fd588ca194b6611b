// Rules of the search left out in turn: the counting by hand, and the study on the smallest set.

#include "volcal/studies/criticism/rule_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using studies::AnswerRecord;
using studies::CampaignRecord;
using studies::HiddenRecord;
using studies::RuleCampaign;
using ::testing::HasSubstr;
using testing::run_program;

/// One effect of 20 times the noise; a name that is it, or is another.
CampaignRecord named_record(bool right) {
  CampaignRecord record;
  record.row = "listed";
  HiddenRecord& hidden = record.hidden.emplace_back();
  hidden.text = "reversal EXX";
  hidden.right = "reversal:EXX:dir_x:step";
  hidden.signal = 20.0;
  record.verdict = "NAMED";
  AnswerRecord& named = record.named.emplace_back();
  named.name = right ? hidden.right : "axis-coupling:EAY:z:linear";
  named.hidden = right ? 0 : -1;
  record.told_explain = right ? 1.0 : 0.5;
  record.recovery = true;
  record.ms_given = 4.0;
  record.ms_oracle = 1.0;
  record.ms_offered = right ? 1.1 : 3.0;
  return record;
}

CampaignRecord nothing_hidden(const char* verdict) {
  CampaignRecord record;
  record.row = "null";
  record.verdict = verdict;
  return record;
}

RuleCampaign campaign_of(CampaignRecord record, double seconds, const char* decided) {
  RuleCampaign campaign;
  campaign.all = std::move(record);
  campaign.seconds = seconds;
  campaign.decided = {decided};
  return campaign;
}

TEST(RuleStudy, CountsWhatIsReportedOtherwise) {
  RuleCampaign kept = campaign_of(named_record(true), 2.0, "recheck");
  kept.without["recheck"] = named_record(false);
  kept.seconds_without["recheck"] = 1.5;
  RuleCampaign same = campaign_of(named_record(true), 2.0, "recheck");
  same.without["recheck"] = named_record(true);
  same.seconds_without["recheck"] = 2.5;
  RuleCampaign silent = campaign_of(nothing_hidden("NOTHING_ABOVE"), 1.0, "estimated-noise");
  silent.without["estimated-noise"] = nothing_hidden("UNKNOWN");
  silent.seconds_without["estimated-noise"] = 1.0;
  const auto rows = studies::rows_of({kept, same, silent}, {"recheck", "estimated-noise", "one-cause"});
  ASSERT_EQ(rows.size(), 4U);
  const auto counts = [&](std::size_t row) {
    const studies::RuleCounts& counted = rows[row].counts;
    return std::vector{rows[row].decided, rows[row].changed, counted.right,
                       counted.wrong,     counted.alarms,    counted.removed};
  };
  EXPECT_EQ(counts(0), (std::vector{0, 0, 2, 0, 0, 2}));
  EXPECT_EQ(counts(1), (std::vector{2, 1, 1, 1, 0, 1})) << "a wrong name leaves half of 20 sigma squared";
  EXPECT_EQ(counts(2), (std::vector{1, 1, 2, 0, 1, 2}));
  EXPECT_EQ(counts(3), (std::vector{0, 0, 2, 0, 0, 2}));
  EXPECT_DOUBLE_EQ(rows[0].counts.seconds, 5.0);
  EXPECT_DOUBLE_EQ(rows[1].counts.seconds, 1.5 + 2.5 + 1.0);
}

TEST(RuleStudy, RefusesARuleThatThereIsNot) {
  const auto unknown = run_program("study rules --without gut-feeling");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("gut-feeling"));
}

TEST(RuleStudy, GoesOnWhereItEndedAndIsItsOwn) {
  VOLCAL_FOR_THE_NIGHT("PreviewsStudy.GoesOnBehindItsLastCampaign, which keeps campaigns by the same code");
  const testing::ScratchFolder folder;
  const std::string kept = (folder.path() / "kept").string();
  const std::string study = "study rules --rows partial -n 1 --seed 5 --readings 400 --json -o " + kept;
  const auto first = run_program(study);
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(run_program(study).exit_code, 2) << "campaigns of an earlier run are not overwritten";
  const auto again = run_program(study + " --resume");
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_EQ(Json::parse(again.output), Json::parse(first.output)) << "seconds too: nothing ran again";
  const auto other =
      run_program("study rules --rows partial -n 1 --seed 6 --readings 400 --resume -o " + kept);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.errors, HasSubstr("--seed 5"));
}

TEST(RuleStudy, CriticismKeepsCampaignsWithoutARuleApart) {
  VOLCAL_FOR_THE_NIGHT("RuleStudy.CountsWhatIsReportedOtherwise counts them apart by hand");
  const testing::ScratchFolder folder;
  const std::string kept = (folder.path() / "kept").string();
  const std::string study = "study criticism --rows partial -n 1 --seed 5 --readings 400 ";
  const auto without = run_program(study + "--without recheck,one-cause -o " + kept);
  ASSERT_EQ(without.exit_code, 0) << without.errors;
  EXPECT_THAT(without.output, HasSubstr("without recheck, one-cause"));
  const auto with = run_program(study + "--resume -o " + kept);
  EXPECT_EQ(with.exit_code, 2);
  EXPECT_THAT(with.errors, HasSubstr("--without one-cause,recheck"));
}

}  // namespace
}  // namespace volcal
