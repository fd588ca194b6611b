// Report and tables of a Monte Carlo study made by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/io/report/drawing.h"
#include "tests/support/machines.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/budget_text.h"
#include "volcal/identify/report/text/montecarlo_text.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

QuantityResult value_of(QuantityKind kind, const std::string& name, double u) {
  QuantityResult value;
  value.quantity.kind = kind;
  value.quantity.name = name;
  value.quantity.unit = "um";
  value.quantity.si_per_unit = 1e-6;
  value.u = value.u_linear = u;
  value.tolerance = 0.05e-6;
  value.bias_error = 1e-9;
  return value;
}

QuantityResult table_value(double position, int direction, double u) {
  QuantityResult value = value_of(QuantityKind::TableValue, "EXX", u);
  value.quantity.axis = AxisName::X;
  value.quantity.position = position;
  value.quantity.direction = direction;
  return value;
}

/// EXX at two positions from both sides, a squareness, a station, ex and ey of one point; three sources.
MonteCarloResult hand_made_study() {
  MonteCarloResult study;
  study.draws = 1000;
  study.check.linear.draws = 20;
  for (const int direction : {1, -1}) {
    study.quantities.push_back(table_value(0.1, direction, 0.5e-6));
    study.quantities.push_back(table_value(0.2, direction, 0.5e-6));
  }
  study.quantities.push_back(value_of(QuantityKind::TableValue, "EC0Y", 1e-6));
  study.quantities.push_back(value_of(QuantityKind::Parameter, "station <P1>", 2e-6));
  for (const char* component : {"ex", "ey"}) {
    study.quantities.push_back(value_of(QuantityKind::VolumetricError, component, 0.5e-6));
    study.quantities.back().quantity.tool = "long <b>";
    study.quantities.back().quantity.at = AxisPosition{};
  }
  study.quantities[1].verdict = LinearVerdict::NotValidated;
  study.quantities[2].verdict = LinearVerdict::Validated;
  study.budget.sources = {"noise of <laser>", "prior of station", "dust"};
  study.budget.u = Eigen::MatrixXd::Zero(8, 3);
  study.budget.u.col(0).setConstant(0.3e-6);
  study.budget.u.col(1).setConstant(0.4e-6);
  study.budget.u.col(2).setConstant(1e-9);
  return study;
}

nlohmann::json page_data_of_study(const std::string& report, const std::string& kind) {
  const auto document = nlohmann::json::parse(report);
  for (const auto& page : document.at("pages")) {
    if (page.at("kind") == kind) return page.at("data");
  }
  return {};
}

std::string report_of(const MonteCarloResult& study) {
  return report_json(study, testing_support::machine_of("w X' b Y Z t"));
}

TEST(MonteCarloReport, CurvesAreByDirectionAndVerdictsAreCounted) {
  const auto data = page_data_of_study(report_of(hand_made_study()), "uncertainties");
  EXPECT_EQ(data.at("verdicts").at("validated"), 1);
  EXPECT_EQ(data.at("verdicts").at("undecided"), 6);
  EXPECT_EQ(data.at("verdicts").at("not_validated"), 1);
  ASSERT_EQ(data.at("functions").size(), 1U);
  const auto& curves = data.at("functions")[0].at("curves");
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_EQ(curves[0].at("direction"), 1);
  EXPECT_EQ(curves[0].at("q"), nlohmann::json({100.0, 200.0}));
  EXPECT_EQ(curves[1].at("linear"), nlohmann::json({0.5, 0.5}));
  ASSERT_EQ(data.at("others").size(), 2U);
  EXPECT_EQ(data.at("others")[1].at("name"), "station <P1>");
}

TEST(MonteCarloReport, SaysWhatTheReadingsContradict) {
  MonteCarloResult study = hand_made_study();
  EXPECT_TRUE(page_data_of_study(report_of(study), "uncertainties").at("messages").empty());
  study.contradicted.push_back({FindingCode::FitNotConverged});
  const auto messages = page_data_of_study(report_of(study), "uncertainties").at("messages");
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_THAT(messages[0].get<std::string>(), HasSubstr("converge"));
}

/// Steps hold the second order of the transforms: what they leave is not the whole where refits differ by
/// more than a fifth of the tolerance, or where there are none.
TEST(MonteCarloReport, SaysWhatStepsHoldWhereRefitsDoNotAgree) {
  MonteCarloResult study = hand_made_study();
  study.path = DrawPath::Chord;
  study.steps = 1200;
  study.check.chord.draws = 20;
  study.check.chord.largest_share = 0.19;
  EXPECT_THAT(montecarlo_text(study), HasSubstr("1.20 a draw; further ones would change less than"));
  EXPECT_EQ(page_data_of_study(report_of(study), "uncertainties").at("held"), "");
  study.check.chord.largest_share = 0.3;
  const std::string text = montecarlo_text(study);
  EXPECT_THAT(text,
              HasSubstr("refits differ by 0.30 times the tolerance where 0.2 is allowed: take --path refit"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("further ones would change less")));
  study.check.chord.draws = 0;
  EXPECT_THAT(montecarlo_text(study), HasSubstr("what that leaves out is not known without --refits"));
  EXPECT_EQ(page_data_of_study(report_of(study), "uncertainties").at("held"), held_by_steps_text(study));
}

/// Of one draw there is no u: the largest of a line is that by linear propagation.
TEST(MonteCarloReport, LineOfASingleDrawIsTheWidestByLinearPropagation) {
  MonteCarloResult study = hand_made_study();
  for (QuantityResult& value : study.quantities) value.u = std::nan("");
  study.quantities[1].u_linear = 0.75e-6;
  EXPECT_THAT(montecarlo_text(study), ::testing::ContainsRegex("EXX +4 +um +0\\.7500 +- +- "));
}

// Variances 0.09 and 0.16 of 0.25; with half of the second source 0.09 + 0.04 = 0.13.
TEST(MonteCarloReport, BudgetHasSharesAndWhatHalvingBrings) {
  const auto data = page_data_of_study(report_of(hand_made_study()), "budget");
  EXPECT_EQ(data.at("sources"), nlohmann::json({"prior of station", "noise of <laser>"}));
  EXPECT_EQ(data.at("others"), 1);
  ASSERT_EQ(data.at("groups").size(), 4U);  // EXX, EC0Y, ex and ey; the station is left out
  EXPECT_NEAR(data.at("groups")[0].at("share")[0].get<double>(), 0.64, 1e-4);
  EXPECT_NEAR(data.at("groups")[0].at("share")[1].get<double>(), 0.36, 1e-4);
  EXPECT_NEAR(data.at("volume_u_um").get<double>(), 0.5, 1e-4);
  EXPECT_NEAR(data.at("halved")[0].at("u_um").get<double>(), std::sqrt(0.13), 1e-4);
  const std::string text = budget_text(hand_made_study());
  EXPECT_THAT(text, HasSubstr("[1] prior of station"));
  EXPECT_THAT(text, HasSubstr("1 other sources contribute less than 1 % to every line"));
  EXPECT_THAT(text, HasSubstr("27.9 %"));  // 1 - sqrt(0.13) / 0.5
}

TEST(MonteCarloReport, EverySectionCanBeDrawn) {
  const test::Drawing drawing = test::draw_report(report_of(hand_made_study()));
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
  EXPECT_THAT(drawing.output, ::testing::StartsWith("2 sections, 2 plots"));
}

TEST(MonteCarloReport, StudyWithoutTablesCanBeDrawn) {
  MonteCarloResult study = hand_made_study();
  study.quantities = {study.quantities[5]};
  study.budget.u = study.budget.u.row(5).eval();
  EXPECT_EQ(budget_text(study), "");
  const test::Drawing drawing = test::draw_report(report_of(study));
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
}

Finding exchangeable(const std::string& error, const std::string& partner) {
  return {FindingCode::NotVisibleExchangeable,
          {{"error", error},
           {"partners", std::vector<std::string>{partner}},
           {"remedies", std::vector<std::string>{"other-lines"}}}};
}

TEST(UndeterminedText, SaysThatOnlyCombinationsAreFreeWithTheNamesOfTheCampaign) {
  FitResult fit;
  fit.rank.parameters = 10;
  fit.rank.rank = 9;
  fit.rank.invisible = {exchangeable("EYZ", "EA0Z"),
                        exchangeable("EA0Z", "EYZ"),
                        {FindingCode::NotVisibleNoReadingChanges, {{"error", std::string("EXX")}}}};
  const std::string text = undetermined_text(fit);
  EXPECT_THAT(text,
              HasSubstr("\nOnly combinations of EYZ and EA0Z are free; the readings determine the rest of "
                        "them. Do not switch them off in the model"));
  EXPECT_THAT(text, ::testing::EndsWith("\nMeasure what is named here and draw again.\n"));
}

TEST(UndeterminedText, ErrorThatNoReadingSeesIsNoCombination) {
  FitResult fit;
  fit.rank.parameters = 10;
  fit.rank.rank = 9;
  fit.rank.invisible = {{FindingCode::NotVisibleNoReadingChanges, {{"error", std::string("EXX")}}}};
  EXPECT_THAT(undetermined_text(fit), ::testing::Not(HasSubstr("combinations of")));
}

}  // namespace
}  // namespace volcal
