// Which measured position stands for one that was not measured: by hand, in degrees.

#include "volcal/model/description/measured_ends.h"

#include <gtest/gtest.h>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kDegreeOfC = kRadianPerDegree;

Axis c_axis(double first_deg, double last_deg) {
  Axis axis;
  axis.name = AxisName::C;
  axis.travel_min = first_deg * kDegreeOfC;
  axis.travel_max = last_deg * kDegreeOfC;
  return axis;
}

FunctionSpec series() {
  FunctionSpec spec;
  spec.basis = "fourier";
  spec.degree = 1;
  spec.coefficients = {0.0, 1e-6, 2e-6};
  return spec;
}

FunctionSpec polyline(double last) {
  FunctionSpec spec;
  spec.degree = 1;
  spec.breakpoints = {0.0, 180.0 * kDegreeOfC, 360.0 * kDegreeOfC};
  spec.coefficients = {1e-6, 3e-6, last};
  return spec;
}

ModelSpec model_of(const FunctionSpec& function) {
  ModelSpec model;
  model.functions[{Component::X, AxisName::C}] = function;
  model.measured[AxisName::C] = {0.0, 120.0 * kDegreeOfC};
  return model;
}

double held_deg(const MeasuredEnds& ends, double position_deg) {
  return ends.nearest(position_deg * kDegreeOfC) / kDegreeOfC;
}

// Measured 0 to 120 of 0 to 360: 240 is 120 away from either end, 230 is nearer to 120, 250 to 360 = 0.
TEST(MeasuredEnds, HoldTheNearestPositionOnTheCircle) {
  const MeasuredEnds ends = measured_ends(c_axis(0.0, 360.0), model_of(series()));
  EXPECT_TRUE(ends.goes_round);
  for (const auto& [position, held] : {std::pair(360.0, 0.0),
                                       {350.0, 0.0},
                                       {250.0, 0.0},
                                       {230.0, 120.0},
                                       {121.0, 120.0},
                                       {70.0, 70.0},
                                       {430.0, 70.0},
                                       {-10.0, 0.0}})
    EXPECT_NEAR(held_deg(ends, position), held, 1e-9) << position;
  EXPECT_FALSE(ends.is_beyond(360.0 * kDegreeOfC));
  EXPECT_FALSE(ends.is_beyond(430.0 * kDegreeOfC));
  EXPECT_TRUE(ends.is_beyond(350.0 * kDegreeOfC));
  EXPECT_TRUE(ends.is_beyond(130.0 * kDegreeOfC));
}

TEST(MeasuredEnds, HoldTheEndWhereAnAxisDoesNotGoRound) {
  for (const MeasuredEnds& ends : {measured_ends(c_axis(0.0, 300.0), model_of(series())),
                                   measured_ends(c_axis(0.0, 360.0), model_of(polyline(2e-6)))}) {
    EXPECT_FALSE(ends.goes_round);
    EXPECT_NEAR(held_deg(ends, 290.0), 120.0, 1e-9);
    EXPECT_TRUE(ends.is_beyond(290.0 * kDegreeOfC));
  }
  EXPECT_TRUE(measured_ends(c_axis(0.0, 360.0), model_of(polyline(1e-6))).goes_round);
}

// A whole turn that was measured covers any travel.
TEST(MeasuredEnds, CoverTheTravelOnceATurnWasMeasured) {
  ModelSpec model = model_of(series());
  model.measured[AxisName::C] = {-180.0 * kDegreeOfC, 180.0 * kDegreeOfC};
  const Axis wide = c_axis(-200.0, 200.0);
  EXPECT_TRUE(measured_ends(wide, model).cover(wide));
  EXPECT_NEAR(held_deg(measured_ends(wide, model), 190.0), -170.0, 1e-9);
  EXPECT_FALSE(measured_ends(wide, model).is_beyond(190.0 * kDegreeOfC));
  model.functions[{Component::X, AxisName::C}] = polyline(2e-6);
  EXPECT_FALSE(measured_ends(wide, model).cover(wide));
  const Axis turn = c_axis(0.0, 360.0);
  EXPECT_FALSE(measured_ends(turn, model_of(series())).cover(turn));
}

/// [90, 90] says where an axis without error motions stood: nothing of it is held there.
TEST(MeasuredEnds, AreNoneWhereAnAxisStoodStill) {
  ModelSpec model;
  model.measured[AxisName::C] = {1.5, 1.5};
  EXPECT_TRUE(stood_still(AxisName::C, model));
  EXPECT_FALSE(measured_ends(c_axis(0.0, 360.0), model).is_beyond(0.0));
  model.functions[{Component::X, AxisName::C}] = series();
  EXPECT_FALSE(stood_still(AxisName::C, model));
  EXPECT_TRUE(measured_ends(c_axis(0.0, 360.0), model).is_beyond(0.0));
}

TEST(MeasuredEnds, AreNoneWhereNothingIsStated) {
  ModelSpec model = model_of(series());
  model.measured.clear();
  const MeasuredEnds ends = measured_ends(c_axis(0.0, 360.0), model);
  EXPECT_EQ(ends.nearest(7.5), 7.5);
  EXPECT_FALSE(ends.is_beyond(7.5));
}

}  // namespace
}  // namespace volcal
