// What makes a circle, and what makes the error in the volume: against figures by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/io/report/synthetic_fit.h"
#include "tests/support/hand_made_diagnosis.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/report/values/circle_causes.h"
#include "volcal/identify/report/values/volume_causes.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

/// A circle of 100 mm in XY about the middle of a machine of 1 m, there and back, readings that the model is
/// to predict.
Campaign circle_campaign() {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine.name = "square";
  campaign.machine.structure = Structure::parse("w X Y b Z t");
  for (const AxisName name : {AxisName::X, AxisName::Y, AxisName::Z}) {
    Axis axis;
    axis.name = name;
    axis.travel_max = 1.0;
    campaign.machine.axes.push_back(axis);
  }
  campaign.machine.tools = {{"bar", Eigen::Vector3d::Zero(), 0.0}};
  campaign.machine.datum.primary = AxisName::X;
  campaign.machine.datum.secondary = AxisName::Y;
  Setup bar;
  bar.name = "XY";
  bar.instrument = "ball-bar";
  bar.options.set("centre", Eigen::Vector3d(0.5, 0.5, 0.5));
  bar.options.set("length_sigma", 0.0);
  bar.noise.set("constant", 1e-6);
  bar.has_noise = true;
  bar.readings.value.resize(1);
  for (const int sense : {+1, -1}) {
    for (int k = 0; k < 72; ++k) {
      const double angle = sense * k * std::numbers::pi / 36.0;
      bar.readings.position[0].push_back(0.5 + 0.1 * std::cos(angle));
      bar.readings.position[1].push_back(0.5 + 0.1 * std::sin(angle));
      bar.readings.position[2].push_back(0.5);
      bar.readings.value[0].push_back(0.1);
      bar.readings.line.push_back(sense > 0 ? 0 : 1);
      bar.readings.source_line.push_back(static_cast<std::int64_t>(bar.readings.source_line.size()) + 2);
    }
  }
  campaign.setups = {bar};
  return campaign;
}

/// Squareness of 20 urad moves the radius by 0.1 m x 20e-6 x sin a cos a: a range of 2 um, an RMS of
/// 2 / sqrt 8 um. Its uncertainty of 1 urad: 0.1 um.
TEST(CircleCauses, SquarenessMakesAnEllipseOfKnownRange) {
  const Campaign campaign = circle_campaign();
  ModelSpec model = nominal_model();
  model.locations[*LocationSymbol::parse("EC0Y")] = 20e-6;
  FitResult identified = stated_result(campaign.machine, model);
  identified.covariance.setConstant(1, 1, 1e-12);
  const Evaluation evaluation = evaluate_model(campaign, model);
  const StandardFigures figures = standard_figures(campaign, evaluation.residuals);
  ASSERT_EQ(figures.circles.size(), 1U);
  const auto causes =
      circle_causes(campaign, model, evaluation.parameters, &identified, figures.circles).at(0);
  ASSERT_EQ(causes.size(), 1U);
  EXPECT_EQ(causes[0].name, "EC0Y");
  EXPECT_NEAR(causes[0].range, 2e-6, 5e-9);
  EXPECT_NEAR(causes[0].rms, 2e-6 / std::sqrt(8.0), 1e-9);
  ASSERT_TRUE(causes[0].range_u.has_value());
  EXPECT_NEAR(*causes[0].range_u, 0.1e-6, 1e-9);
  EXPECT_NEAR(causes[0].share, 1.0, 1e-9);
  // The model's own circle has that range, too.
  EXPECT_NEAR(figures.circles[0].figures.model.counter_clockwise->circular_deviation, 2e-6, 5e-9);
  EXPECT_FALSE(circle_causes(campaign, model, evaluation.parameters, nullptr, figures.circles)
                   .at(0)
                   .at(0)
                   .range_u.has_value());
}

TEST(CircleCauses, OfNoCircleNothing) {
  const Campaign campaign = circle_campaign();
  const ModelSpec model = nominal_model();
  const Evaluation evaluation = evaluate_model(campaign, model);
  EXPECT_TRUE(circle_causes(campaign, model, evaluation.parameters, nullptr, {}).empty());
  const StandardFigures figures = standard_figures(campaign, evaluation.residuals);
  EXPECT_TRUE(circle_causes(campaign, model, evaluation.parameters, nullptr, figures.circles).at(0).empty());
}

/// A reversal of EXX of 4 um puts +-2 um along X everywhere, 2 um RMS over both approaches, and its u of
/// 0.1 um becomes 0.05 um. It crosses nothing else: its share is its square over the whole's.
TEST(VolumeCauses, AFoundReversalIsRankedBesideTheErrorMotions) {
  const test::SyntheticFit fit = test::synthetic_fit();
  EffectFinding reversal = testing::found_effect("reversal", "EXX", 4e-6);
  reversal.name = EffectName::of_parts("reversal", "EXX", "dir_x", "step");
  EffectFinding station = testing::found_effect("reversal", "EXX", 4e-6);
  station.name = EffectName::of_parts("dead-path", "station P1", "time", "linear");
  station.label = "dead path P1";
  station.amplitudes[0].label = station.label;
  station.spec = effect_spec("dead-path", {{"setup", "P1"}});
  const std::vector<EffectFinding> added = {reversal, station};
  const VolumeCauses causes = volume_causes(fit.result, added);
  EXPECT_EQ(causes.tool, fit.result.machine.tools.front().name);
  const auto found = std::ranges::find_if(causes.causes, &VolumeCause::found);
  ASSERT_NE(found, causes.causes.end());
  EXPECT_EQ(found->name, "reversal EXX");
  EXPECT_NEAR(found->rms, 2e-6, 1e-10);
  ASSERT_TRUE(found->u.has_value());
  EXPECT_NEAR(*found->u, 0.05e-6, 1e-10);
  EXPECT_NEAR(found->share, std::pow(found->rms / causes.total_rms, 2), 1e-6);
  double sum = 0.0;
  for (std::size_t i = 0; i < causes.causes.size(); ++i) {
    sum += causes.causes[i].share;
    if (i > 0) {
      EXPECT_GE(causes.causes[i - 1].rms, causes.causes[i].rms);
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-9);
  EXPECT_EQ(causes.not_in_volume, std::vector<std::string>{"dead path P1"});
}

}  // namespace
}  // namespace volcal
