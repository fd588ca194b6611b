// Two names for one cause, from campaigns of sim/: the square of a temperature is no name of the catalogue.

#include "volcal/identify/criticism/search/one_cause.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <set>
#include <string>

#include "tests/support/search_states.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;
using testing_support::hiding;
using testing_support::setting_of;
using testing_support::test_of;

const Eigen::Vector3i kOneCauseGrid{5, 4, 4};

sim::HiddenEffect tilt_by(const std::string& kind, double rms) {
  sim::HiddenEffect effect{.kind = kind, .options = {}, .rms = rms};
  effect.options.set("symbol", std::string("EAZ"));
  effect.options.set("channel", std::string("column"));
  return effect;
}

sim::HiddenEffect squareness_that_drifts() {
  sim::HiddenEffect effect{.kind = "squareness-drift", .options = {}, .rms = 2.0e-6};
  effect.options.set("symbol", std::string("EC0Y"));
  return effect;
}

sim::HiddenEffect expansion_of_y() {
  sim::HiddenEffect effect{.kind = "scale-expansion", .options = {}, .rms = 2.0e-6};
  effect.options.set("axis", std::string("Y"));
  effect.options.set("channel", std::string("column"));
  return effect;
}

sim::HiddenEffect roll_along_y() {
  sim::HiddenEffect effect{.kind = "cross-axis", .options = {}, .rms = 3.0e-6};
  effect.options.set("symbol", std::string("EAZ"));
  effect.options.set("by", std::string("Y"));
  effect.options.set("power", 2.0);
  return effect;
}

/// With a curve of EAZ by y and the expansion of Y by the column's temperature in the model.
ModelState with_a_curve_and_a_name(const LinearModel& model) {
  const ModelState given = ModelState(model, setting_of(model)).tested();
  UnknownFinding finding;
  finding.variables = testing_support::variables_named({"y"});
  finding.direction = ScanDirection::Z;
  finding.rotation = ErrorSymbol{Component::A, AxisName::Z};
  const EffectSpec spec = surfaces_for(model, finding).at(0);
  const std::shared_ptr<const Effect> curve = find_effect(spec.kind)->make(spec, {});
  const double evidence = surface_evidence(model, given.projector(), *curve);
  const ModelState drawn = given.with_surface({spec, curve, finding, evidence}, {}).tested();
  return drawn.with(test_of(drawn, {"scale-expansion", "EYY", "T_column", "linear"})).tested();
}

/// With the tilt by the temperature itself and the drift of a squareness in the model.
ModelState with_two_names(const LinearModel& model) {
  const ModelState given = ModelState(model, setting_of(model)).tested();
  const ModelState one = given.with(test_of(given, {"thermal-drift", "EAZ", "T_column", "linear"})).tested();
  return one.with(test_of(one, {"squareness-drift", "EC0Y", "time", "linear"})).tested();
}

TEST(OneCause, TheSquareOfATemperatureTakesThePlaceOfTwoNames) {
  const FittedStudy study(hiding({tilt_by("temperature-squared", 3.0e-6)}, kOneCauseGrid));
  const ModelState state = with_two_names(study.model);
  const auto cause = one_cause_of_two(state);
  ASSERT_TRUE(cause.has_value());
  EXPECT_EQ(cause->replaces, (std::set<std::size_t>{0, 1}));
  EXPECT_EQ(cause->surface.effect->name().target.name(), "EAZ");
  EXPECT_EQ(cause->surface.effect->name().driver.name(), "T_column");
  EXPECT_EQ(names_of(cause->surface.finding.variables), (std::vector<std::string>{"T_column"}));
  EXPECT_GT(cause->surface.log_evidence, 5.0);
}

/// Both names are right, and no function of the temperature alone does what they do together.
TEST(OneCause, TwoCausesStay) {
  const FittedStudy study(hiding({tilt_by("thermal-tilt", 2.0e-6), squareness_that_drifts()}, kOneCauseGrid));
  EXPECT_FALSE(one_cause_of_two(with_two_names(study.model)).has_value());
}

/// A backlash that grows along the travel has two names, one function.
TEST(OneCause, TwoNamesOfOneFunctionStay) {
  sim::HiddenEffect constant = testing_support::reversal("EYY", 0.0), growing = constant;
  growing.kind = "reversal-position";
  constant.rms.reset();
  growing.rms.reset();
  constant.amplitude = 1.6e-6;
  growing.amplitude = -4e-6;
  const FittedStudy study(hiding({constant, growing}, kOneCauseGrid));
  const ModelState given = ModelState(study.model, setting_of(study.model)).tested();
  const ModelState one = given.with(test_of(given, {"reversal", "EYY", "dir_y", "step"})).tested();
  const ModelState two = one.with(test_of(one, {"position-reversal", "EYY", "dir_y y", ""})).tested();
  EXPECT_FALSE(one_cause_of_two(two).has_value());
}

/// A roll that grows with y and with the temperature together: a curve by y leaves the temperature's part to
/// the name that is most like it.
TEST(OneCause, ASurfaceOfTwoVariablesTakesThePlaceOfACurveAndAName) {
  sim::HiddenEffect tilt = tilt_by("thermal-tilt", 3.0e-6);
  tilt.options.set("by", std::string("Y"));
  const FittedStudy study(hiding({tilt}, kOneCauseGrid));
  const ModelState state = with_a_curve_and_a_name(study.model);
  const auto cause = one_cause_of_surface_and_name(state);
  ASSERT_TRUE(cause.has_value());
  EXPECT_EQ(cause->replaces, std::set<std::size_t>{0});
  EXPECT_EQ(cause->replaces_surface, std::optional<std::size_t>(0));
  EXPECT_EQ(cause->surface.effect->name().target.name(), "EAZ");
  EXPECT_EQ(cause->surface.effect->name().driver.name(), "y T_column");
  EXPECT_GT(cause->surface.log_evidence, state.surfaces()[0].log_evidence);
}

/// A roll by y alone, and an expansion: a surface of both variables does not do what they do together.
TEST(OneCause, ACurveAndANameThatAreBothThereStay) {
  const FittedStudy study(hiding({roll_along_y(), expansion_of_y()}, kOneCauseGrid));
  EXPECT_FALSE(one_cause_of_surface_and_name(with_a_curve_and_a_name(study.model)).has_value());
}

}  // namespace
}  // namespace volcal
