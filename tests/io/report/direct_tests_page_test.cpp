// The page of axis-of-rotation tests and of drift at rest: numbers by hand, and its renderer run.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/io/report/drawing.h"
#include "tests/support/machines.h"
#include "tests/support/residual_records.h"
#include "volcal/identify/report/report.h"

namespace volcal {
namespace {

using testing::records_times;

using Json = nlohmann::json;

void add_row(Setup& setup, double c, const Eigen::Vector3d& micrometres) {
  for (const AxisName axis : kAllAxes)
    setup.readings.position[index_of(axis)].push_back(axis == AxisName::C ? c : 0.0);
  for (std::size_t k = 0; k < 3; ++k)
    setup.readings.value[k].push_back(micrometres[static_cast<int>(k)] * 1e-6);
  setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.size()) + 2);
}

/// A sphere on C, off by 9 um, that moves by 2 cos 2q um along X; an hour and a half at rest, Z 0, 3, 4, 4
/// um, beside a column from 20 to 23 degC; the angle of C at two targets, 1 and 5 urad.
Campaign direct_campaign() {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine = testing_support::machine_of("w C' b X Y Z t");
  campaign.machine.tools = {{"probe", Eigen::Vector3d::Zero(), 0.0}};
  Setup sphere, rest, angle;
  sphere.name = "sphere <1>";
  rest.name = "rest";
  sphere.instrument = rest.instrument = "r-test";
  for (Setup* setup : {&sphere, &rest}) {
    setup->readings.value.resize(3);
    setup->options.set("frame", std::string("machine"));
  }
  for (int k = 0; k < 12; ++k) {
    const double q = k * std::numbers::pi / 6.0;
    add_row(sphere, q, {9.0 * std::cos(q) + 2.0 * std::cos(2.0 * q), -9.0 * std::sin(q), 0.5});
  }
  const double um[] = {0.0, 3.0, 4.0, 4.0};
  for (int k = 0; k < 4; ++k) {
    add_row(rest, 0.0, {0.0, 0.0, um[k]});
    rest.readings.time.push_back(1800.0 * k);
    rest.readings.temperature["column"].push_back(20.0 + k);
  }
  angle.name = "angle";
  angle.instrument = "angle";
  angle.options.set("axis", Eigen::Vector3d(0, 0, 1));
  angle.readings.value.resize(3);
  add_row(angle, 0.1, {1.0, 0.0, 0.0});
  add_row(angle, 0.2, {5.0, 0.0, 0.0});
  angle.readings.value.resize(1);
  campaign.setups = {sphere, rest, angle};
  return campaign;
}

class DirectTestsPage : public ::testing::Test {
 protected:
  DirectTestsPage() {
    models_.push_back(compared_model("nominal machine", campaign_, records_times(campaign_, 0.0)));
    models_.push_back(compared_model("half", campaign_, records_times(campaign_, 0.5)));
    document_ = report_json(ComparisonView{models_}, campaign_);
  }
  Json page(const std::string& kind) const {
    const Json whole = Json::parse(document_);
    for (const Json& page : whole.at("pages")) {
      if (page.at("kind") == kind) return page.at("data");
    }
    return {};
  }

  Campaign campaign_ = direct_campaign();
  std::vector<ComparedModel> models_;
  std::string document_;
};

TEST_F(DirectTestsPage, HoldsErrorMotionsAboutTheirCentre) {
  const Json motions = page("direct_tests").at("motions");
  ASSERT_EQ(motions.size(), 4u);
  const Json& radial = motions.at(0);
  EXPECT_EQ(radial.at("motion"), "radial X");
  ASSERT_EQ(radial.at("sources").size(), 3u);
  EXPECT_NEAR(radial.at("sources").at(0).at("total").get<double>(), 4.0, 1e-6);
  EXPECT_NEAR(radial.at("sources").at(2).at("total").get<double>(), 2.0, 1e-6);
  EXPECT_EQ(radial.at("sources").at(1).at("total"), 0) << "the nominal machine predicts none";
  EXPECT_NEAR(radial.at("sources").at(0).at("value").at(0).get<double>(), 2.0, 1e-6)
      << "the sphere's 9 um are taken out";
  EXPECT_EQ(radial.at("angle").at(3), 90);
}

TEST_F(DirectTestsPage, HoldsDriftAndTemperatures) {
  const Json drifts = page("direct_tests").at("drifts");
  ASSERT_EQ(drifts.size(), 3u);
  const Json& z = drifts.at(2);
  EXPECT_EQ(z.at("drift"), "Z displacement");
  EXPECT_EQ(z.at("temperatures"), "column 20.0 to 23.0 degC");
  EXPECT_EQ(z.at("sources").at(0).at("range"), 4);
  EXPECT_EQ(z.at("sources").at(0).at("first_hour"), 4);
  EXPECT_EQ(z.at("sources").at(2).at("change"), 2);
  EXPECT_EQ(z.at("time").at(0), 0) << "hours since the first reading";
  EXPECT_EQ(z.at("sources").at(0).at("value").at(0), 0);
  EXPECT_EQ(z.at("sources").at(0).at("value").size(), z.at("time").size());
  EXPECT_EQ(z.at("sources").at(2).at("value").back(), 2) << "the last less the first, as its figure says";
}

TEST_F(DirectTestsPage, AnglesStandBesideLinesInTheirOwnUnits) {
  const Json cards = page("positioning").at("cards");
  ASSERT_EQ(cards.size(), 1u);
  EXPECT_EQ(cards.at(0).at("unit"), "µrad");
  EXPECT_EQ(cards.at(0).at("abscissa"), "C [°]");
  EXPECT_NEAR(cards.at(0).at("position").at(0).get<double>(), 0.1 * 180.0 / std::numbers::pi, 1e-4);
  EXPECT_EQ(cards.at(0).at("sources").at(0).at("positive").at("mean"), Json({1, 5}));
}

TEST_F(DirectTestsPage, IsDrawn) {
  const auto drawing = test::draw_report(document_);
  if (!drawing.possible) GTEST_SKIP() << "there is no Node here";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
}

}  // namespace
}  // namespace volcal
