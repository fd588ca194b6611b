// Figures of the criticism study by hand-made records, and what its rows hide.

#include "volcal/studies/criticism/criticism_figures.h"

#include <gtest/gtest.h>

#include "volcal/sim/study.h"
#include "volcal/studies/criticism/criticism_hidden.h"
#include "volcal/studies/criticism/criticism_names.h"
#include "volcal/studies/criticism/criticism_plan.h"

namespace volcal {
namespace {

using studies::AnswerRecord;
using studies::CampaignRecord;

/// One effect of ten times the noise in a set; what each member leaves of it, in units of the noise.
CampaignRecord in_a_set(const std::vector<double>& left) {
  CampaignRecord record;
  record.row = "listed";
  record.verdict = "ONE_OF";
  record.hidden.emplace_back().signal = 10.0;
  std::vector<AnswerRecord>& set = record.sets.emplace_back();
  for (const double each : left) {
    AnswerRecord& answer = set.emplace_back();
    answer.hidden = each == 0.0 ? 0 : -1;
    answer.by_name = each == 0.0;
    answer.explains = 1.0 - each * each / 100.0;
    answer.gain = 50.0 - static_cast<double>(set.size());
  }
  return record;
}

TEST(CriticismFigures, ReadingsLeaveManyWhereOverThreeAreAsGoodAsTheTruth) {
  EXPECT_TRUE(studies::readings_leave_many(in_a_set({0.0, 1.0, 3.0, 3.9})));
  EXPECT_FALSE(studies::readings_leave_many(in_a_set({0.0, 1.0, 3.0, 4.1})))
      << "three may be told from the rest";
  EXPECT_FALSE(studies::readings_leave_many(in_a_set({0.0, 1.0, 1.0}))) << "no large set";
  EXPECT_FALSE(studies::readings_leave_many(in_a_set({1.0, 1.0, 1.0, 1.0}))) << "without the right one";
}

TEST(CriticismPlan, WhatRowListedHidesIsInTheCatalogue) {
  const int twice_every_kind = 2 * static_cast<int>(studies::listed_kinds().size());
  for (int i = 0; i < twice_every_kind; ++i) {
    const studies::PlannedCampaign plan = studies::plan_campaign("listed", i, 1, 400, 0);
    const sim::SimulatedCampaign simulated = sim::simulate(plan.study);
    for (const studies::PlannedEffect& hidden : plan.hidden)
      EXPECT_TRUE(studies::right_answer(hidden.effect, simulated.campaign).name)
          << studies::text_of(hidden.effect);
  }
}

}  // namespace
}  // namespace volcal
