// Sections of the reports of a comparison and of a validation: numbers in their JSON against numbers by hand,
// and every renderer run on them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "tests/io/report/drawing.h"
#include "volcal/identify/report/page.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

constexpr double kRadius = 0.15;

/// A line along X met at 0, 0.5 and 1 m twice from either side, a diagonal in XY, a circle both ways round
/// and a tracer with a temperature. Deviations in um; the model of `nominal_records` predicts zero deviation.
Campaign campaign_of_tests(int circle_readings = 72) {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine.name = "VMC <1>";
  campaign.machine.structure = Structure::parse("w X Y b Z t");
  for (const AxisName name : {AxisName::X, AxisName::Y, AxisName::Z}) {
    Axis axis;
    axis.name = name;
    axis.travel_max = 1.0;
    campaign.machine.axes.push_back(axis);
  }
  campaign.machine.tools = {{"probe", Eigen::Vector3d::Zero(), 0.0}};
  const auto add = [](Setup& setup, double x, double y, double value, int line) {
    setup.readings.position[0].push_back(x);
    setup.readings.position[1].push_back(y);
    setup.readings.position[2].push_back(0.5);
    setup.readings.value[0].push_back(value);
    setup.readings.line.push_back(line);
    setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.source_line.size()) + 2);
  };
  Setup line, diagonal, circle, tracer;
  for (Setup* setup : {&line, &diagonal, &circle, &tracer}) setup->readings.value.resize(1);
  line.name = "line <b>";
  line.instrument = diagonal.instrument = "displacement";
  const double forward[] = {0.0, 4.0, 7.0}, reverse[] = {1.0, 5.0, 9.0};
  for (int run = 0; run < 2; ++run) {
    const double more = run == 0 ? 0.0 : 1.0;
    for (int k = 0; k < 3; ++k) add(line, 0.5 * k, 0.2, 0.5 * k + (forward[k] + more) * 1e-6, 2 * run);
    for (int k = 2; k >= 0; --k) add(line, 0.5 * k, 0.2, 0.5 * k + (reverse[k] + more) * 1e-6, 2 * run + 1);
  }
  diagonal.name = "D";
  for (int k = 0; k < 4; ++k) add(diagonal, 0.2 * k, 0.2 * k, 0.2 * k * std::sqrt(2.0) + 3e-6 * k, 0);
  for (int k = 3; k >= 0; --k) add(diagonal, 0.2 * k, 0.2 * k, 0.2 * k * std::sqrt(2.0) + 3e-6 * k, 1);
  circle.name = "bar";
  circle.instrument = "ball-bar";
  circle.options.set("centre", Eigen::Vector3d(0.5, 0.4, 0.5));
  for (const int sense : {+1, -1}) {
    for (int k = 0; k < circle_readings; ++k) {
      const double angle = sense * k * 2.0 * std::numbers::pi / circle_readings;
      const double deviation =
          sense > 0 ? 10.0 + 4.0 * std::cos(2.0 * angle) : -3.0 + 2.0 * std::cos(2.0 * angle);
      add(circle, 0.5 + kRadius * std::cos(angle), 0.4 + kRadius * std::sin(angle),
          kRadius + deviation * 1e-6, sense > 0 ? 0 : 1);
    }
  }
  tracer.name = "S1";
  tracer.instrument = "laser-tracer";
  for (int k = 0; k < 40; ++k) add(tracer, k / 39.0, 0.2, 1.0, k / 10);
  campaign.setups = {line, diagonal, circle, tracer};
  return campaign;
}

/// The nominal machine; the tracer's readings are +2 um less `tracer_mean`, alternating by 1.
std::vector<ResidualRecord> nominal_records(const Campaign& campaign, double tracer_mean_um) {
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
      switch (s) {
        case 0:
          record.predicted = readings.position[0][row];
          break;
        case 1:
          record.predicted = readings.position[0][row] * std::sqrt(2.0);
          break;
        case 2:
          record.predicted = kRadius;
          break;
        default:
          record.predicted = record.reading - (tracer_mean_um + (row % 2 == 0 ? 1.0 : -1.0)) * 1e-6;
      }
      records.push_back(record);
    }
  }
  return records;
}

class ComparisonReport : public ::testing::Test {
 protected:
  ComparisonReport() {
    models_ = {compared_model("nominal machine", campaign_, nominal_records(campaign_, 2.0)),
               compared_model("result", campaign_, nominal_records(campaign_, 0.5))};
    models_[1].circle_causes = {
        {{"EC0Y", 6e-6, 0.5e-6, 2e-6, 0.75}, {"EXX", 3e-6, std::nullopt, 1e-6, 0.25}}};
    document_ = Json::parse(report_json(ComparisonView{models_}, campaign_, {.date = "2024-05-17"}));
  }

  Json page(const std::string& kind) const {
    for (const Json& each : document_.at("pages")) {
      if (each.at("kind") == kind) return each.at("data");
    }
    ADD_FAILURE() << "no page " << kind;
    return {};
  }

  Campaign campaign_ = campaign_of_tests();
  std::vector<ComparedModel> models_;
  Json document_;
};

TEST_F(ComparisonReport, EverySectionIsInTheDocumentAndHasARenderer) {
  std::ifstream file(std::filesystem::path(VOLCAL_SOURCE_DIR) / "identify/report/web/src/pages.js");
  const std::string renderers{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::set<std::string> kinds;
  for (const report::ComparisonPage& section : report::comparison_pages()) {
    const std::string kind(section.kind);
    EXPECT_TRUE(kinds.insert(kind).second) << kind << " is registered twice";
    EXPECT_THAT(renderers, HasSubstr("\n  " + kind + ": render"));
  }
  for (const char* of_rotary_axes : {"direct_tests", "rotary_axes"}) kinds.erase(of_rotary_axes);
  for (const std::string& kind : kinds) EXPECT_FALSE(page(kind).empty()) << kind;
  EXPECT_EQ(document_.at("pages").size(), kinds.size());
}

/// Forward means 0.5, 4.5, 7.5 and reverse 1.5, 5.5, 9.5 um, s = sqrt(1/2) each: E = 9, B = 2, M: 1, 5, 8.5
/// -> 7.5, R = 4 s + 2 at 1 m = 4.83, A = 9 + 4 s = 11.83.
TEST_F(ComparisonReport, ACardHasTheFiguresOfIso230Part2) {
  const Json positioning = page("positioning");
  EXPECT_EQ(positioning.at("total"), 1);
  const Json card = positioning.at("cards").at(0);
  EXPECT_EQ(card.at("title"), "X at Y 200, Z 500 mm");
  EXPECT_EQ(card.at("position"), Json({0, 500, 1000}));
  ASSERT_EQ(card.at("sources").size(), 3U);
  const Json measured = card.at("sources").at(0);
  EXPECT_EQ(measured.at("positive").at("mean"), Json({0.5, 4.5, 7.5}));
  EXPECT_EQ(measured.at("negative").at("mean"), Json({1.5, 5.5, 9.5}));
  EXPECT_NEAR(measured.at("positive").at("s").at(1).get<double>(), std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(measured.at("both").at("E").get<double>(), 9.0, 1e-3);
  EXPECT_NEAR(measured.at("both").at("M").get<double>(), 7.5, 1e-3);
  EXPECT_NEAR(measured.at("both").at("B").get<double>(), 2.0, 1e-3);
  EXPECT_NEAR(measured.at("both").at("R").get<double>(), 4.828, 1e-2);
  EXPECT_NEAR(measured.at("both").at("A").get<double>(), 11.83, 1e-2);
  EXPECT_NEAR(measured.at("forward").at("E").get<double>(), 7.0, 1e-3);
  EXPECT_NEAR(card.at("sources").at(2).at("both").at("E").get<double>(), 0.0, 1e-6);
  EXPECT_EQ(card.at("sources").at(2).at("name"), "result");
}

/// Deviation 0, 3, 6, 9 um along the diagonal.
TEST_F(ComparisonReport, DiagonalsAreCardsWithASummary) {
  const Json diagonals = page("diagonals");
  EXPECT_EQ(diagonals.at("groups").at(0).at("axes"), "face XY");
  EXPECT_NEAR(diagonals.at("groups").at(0).at("sources").at(0).at("E").get<double>(), 9.0, 1e-3);
  EXPECT_EQ(diagonals.at("cards").at(0).at("title"), "Diagonal +X+Y");
}

/// As in the test of the figures: G = 8 and 4, G(b) = 19; at 0 degrees +14 um, predicted 0.
TEST_F(ComparisonReport, ACircleHasItsDeviationsItsFiguresAndItsCauses) {
  const Json circle = page("circles").at("circles").at(0);
  EXPECT_EQ(circle.at("first"), "X");
  EXPECT_EQ(circle.at("readings"), 144);
  EXPECT_EQ(circle.at("drawn"), 144);
  EXPECT_NEAR(circle.at("measured").at(0).get<double>(), 14.0, 1e-3);
  EXPECT_EQ(circle.at("sense").at(0), 1);
  EXPECT_NEAR(circle.at("figures").at("ccw").at("G").get<double>(), 8.0, 1e-3);
  EXPECT_NEAR(circle.at("figures").at("G_both").get<double>(), 19.0, 1e-3);
  const Json result = circle.at("models").at(1);
  EXPECT_NEAR(result.at("predicted").at(0).get<double>(), 0.0, 1e-3);
  const Json causes = result.at("causes").at("rows");
  EXPECT_EQ(causes.at(0).at("name"), "EC0Y");
  EXPECT_NEAR(causes.at(0).at("U95").get<double>(), 0.98, 1e-9);
  EXPECT_NEAR(causes.at(0).at("share").get<double>(), 0.75, 1e-9);
  EXPECT_TRUE(causes.at(1).at("U95").is_null());
  EXPECT_TRUE(circle.at("models").at(0).at("causes").at("rows").empty());
}

/// The tracer's residuals are m +- 1 um on four lines, so each line's mean is m: u is that of 40 independent
/// readings, 1 / sqrt 40.
TEST_F(ComparisonReport, SetupsHaveSignedMeans) {
  const Json setups = page("setup_residuals").at("setups");
  ASSERT_EQ(setups.size(), 4U);
  const Json tracer = setups.at(3);
  EXPECT_EQ(tracer.at("name"), "S1");
  EXPECT_NEAR(tracer.at("models").at(0).at("mean").get<double>(), 2.0, 1e-3);
  EXPECT_NEAR(tracer.at("models").at(1).at("mean").get<double>(), 0.5, 1e-3);
  EXPECT_NEAR(tracer.at("models").at(1).at("band").get<double>(), 2.0 / std::sqrt(40.0), 0.01);
}

TEST_F(ComparisonReport, EverySectionIsDrawn) {
  const test::Drawing drawing = test::draw_report(document_.dump());
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
  EXPECT_THAT(drawing.output, HasSubstr("5 sections"));
}

/// Spikes are what a circle is looked at for.
TEST(ComparisonReportSize, ManyReadingsOfACircleAreThinnedAndTheLargestStays) {
  Campaign campaign = campaign_of_tests(20000);
  campaign.setups[2].readings.value[0][12345] += 100e-6;
  const std::vector<ComparedModel> models = {
      compared_model("result", campaign, nominal_records(campaign, 0.0))};
  const std::string json = report_json(ComparisonView{models}, campaign);
  EXPECT_LT(json.size(), 400'000U);
  const Json document = Json::parse(json);
  for (const Json& each : document.at("pages")) {
    if (each.at("kind") != "circles") continue;
    const Json circle = each.at("data").at("circles").at(0);
    EXPECT_EQ(circle.at("readings"), 40000);
    EXPECT_LE(circle.at("drawn"), 1200);
    double largest = 0.0;
    for (const Json& value : circle.at("measured")) largest = std::max(largest, value.get<double>());
    EXPECT_GT(largest, 90.0);
  }
}

/// A campaign without any test of a standard has no empty sections.
TEST(ComparisonReportSections, WhatIsNotThereIsLeftOut) {
  Campaign campaign = campaign_of_tests();
  campaign.setups = {campaign.setups[3]};
  auto records = nominal_records(campaign_of_tests(), 0.0);
  std::erase_if(records, [](const ResidualRecord& record) { return record.setup != 3; });
  for (ResidualRecord& record : records) record.setup = 0;
  const std::vector<ComparedModel> models = {compared_model("result", campaign, records)};
  const Json document = Json::parse(report_json(ComparisonView{models}, campaign));
  ASSERT_EQ(document.at("pages").size(), 2U);
  EXPECT_EQ(document.at("pages").at(0).at("kind"), "comparison");
  EXPECT_EQ(document.at("pages").at(1).at("kind"), "setup_residuals");
}

TEST(ValidationReport, SaysWhetherTheFitHadSeenTheReadings) {
  const Campaign campaign = campaign_of_tests();
  const std::vector<ComparedModel> models = {
      compared_model("nominal machine", campaign, nominal_records(campaign, 2.0)),
      compared_model("identified", campaign, nominal_records(campaign, 0.0))};
  ValidationFigures figures;
  figures.rms_before = 4e-6;
  figures.rms_after = 1e-6;
  figures.max_before = 9e-6;
  figures.max_after = 3e-6;
  figures.lengths = 204;
  figures.reduced_chi2 = 1.25;
  figures.coverage95 = 0.94;
  FittedReadings fitted;
  fitted.is_known = true;
  const std::string json = report_json(ValidationView{figures, fitted, models}, campaign);
  const Json page = Json(Json::parse(json).at("pages").at(0));
  EXPECT_EQ(page.at("kind"), "validation");
  EXPECT_EQ(page.at("data").at("level"), "good");
  EXPECT_EQ(page.at("data").at("seen"), "Readings that the fit never saw");
  EXPECT_EQ(page.at("data").at("warning"), "");
  EXPECT_EQ(page.at("data").at("rows").size(), 1U);
  EXPECT_EQ(page.at("data").at("rows").at(0).at("rms_after"), 1.0);
  EXPECT_EQ(page.at("data").at("coverage_percent"), 94.0);
  fitted.readings = fitted.all = 204;
  const Json seen = Json::parse(report_json(ValidationView{figures, fitted, models}, campaign));
  EXPECT_EQ(seen.at("pages").at(0).at("data").at("level"), "warning");
  EXPECT_THAT(seen.at("pages").at(0).at("data").at("warning").get<std::string>(), HasSubstr("prove nothing"));
  const test::Drawing drawing = test::draw_report(json);
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
}

}  // namespace
}  // namespace volcal
