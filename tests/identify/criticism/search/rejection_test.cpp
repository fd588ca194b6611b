// Each reason by itself: scans are made by hand, varying amplitudes come from sim/.

#include "volcal/identify/criticism/search/rejection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/search_states.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing_support::FittedStudy;
using testing_support::hiding;
using testing_support::reversal;
using testing_support::setting_of;
using testing_support::test_of;
using testing_support::with_scans;

const Eigen::Vector3i kRejectionGrid{5, 4, 3};

GenericTest hand_made_scan(const std::vector<std::string>& variables, double log10_p, double period = 0.0) {
  GenericTest test;
  test.variables = testing_support::variables_named(variables);
  test.direction = ScanDirection::Y;
  test.log10_p = log10_p;
  test.period = period;
  return test;
}

FindingCode code_of(const std::optional<Finding>& reason) { return reason ? reason->code : FindingCode::End; }

/// A backlash of EYY that is what it seems; tested with it in the model.
const ModelState& beside_backlash() {
  static const FittedStudy study(hiding({reversal("EYY", 1.5e-6)}, kRejectionGrid));
  static const ModelState given = ModelState(study.model, setting_of(study.model)).tested();
  static const ModelState state = given.with(test_of(given, {"reversal", "EYY", "dir_y", "step"})).tested();
  return state;
}

TEST(Rejection, ANameStandsWhereNothingIsLeft) {
  const ModelState state = with_scans(beside_backlash(), {});
  const Rejection rejection(state);
  EXPECT_FALSE(rejection.rejection_reason(0));
  EXPECT_THAT(rejection.rejection_reasons(), IsEmpty());
}

/// Of one scan, family-wise p is its own.
TEST(Rejection, WhatItLeavesMayNotBeLessProbable) {
  const double own = beside_backlash().setting().family_wise_log10_p(beside_backlash().added()[0].test);
  ASSERT_LT(own, -5.0);
  const ModelState weaker = with_scans(beside_backlash(), {hand_made_scan({"z"}, own + 1.0)});
  EXPECT_FALSE(Rejection(weaker).leaves_more(weaker.added()[0]));
  EXPECT_FALSE(Rejection(weaker).rejection_reason(0));
  const ModelState stronger = with_scans(beside_backlash(), {hand_made_scan({"z"}, own - 1.0)});
  EXPECT_TRUE(Rejection(stronger).leaves_more(stronger.added()[0]));
  EXPECT_EQ(code_of(Rejection(stronger).rejection_reason(0)), FindingCode::RejectedLeavesMore);
}

TEST(Rejection, ItsDriverMayNotMoveWhatItLeaves) {
  const ModelState beside_z = with_scans(beside_backlash(), {hand_made_scan({"dir_y", "z"}, -4.0)});
  const auto moved = Rejection(beside_z).rejection_reason(0);
  ASSERT_EQ(code_of(moved), FindingCode::RejectedDriverStillMoves);
  EXPECT_THAT(moved->texts("drivers"), ::testing::ElementsAre("dir_y"));
  const ModelState wave = with_scans(beside_backlash(), {hand_made_scan({"dir_y"}, -4.0, 0.01)});
  EXPECT_FALSE(Rejection(wave).rejection_reason(0)) << "a wave is another effect beside it";
}

/// A backlash that grows along Y, named as a constant one; the growing one in its place is constant.
TEST(Rejection, AnAmplitudeThatVariesIsNoName) {
  sim::HiddenEffect growing{.kind = "reversal-position", .options = {}, .rms = {}};
  growing.options.set("symbol", std::string("EYY"));
  growing.amplitude = 12e-6;
  const FittedStudy study(hiding({growing}, kRejectionGrid));
  const ModelState given = ModelState(study.model, setting_of(study.model)).tested();
  const FamilyTest& constant = test_of(given, {"reversal", "EYY", "dir_y", "step"});
  const FamilyTest& rival = test_of(given, {"position-reversal", "EYY", "", ""});
  ModelState state = with_scans(given.with(constant).tested(), {});
  std::vector<AddedEffect> compared = state.added();
  compared[0].test.log10_p = -300.0;  // leaves nothing less probable
  compared[0].rivals = {rival};
  state = state.with_comparisons(std::move(compared));
  const Rejection rejection(state);
  EXPECT_EQ(code_of(rejection.rejection_reason(0)), FindingCode::RejectedAmplitudeVaries);
  const FamilyTest* standing = rejection.standing_rival(0, {});
  ASSERT_NE(standing, nullptr);
  EXPECT_EQ(standing->family, rival.family);
  EXPECT_EQ(rejection.standing_rival(0, {{rival.family, verbatim("rejected itself")}}), nullptr);

  const ModelState right = with_scans(given.with(rival).tested(), {});
  EXPECT_FALSE(Rejection(right).rejection_reason(0));
}

}  // namespace
}  // namespace volcal
