#include "volcal/identify/report/text/comparison_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A tracer setup S1 of 400 readings along X and a displacement line L of 0, 0.5 and 1 m, there and back
/// once.
Campaign campaign_of_two_setups() {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine.structure = Structure::parse("w X b Y t");
  for (const AxisName name : {AxisName::X, AxisName::Y}) {
    Axis axis;
    axis.name = name;
    axis.travel_max = 1.0;
    campaign.machine.axes.push_back(axis);
  }
  campaign.machine.tools = {{"probe", Eigen::Vector3d::Zero(), 0.0}};
  volcal::Setup tracer;
  tracer.name = "S1";
  tracer.instrument = "laser-tracer";
  tracer.readings.value.resize(1);
  for (int k = 0; k < 400; ++k) {
    tracer.readings.position[0].push_back(k / 399.0);
    tracer.readings.position[1].push_back(0.2);
    tracer.readings.value[0].push_back(0.0);
    tracer.readings.source_line.push_back(k + 2);
  }
  volcal::Setup line;
  line.name = "L";
  line.instrument = "displacement";
  line.readings.position[0] = {0.0, 0.5, 1.0, 1.0, 0.5, 0.0};
  line.readings.position[1].assign(6, 0.2);
  line.readings.value = {{0.0, 0.5 + 4e-6, 1.0 + 7e-6, 1.0 + 9e-6, 0.5 + 5e-6, 0.0 + 1e-6}};
  for (int k = 0; k < 6; ++k) line.readings.source_line.push_back(k + 2);
  campaign.setups = {tracer, line};
  return campaign;
}

/// Residuals of +-1 sigma, `scale` times that between X = 0.8 and 1 m; those of the line are 0.
std::vector<ResidualRecord> records_of(const Campaign& campaign, double scale) {
  std::vector<ResidualRecord> records;
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    const Readings& readings = campaign.setups[s].readings;
    for (std::size_t row = 0; row < readings.size(); ++row) {
      ResidualRecord record;
      record.setup = s;
      record.row = row;
      record.source_line = readings.source_line[row];
      record.sigma = 1e-6;
      record.redundancy = 1.0;
      record.reading = readings.value[0][row];
      const double size = readings.position[0][row] > 0.8 ? scale : 1.0;
      record.predicted = record.reading - (s == 0 ? (row % 2 == 0 ? 1e-6 : -1e-6) * size : 0.0);
      records.push_back(record);
    }
  }
  return records;
}

/// What scans find is opposed to a model that explains the readings, and comes on top of one that does not.
TEST(FailureSentence, OpposesScansToModelsThatExplainTheReadings) {
  const Campaign campaign = campaign_of_two_setups();
  auto right = compared_model("right", campaign, records_of(campaign, 1.0));
  auto wrong = compared_model("wrong", campaign, records_of(campaign, 3.0));
  Screening found;
  found.contradicts = true;
  found.leading = "EAX by z^2";
  for (ComparedModel* model : {&right, &wrong}) model->screening = found;
  EXPECT_THAT(failure_sentence(right),
              AllOf(HasSubstr(". But "), HasSubstr("EAX by z^2"), Not(HasSubstr("Besides"))));
  EXPECT_THAT(failure_sentence(wrong),
              AllOf(HasSubstr(". Besides, "), HasSubstr("EAX by z^2"), Not(HasSubstr("But "))));
}

TEST(FailureSentence, SaysThatNothingIsWrong) {
  const Campaign campaign = campaign_of_two_setups();
  const auto model = compared_model("result", campaign, records_of(campaign, 1.0));
  EXPECT_THAT(failure_sentence(model),
              StartsWith("result: no failure found, chi2/dof 0.985 over 406 observations"));
}

/// 320 readings below 0.8 m with chi2 1 each, 80 above with 10^2 each, 6 with 0: (320 + 8,000) / 406 = 20.49.
/// Bins "800 to 900" and "900 to 1000" hold nothing but 100s, the line's two readings at 1 m apart: 8 m to 9
/// m wins with chi2/dof 100.
TEST(FailureSentence, NamesThePlaceThatStandsOut) {
  const Campaign campaign = campaign_of_two_setups();
  const auto model = compared_model("result", campaign, records_of(campaign, 10.0));
  EXPECT_THAT(
      failure_sentence(model),
      StartsWith("result: does not explain the readings, chi2/dof 20.5 over 406 observations; worst: X 800 "
                 "to 900 mm (chi2/dof 100)"));
}

TEST(FailureSentence, MisfitEverywhereHasNoWorstPlace) {
  const Campaign campaign = campaign_of_two_setups();
  auto records = records_of(campaign, 1.0);
  for (ResidualRecord& record : records) record.sigma = 1e-7;
  const auto model = compared_model("nominal machine", campaign, std::move(records));
  EXPECT_THAT(failure_sentence(model),
              HasSubstr("no setup, place, direction or time is much worse than the rest"));
}

/// Line L by hand: + 0, 4, 7; - 1, 5, 9 um at 0, 500, 1000 mm. E+ = 7, E- = 8, E = 9, M: 0.5, 4.5, 8 -> 7.5,
/// B = -1, -1, -2 -> 2, mean -4/3; met once per direction: A and R are undefined. The model predicts exactly
/// this.
TEST(ComparisonText, HasTheFiguresOfReadingsAndModelAndDashesForUndefinedOnes) {
  const Campaign campaign = campaign_of_two_setups();
  const auto model = compared_model("result", campaign, records_of(campaign, 1.0));
  const std::string text = comparison_text(campaign, std::vector<ComparedModel>{model});
  EXPECT_THAT(text, HasSubstr("ISO 230-2:2014 [um]"));
  EXPECT_THAT(text,
              HasSubstr("Y 200 mm  readings  -   -   -  9.00  7.00  8.00  7.50  -   -   -  2.00   -1.33\n"));
  EXPECT_THAT(text, HasSubstr("R and A are undefined"));
  EXPECT_THAT(text, HasSubstr("Residuals by setup"));
  EXPECT_THAT(text, HasSubstr("Worst readings\n"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

TEST(ComparisonText, SignedMeansStandBesideTheRms) {
  Campaign campaign = campaign_of_two_setups();
  campaign.notes = {verbatim("a note of the reader")};
  const auto model = compared_model("result", campaign, records_of(campaign, 1.0));
  const std::string text = comparison_text(campaign, std::vector<ComparedModel>{model});
  EXPECT_THAT(text, HasSubstr("Signed means of the residuals, reading minus prediction"));
  EXPECT_THAT(text, HasSubstr("! a note of the reader\n"));
  const auto json = nlohmann::json::parse(comparison_json(campaign, std::vector<ComparedModel>{model}, {}));
  EXPECT_TRUE(json["models"][0]["by"]["setup"][0]["lengths_um"].contains("mean"));
  EXPECT_EQ(json["notes"][0], "a note of the reader");
}

TEST(ComparisonText, TwoModelsStandSideBySide) {
  const Campaign campaign = campaign_of_two_setups();
  const std::vector<ComparedModel> models = {
      compared_model("nominal machine", campaign, records_of(campaign, 10.0)),
      compared_model("result", campaign, records_of(campaign, 1.0))};
  const std::string text = comparison_text(campaign, models);
  EXPECT_THAT(text, StartsWith("A = nominal machine: does not explain"));
  EXPECT_THAT(text, HasSubstr("\nB = result: no failure found"));
  EXPECT_THAT(text, HasSubstr("rms A [um]  rms B [um]  B - A [um]  B / A"));
  EXPECT_THAT(text, HasSubstr("B against A, all readings: RMS 4.53 -> 0.99 um (0.219 times)"));
  EXPECT_THAT(text, HasSubstr("chi2/dof B"));
  EXPECT_THAT(text, HasSubstr("model A"));
  EXPECT_THAT(text, HasSubstr("Worst readings of A and of B"));
  EXPECT_THAT(text, HasSubstr("residual A  residual B  B - A  sigma"));
}

/// RMS of A over all 406 readings: sqrt((320 + 8,000) / 406) = 4.527 um, of B sqrt(400 / 406) = 0.993 um; of
/// S1 sqrt(8,320 / 400) = 4.561 and 1.
TEST(ComparisonText, DifferenceAndRatioStandBesideTheTwo) {
  const Campaign campaign = campaign_of_two_setups();
  const std::vector<ComparedModel> models = {
      compared_model("nominal machine", campaign, records_of(campaign, 10.0)),
      compared_model("result", campaign, records_of(campaign, 1.0))};
  const std::string text = comparison_text(campaign, models);
  EXPECT_THAT(text, ::testing::ContainsRegex("S1 +laser-tracer +400 +4.56 +1.00 +-3.56 +0.219"));
  EXPECT_THAT(text, ::testing::ContainsRegex("all +406 +4.53 +0.99 +-3.53 +0.219"));
}

TEST(HeldOut, HasTheSameColumnsAndItsOwnEntryInTheJson) {
  const Campaign campaign = campaign_of_two_setups();
  const std::vector<ComparedModel> models = {
      compared_model("nominal machine", campaign, records_of(campaign, 10.0)),
      compared_model("result", campaign, records_of(campaign, 1.0))};
  std::vector<HeldOutModel> heldout = {{"nominal", false, models[0].comparison},
                                       {"result", true, models[1].comparison}};
  const std::string text = heldout_text(campaign, heldout, 2030);
  EXPECT_THAT(text, HasSubstr("every fifth, 406 of 2,030 observations"));
  EXPECT_THAT(text, HasSubstr("A = nominal: nothing to fit"));
  EXPECT_THAT(text, HasSubstr("B against A, held-out lines: RMS 4.53 -> 0.99 um"));
  const auto with = nlohmann::json::parse(comparison_json(campaign, models, heldout));
  const auto without = nlohmann::json::parse(comparison_json(campaign, models));
  EXPECT_EQ(with.at("models"), without.at("models"));
  EXPECT_FALSE(without.contains("held_out"));
  EXPECT_TRUE(with.at("held_out").at(1).at("fitted_without_them").get<bool>());
  EXPECT_EQ(with.at("held_out").at(0).at("total").at("observations"), 406);
}

TEST(ComparisonJson, HoldsTheSameFiguresAndNullForUndefinedOnes) {
  const Campaign campaign = campaign_of_two_setups();
  const std::vector<ComparedModel> models = {compared_model("result", campaign, records_of(campaign, 10.0))};
  const auto json = nlohmann::json::parse(comparison_json(campaign, models));
  const auto& model = json.at("models").at(0);
  EXPECT_EQ(model.at("name"), "result");
  EXPECT_NEAR(model.at("total").at("reduced_chi2").get<double>(), 8320.0 / 406.0, 1e-6);
  EXPECT_EQ(model.at("by").at("setup").size(), 2U);
  const auto& line = model.at("standards").at("iso230_2").at(0);
  EXPECT_EQ(line.at("axis"), "X");
  EXPECT_NEAR(line.at("readings").at("E_um").get<double>(), 9.0, 1e-6);
  EXPECT_NEAR(line.at("model").at("B_um").get<double>(), 2.0, 1e-6);
  EXPECT_TRUE(line.at("readings").at("R_um").is_null());
  EXPECT_NEAR(model.at("worst_readings").at(0).at("standardized").get<double>(), 10.0, 1e-6);
  EXPECT_EQ(model.at("worst_readings").at(0).at("line"), 322);  // reading 320 of the file, below its head
}

/// A name in another encoding than UTF-8 does not cost the figures.
TEST(ComparisonJson, ReplacesBytesThatAreNoText) {
  Campaign campaign = campaign_of_two_setups();
  campaign.setups[0].name =
      "S\xFC"
      "d";
  const std::vector<ComparedModel> models = {compared_model("result", campaign, records_of(campaign, 10.0))};
  const auto json = nlohmann::json::parse(comparison_json(campaign, models));
  EXPECT_EQ(json.at("models").at(0).at("worst_readings").at(0).at("setup"),
            "S\xEF\xBF\xBD"
            "d");
}

}  // namespace
}  // namespace volcal
