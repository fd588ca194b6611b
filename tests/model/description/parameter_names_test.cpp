#include "volcal/model/description/parameter_names.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

using PointKind = NamedPoint::Kind;

TEST(ParameterNames, AreThoseOfResults) {
  EXPECT_EQ(tool_parameter("long probe"), "tool long probe");
  EXPECT_EQ(expansion_parameter(AxisName::Z), "expansion Z");
  EXPECT_EQ(length_scale_parameter("laser-tracer"), "length scale laser-tracer");
  EXPECT_EQ(station_parameter("P1"), "station P1");
  EXPECT_EQ(sphere_parameter("S1"), "sphere S1");
  EXPECT_EQ(centre_parameter("circle XY"), "circle XY: centre");
}

TEST(ParameterNames, PointsAreFoundByTheirNames) {
  const auto is = [](const std::string& parameter, PointKind kind, const std::string& name) {
    const auto point = named_point(parameter);
    return point && point->kind == kind && point->name == name;
  };
  EXPECT_TRUE(is(station_parameter("P1"), PointKind::Station, "P1"));
  EXPECT_TRUE(is(sphere_parameter("on the table"), PointKind::Sphere, "on the table"));
  EXPECT_TRUE(is(centre_parameter("circle XY"), PointKind::Centre, "circle XY"));
  for (const char* other : {"EXX", "EC0Y", "tool long", "S1: dead path", "length scale laser-tracer", ""})
    EXPECT_FALSE(named_point(other).has_value()) << other;
}

TEST(ParameterNames, ALengthScaleIsKnownByItsName) {
  EXPECT_TRUE(is_length_scale(length_scale_parameter("A")));
  EXPECT_FALSE(is_length_scale("expansion X"));
}

}  // namespace
}  // namespace volcal
