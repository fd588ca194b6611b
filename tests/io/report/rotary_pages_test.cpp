// Pages of rotary axes: numbers in their JSON against numbers by hand, and every renderer run on them.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/io/report/drawing.h"
#include "tests/support/rotary_machines.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/report.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Json = nlohmann::json;

/// Readings at C = -90, 0, 90 degrees, A = 0.
Campaign rotary_campaign(const Machine& machine) {
  Campaign campaign;
  campaign.machine = machine;
  Setup setup;
  setup.name = "R";
  setup.instrument = "r-test";
  setup.readings.value.resize(3);
  for (const double c : {-std::numbers::pi / 2.0, 0.0, std::numbers::pi / 2.0}) {
    for (const AxisName axis : kAllAxes)
      setup.readings.position[index_of(axis)].push_back(axis == AxisName::C ? c : 0.0);
    for (auto& channel : setup.readings.value) channel.push_back(0.0);
    setup.readings.source_line.push_back(2);
  }
  campaign.setups = {setup};
  return campaign;
}

Json rotary_page(const std::string& document) {
  const Json whole = Json::parse(document);
  for (const Json& page : whole.at("pages")) {
    if (page.at("kind") == "rotary_axes") return page.at("data");
  }
  return {};
}

class RotaryPages : public ::testing::Test {
 protected:
  RotaryPages() : result_(testing::rotary_result(testing::kTrunnion)) {}

  Json model() const {
    return rotary_page(report_json(result_, rotary_campaign(result_.machine))).at("models").at(0);
  }
  FitResult result_;
};

/// EXC = 3 um sin(q + phase): its values at the page's positions, and a range of 6 um.
TEST_F(RotaryPages, MotionsAreThoseOfTheFunctions) {
  const Json motions = model().at("motions");
  ASSERT_EQ(motions.size(), 12u);
  const Json& exc = motions.at(6);
  ASSERT_EQ(exc.at("symbol"), "EXC");
  EXPECT_EQ(exc.at("meaning"), "radial");
  EXPECT_EQ(motions.at(8).at("meaning"), "axial");
  EXPECT_EQ(motions.at(9).at("meaning"), "tilt");
  EXPECT_EQ(motions.at(11).at("meaning"), "angular positioning");
  EXPECT_NEAR(exc.at("range").get<double>(), 6.0, 0.05);
  const auto place = *result_.layout.find(*ErrorSymbol::parse("EXC"));
  const Basis& basis = *result_.layout.groups[static_cast<std::size_t>(place.group)].basis;
  const Eigen::VectorXd coefficients =
      result_.layout.coefficients(*ErrorSymbol::parse("EXC"), result_.parameters);
  for (const std::size_t i : {0u, 40u, 133u}) {
    const double q = exc.at("position").at(i).get<double>() * kRadianPerDegree;
    const Json& curve = exc.at("curves").at(0);
    EXPECT_NEAR(curve.at("value").at(i).get<double>(), basis.value(q, coefficients) * 1e6, 1e-3);
    EXPECT_LE(curve.at("U95").at(i).get<double>(), 1.96 + 1e-2) << "1 um of standard uncertainty of a node";
  }
}

/// The line of A is its own: its errors are the identified ones, and 100 mm along X it is off by
/// 0.1 m x (EB0A -> -z, EC0A -> +y) more.
TEST_F(RotaryPages, LinesPassWhereTheirErrorsSay) {
  const Json page = model();
  ASSERT_EQ(page.at("reach_mm"), 100.0) << "a quarter of 600 mm, rounded down to 1, 2, 5";
  const Json& line = page.at("lines").at(0);
  ASSERT_EQ(line.at("axis"), "A");
  const auto location = [&](const std::string& name) {
    return result_.parameters[result_.layout.find_block(name)->offset] * 1e6;
  };
  EXPECT_EQ(line.at("across"), Json({"Y", "Z"}));
  const Json& at_centre = line.at("places").at(1).at("um");
  EXPECT_NEAR(at_centre.at(0).get<double>(), location("EY0A"), 1e-3);
  EXPECT_NEAR(at_centre.at(1).get<double>(), location("EZ0A"), 1e-3);
  const Json& beyond = line.at("places").at(2).at("um");
  EXPECT_NEAR(beyond.at(0).get<double>(), location("EY0A") + 0.1 * location("EC0A"), 1e-3);
  EXPECT_NEAR(beyond.at(1).get<double>(), location("EZ0A") - 0.1 * location("EB0A"), 1e-3);
  ASSERT_EQ(line.at("errors").size(), 4u);
  EXPECT_NEAR(line.at("errors").at(0).at("U95").get<double>(), 1.96, 0.01);
}

/// Y0B of a head C B turns with C as EXC and EYC; on a trunnion the spheres' places take such a displacement.
TEST_F(RotaryPages, OfAHeadSayWhatADisplacementAlongTheInnerAxisIs) {
  EXPECT_TRUE(model().at("carried").empty());
  const FitResult head = testing::rotary_result(testing::kHead);
  const Json carried =
      rotary_page(report_json(head, rotary_campaign(head.machine))).at("models").at(0).at("carried");
  ASSERT_EQ(carried.size(), 1U);
  EXPECT_EQ(carried.at(0).at("carrying"), "C");
  EXPECT_EQ(carried.at(0).at("carried"), "B");
  EXPECT_EQ(carried.at(0).at("motions"), Json({"EXC", "EYC"}));
}

TEST_F(RotaryPages, MapsHoldEveryToolAndMarkTheReadings) {
  const Json page = model();
  ASSERT_EQ(page.at("maps").size(), 2u);
  const std::size_t places =
      page.at("map_axes").at(0).at("places").size() * page.at("map_axes").at(1).at("places").size();
  for (const Json& map : page.at("maps")) {
    for (const char* part : {"position", "orientation"}) {
      ASSERT_EQ(map.at(part).size(), 4u);
      for (const Json& layer : map.at(part)) EXPECT_EQ(layer.at("value").size(), places);
    }
  }
  EXPECT_EQ(page.at("map_axes").at(1).at("dots"), Json({-90.0, 0.0, 90.0}));
  const Json& position = page.at("maps").at(0).at("position");
  const auto at = [&](std::size_t layer) { return position.at(layer).at("value").at(77).get<double>(); };
  EXPECT_NEAR(at(0), std::hypot(at(1), at(2), at(3)), 2e-3 * at(0)) << "the size of its components";
}

TEST_F(RotaryPages, AreDrawn) {
  const auto drawing = test::draw_report(report_json(result_, rotary_campaign(result_.machine)));
  if (!drawing.possible) GTEST_SKIP() << "there is no Node here";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
}

/// Two models with rotary axes and one without: the page of a comparison has those that were identified.
TEST_F(RotaryPages, OfAComparisonHoldTheIdentifiedModels) {
  const Campaign campaign = rotary_campaign(result_.machine);
  std::vector<ComparedModel> models;
  for (const char* name : {"nominal machine", "result"}) models.push_back(compared_model(name, campaign, {}));
  EXPECT_TRUE(rotary_page(report_json(ComparisonView{models}, campaign)).is_null());
  models.back().rotary = rotary_pictures(result_, campaign);
  const Json one = rotary_page(report_json(ComparisonView{models}, campaign));
  ASSERT_EQ(one.at("models").size(), 1u);
  EXPECT_EQ(one.at("models").at(0).at("name"), "result");
  models.front().rotary = rotary_pictures(testing::rotary_result(testing::kHead), campaign);
  const auto drawing = test::draw_report(report_json(ComparisonView{models}, campaign));
  if (!drawing.possible) GTEST_SKIP() << "there is no Node here";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
}

TEST(RotaryPagesOfALinearMachine, AreLeftOut) {
  const Machine machine = testing_support::machine_of("w X Y b Z t");
  const FitResult result = testing::result_with(machine, {.locations = {{"EC0Y", 1e-6}}}, 1);
  Campaign campaign;
  campaign.machine = machine;
  EXPECT_FALSE(rotary_pictures(result, campaign));
}

Json picture_of_tables(const FitResult& result, const std::string& format, const std::string& type) {
  TableFormatOptions options;
  options.type = CompensationType::parse(type);
  const MadeTables made = make_tables(*find_table_format(format), result, options);
  const std::string html = tables_picture(result, made).html;
  const std::string begin = "<script type=\"application/json\" id=\"volcal-data\">";
  const std::size_t from = html.find(begin) + begin.size();
  return Json::parse(html.substr(from, html.find("</script>", from) - from));
}

/// R-POS alone turns C by -(ECC + EC0C) and moves nothing else, whatever the table's step of 5 degrees
/// leaves.
TEST_F(RotaryPages, TablesTurnAnAxisAgainstItsError) {
  if (!report_available()) GTEST_SKIP() << "no report";
  const Json data = picture_of_tables(result_, "neutral-csv", "R-POS").at("pages").at(0).at("data");
  const Json& c = data.at("axes").at(1);
  ASSERT_EQ(c.at("axis"), "C");
  const ErrorSymbol ecc = *ErrorSymbol::parse("ECC");
  const auto place = *result_.layout.find(ecc);
  const Basis& basis = *result_.layout.groups[static_cast<std::size_t>(place.group)].basis;
  const Eigen::VectorXd coefficients = result_.layout.coefficients(ecc, result_.parameters);
  const double zero = result_.parameters[result_.layout.find_block("EC0C")->offset];
  for (const std::size_t i : {3U, 20U, 50U}) {
    const double q = c.at("position").at(i).get<double>() * kRadianPerDegree;
    EXPECT_NEAR(c.at("turned").at(i).get<double>(), -1e6 * (basis.value(q, coefficients) + zero), 0.2);
  }
  for (const Json& moved : c.at("moved")) {
    for (const Json& value : moved.at("value")) EXPECT_EQ(value.get<double>(), 0.0);
  }
}

/// With R-VOL by the grid of Table 3 the tool point has its place back, the tool's axis not.
TEST_F(RotaryPages, TablesTakeTheErrorOfTheMapAway) {
  if (!report_available()) GTEST_SKIP() << "no report";
  const Json document = picture_of_tables(result_, "csv", "L-VOL+R-VOL");
  const Json& data = document.at("pages").at(0).at("data");
  const auto largest = [](const Json& values) {
    double most = 0.0;
    for (const Json& value : values) most = std::max(most, value.get<double>());
    return most;
  };
  const std::size_t nodes =
      data.at("map_axes").at(0).at("places").size() * data.at("map_axes").at(1).at("places").size();
  EXPECT_EQ(data.at("before").at("position").size(), nodes);
  EXPECT_GT(largest(data.at("before").at("position")), 20.0);
  EXPECT_LT(largest(data.at("left").at("position")), 0.5);
  EXPECT_GT(largest(data.at("left").at("orientation")), 10.0);
  const test::Drawing drawing = test::draw_report(document.dump());
  if (!drawing.possible) GTEST_SKIP() << "no Node.js here";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
  EXPECT_NE(drawing.output.find("1 sections, 8 plots"), std::string::npos) << drawing.output;
}

TEST_F(RotaryPages, TablesOfLinearAxesAreNotPictured) {
  TableFormatOptions options;
  options.type = CompensationType::parse("L-VOL");
  const MadeTables made = make_tables(*find_table_format("neutral-csv"), result_, options);
  EXPECT_THROW(tables_picture(result_, made), InputError);
}

}  // namespace
}  // namespace volcal
