/// Units at the edge: factors by hand, each the inverse of what it is written with.

#include "volcal/model/description/units.h"

#include <gtest/gtest.h>

#include <numbers>

namespace volcal {
namespace {

TEST(Units, PositionsAreInMillimetresOrDegrees) {
  EXPECT_EQ(position_unit(AxisName::Z).suffix, "mm");
  EXPECT_EQ(position_unit(AxisName::Z).si_per_unit, 1e-3);
  EXPECT_EQ(position_unit(AxisName::B).suffix, "deg");
  EXPECT_EQ(position_unit(AxisName::B).si_per_unit, std::numbers::pi / 180.0);
  EXPECT_EQ(position_column(AxisName::X), "x_mm");
  EXPECT_EQ(position_column(AxisName::C), "c_deg");
  for (const AxisName axis : kAllAxes) {
    const Unit unit = unit_of_key(position_column(axis));
    EXPECT_EQ(unit.suffix, position_unit(axis).suffix);
    EXPECT_EQ(unit.si_per_unit, position_unit(axis).si_per_unit);
  }
}

TEST(Units, ConstantsAreThoseOfTheKeys) {
  EXPECT_EQ(unit_of_key("length_um").si_per_unit, kMetrePerMicrometre);
  EXPECT_EQ(unit_of_key("angle_urad").si_per_unit, kRadianPerMicroradian);
  EXPECT_EQ(unit_of_key("squareness_mrad").si_per_unit, kRadianPerMilliradian);
  EXPECT_EQ(unit_of_key("length_mm").si_per_unit, kMetrePerMillimetre);
  EXPECT_EQ(unit_of_key("azimuth_deg").si_per_unit, kRadianPerDegree);
  EXPECT_EQ(unit_of_key("feed_mm_min").si_per_unit, kMetrePerMillimetre / kSecondsPerMinute);
  EXPECT_EQ(unit_of_key("drift_um_per_h").si_per_unit, kMicro / kSecondsPerHour);
  EXPECT_EQ(kPerMicro * kMicro, 1.0);
  EXPECT_EQ(kPerMilli * kMetrePerMillimetre, 1.0);
}

}  // namespace
}  // namespace volcal
