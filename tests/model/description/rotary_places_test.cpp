// Places of a rotary axis within a turn, by hand.

#include "volcal/model/description/rotary_places.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/effect_campaign.h"

namespace volcal {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180.0;

std::vector<double> places_of(const std::vector<double>& degrees) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w C' b X Y Z t");
  volcal::Setup setup;
  for (const double angle : degrees) {
    for (const AxisName axis : kAllAxes)
      setup.readings.position[index_of(axis)].push_back(axis == AxisName::C ? angle * kOneDegree : 0.0);
    setup.readings.source_line.push_back(2);
  }
  setup.readings.value = {std::vector<double>(degrees.size(), 0.0)};
  campaign.setups = {setup};
  return places_in_turn(campaign, AxisName::C);
}

TEST(RotaryPlaces, AreCountedOnceATurn) {
  const std::vector<double> places = places_of({-180.0, -90.0, 0.0, 90.0, 180.0, 360.0, 450.0});
  ASSERT_EQ(places.size(), 4u);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(places[static_cast<std::size_t>(k)], 90.0 * k * kOneDegree, 1e-12);
}

/// 0.001 degrees are the same place, on either side of home too; 0.1 degrees are another.
TEST(RotaryPlaces, AreApartByMoreThanATenThousandthOfARadian) {
  EXPECT_EQ(places_of({359.999, 0.0, 0.001, 30.0}).size(), 2u);
  EXPECT_EQ(places_of({0.0, 0.1, 30.0}).size(), 3u);
}

TEST(RotaryPlaces, TellFewerThanHalfAsManyPeriods) {
  EXPECT_EQ(most_periods(places_of({0.0})), 0);
  EXPECT_EQ(most_periods(places_of({0.0, 180.0})), 0);
  EXPECT_EQ(most_periods(places_of({0.0, 120.0, 240.0})), 1);
  EXPECT_EQ(most_periods(places_of({0.0, 90.0, 180.0, 270.0})), 1);
  EXPECT_EQ(most_periods(places_of({0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330})), 5);
}

TEST(RotaryPlaces, AreRegularAtEndsOfEqualPartsOfATurn) {
  EXPECT_EQ(regular_parts(places_of({0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330})), 12);
  EXPECT_EQ(regular_parts(places_of({10, 40, 70, 100, 130, 160, 190, 220, 250, 280, 340})), 12);
  EXPECT_EQ(regular_parts(places_of({-30, -15, 0, 15, 30})), 24);
  EXPECT_EQ(regular_parts(places_of({0, 15, 30, 45, 60})), 24);
  EXPECT_EQ(regular_parts(places_of({0, 31, 60, 92, 120, 149})), 0);
  EXPECT_EQ(regular_parts(places_of({0, 50, 100, 150})), 0) << "fifty degrees divide no turn";
  EXPECT_EQ(regular_parts(places_of({0, 180})), 0);
}

}  // namespace
}  // namespace volcal
