// Surfaces of a fitted model in its report, with coefficients of which the values are known: those at the
// nodes of a variable make a straight line of it, and splines add up to one.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/io/report/drawing.h"
#include "tests/io/report/synthetic_fit.h"
#include "tests/support/straight_surface.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/values/drawn_surfaces.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using testing_support::add_straight_surface;
using testing_support::stated_surface;

class SurfacePage : public ::testing::Test {
 protected:
  SurfacePage() : fit_(test::synthetic_fit()) {
    FitResult& result = fit_.result;
    add_straight_surface(result, stated_surface("EYX", "x", {-400.0}, {400.0}, {4}), 0);
    EffectSpec reversing = stated_surface("EAY", "y z", {-250.0, -450.0}, {250.0, 0.0}, {3, 2});
    reversing.options.set("factor", std::string("dir_y"));
    reversing.options.set("only", std::string("tool short"));
    add_straight_surface(result, reversing, 1);
    add_straight_surface(
        result, stated_surface("EXX", "x y z", {-400.0, -250.0, -450.0}, {400.0, 250.0, 0.0}, {2, 2, 2}), 2);
    for (volcal::Setup& setup : fit_.campaign.setups)
      setup.readings.direction[1].assign(setup.readings.size(), 1);
  }

  Json page() const {
    const Json document = Json::parse(report_json(fit_.result, fit_.campaign));
    for (const Json& each : document.at("pages")) {
      if (each.at("kind") == "surfaces") return each.at("data").at("surfaces");
    }
    return {};
  }

  test::SyntheticFit fit_;
};

TEST_F(SurfacePage, ACurveHasItsValuesAndBand) {
  const Json curve = page().at(0);
  EXPECT_EQ(curve.at("label"), "curve EYX by x");
  EXPECT_EQ(curve.at("target"), "EYX");
  EXPECT_EQ(curve.at("unit"), "µm");
  ASSERT_EQ(curve.at("axes").size(), 1u);
  const Json& places = curve.at("axes").at(0).at("places");
  ASSERT_EQ(places.size(), curve.at("value").size());
  EXPECT_EQ(curve.at("axes").at(0).at("title"), "x [mm]");
  EXPECT_EQ(places.front(), -400.0);
  EXPECT_EQ(places.back(), 400.0);
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_NEAR(curve.at("value").at(i).get<double>(), 10.0 * (places.at(i).get<double>() + 400.0) / 800.0,
                2e-3);
  EXPECT_EQ(curve.at("largest"), 10.0);
  EXPECT_EQ(curve.at("at").at(0), 400.0);
  // One spline alone is one at an end.
  EXPECT_NEAR(curve.at("largest_U95").get<double>(), 1.96, 0.05);
  EXPECT_NEAR(curve.at("U95").front().get<double>(), 1.96, 1e-2);
  // At the middle knot of four pieces cubic splines are 1/6, 2/3, 1/6.
  const double middle = 1.96 * std::sqrt(2.0 / 36.0 + 4.0 / 9.0);
  EXPECT_NEAR(curve.at("U95").at(places.size() / 2).get<double>(), middle, 1e-2);
  // The root mean square of u over 0..1 is 1/sqrt(3).
  EXPECT_NEAR(curve.at("rms").get<double>(), 10.0 / std::sqrt(3.0), 0.2);
}

TEST_F(SurfacePage, ASurfaceHasItsValuesAndTheReadingsOnWhichItActs) {
  const Json surface = page().at(1);
  EXPECT_EQ(surface.at("label"), "surface EAY of short by dir_y y z");
  EXPECT_EQ(surface.at("factor"), "dir_y");
  EXPECT_EQ(surface.at("unit"), "µrad");
  const Json &y = surface.at("axes").at(0), &z = surface.at("axes").at(1);
  const std::size_t of_z = z.at("places").size();
  ASSERT_EQ(surface.at("value").size(), y.at("places").size() * of_z);
  for (const std::size_t i : {std::size_t{0}, std::size_t{5}, y.at("places").size() - 1}) {
    for (std::size_t j = 0; j < of_z; ++j) {
      EXPECT_NEAR(surface.at("value").at(i * of_z + j).get<double>(),
                  10.0 * (z.at("places").at(j).get<double>() + 450.0) / 450.0, 2e-3);
    }
  }
  // All setups but T2 have the short tool: 500, two circles of 180, two diagonals of 21.
  EXPECT_EQ(y.at("dots").size(), 902u);
  EXPECT_EQ(z.at("dots").size(), 902u);
  EXPECT_NEAR(y.at("dots").at(0).get<double>(), 1e3 * fit_.campaign.setups[0].readings.position[1][0], 0.05);
}

TEST_F(SurfacePage, AThirdVariableStandsWhereTheValueIsLargest) {
  const Json surface = page().at(2);
  EXPECT_EQ(surface.at("third"), "z");
  EXPECT_EQ(surface.at("third_at"), 0.0);
  ASSERT_EQ(surface.at("axes").size(), 2u);
  for (const Json& value : surface.at("value")) EXPECT_NEAR(value.get<double>(), 10.0, 2e-3);
}

/// Positions of readings stand in the frame of the fit.
TEST_F(SurfacePage, AnAlignedResultHasNoReadings) {
  fit_.result.alignment = "primary Y, secondary X, origin X=0 Y=0 Z=0 mm";
  const Json surfaces = page();
  ASSERT_EQ(surfaces.size(), 3u);
  EXPECT_TRUE(surfaces.at(0).at("axes").at(0).at("dots").empty());
}

TEST_F(SurfacePage, IsDrawn) {
  const test::Drawing drawing = test::draw_report(report_json(fit_.result, fit_.campaign));
  if (!drawing.possible) GTEST_SKIP() << "no Node.js here";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
}

TEST_F(SurfacePage, ALineOfTextStatesTheLargestValue) {
  const auto surfaces = surface_values(fit_.result);
  ASSERT_EQ(surfaces.size(), 3u);
  EXPECT_EQ(report::surface_line(surfaces[0], 1.96), "curve EYX by x: up to 10.0 +- 2.0 um at x = 400 mm");
  ASSERT_EQ(surfaces[1].at.size(), 2u);  // any y: the values are those of z alone
  EXPECT_EQ(surfaces[1].at[1], 0.0);
}

TEST(SurfacesOfAModel, WithoutAnyThereIsNoPage) {
  const test::SyntheticFit fit = test::synthetic_fit();
  EXPECT_EQ(report_json(fit.result, fit.campaign).find("\"surfaces\""), std::string::npos);
}

}  // namespace
}  // namespace volcal
