// Drivers of effects of rotary axes and of touch probes, by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/effect_campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/travel_since_turning.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

Campaign turned_table(const std::vector<double>& degrees) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w C' b X Y Z t");
  campaign.machine.tools = {{"probe", Vector3d::Zero(), 0.0}};
  volcal::Setup setup;
  setup.instrument = "angle";
  setup.name = "A";
  for (const double angle : degrees) {
    for (const AxisName axis : kAllAxes)
      setup.readings.position[index_of(axis)].push_back(axis == AxisName::C ? angle * kDegree : 0.0);
    setup.readings.source_line.push_back(2);
  }
  setup.readings.value = {std::vector<double>(degrees.size(), 0.0)};
  campaign.setups = {setup};
  return campaign;
}

Eigen::MatrixXd drivers_of(const Campaign& campaign, const EffectSpec& spec) {
  const auto effect = find_effect(spec.kind)->make(spec, "model.toml");
  const SetupView view{campaign,
                       campaign.setups[0],
                       std::vector<Vector3d>(campaign.setups[0].readings.size(), Vector3d::Zero()),
                       {}};
  return effect->drivers(view, effect->shape_values());
}

EffectSpec worm(double period_deg) {
  return effect_spec("worm-error", {{"symbol", std::string("ECC")}, {"period", period_deg * kDegree}});
}

/// Recorded within a turn: back over 0 to 350 deg, on to 60, back again to 330 and by half a turn to 150.
TEST(TravelSinceTurning, GoesOnOverTheEndOfATurn) {
  Campaign campaign = turned_table({40.0, 350.0, 0.0, 60.0, 30.0, 330.0, 150.0});
  Readings& readings = campaign.setups[0].readings;
  readings.direction[index_of(AxisName::C)] = {-1, -1, 1, 1, -1, -1, -1};
  const double unknown = std::numeric_limits<double>::infinity();
  const double travelled[] = {unknown, unknown, 10.0, 70.0, 30.0, 90.0, 270.0};
  const std::vector<double> found = travel_since_turning(campaign.machine, campaign.setups[0], AxisName::C);
  for (std::size_t row = 0; row < 7; ++row) {
    if (std::isinf(travelled[row])) {
      EXPECT_TRUE(std::isinf(found[row])) << row;
    } else {
      EXPECT_NEAR(found[row], travelled[row] * kDegree, 1e-12) << row;
    }
  }
}

/// Period 4 degrees: a whole wave at 4, a quarter at 1, half at 2.
TEST(WormError, RepeatsWithItsPeriod) {
  const Eigen::MatrixXd drivers = drivers_of(turned_table({0.0, 1.0, 2.0, 4.0}), worm(4.0));
  Eigen::MatrixXd expected(4, 2);
  expected << 1, 0, 0, 1, -1, 0, 1, 0;
  EXPECT_LT((drivers - expected).cwiseAbs().maxCoeff(), 1e-12);
}

/// Forty places a turn tell whole periods a turn from 3 to 19: the sine of 20 vanishes at all of them.
TEST(WormError, IsLookedForAtWholePeriodsThatThePlacesTell) {
  std::vector<double> degrees;
  for (int k = 0; k < 40; ++k) degrees.push_back(9.0 * k);
  const Campaign campaign = turned_table(degrees);
  const auto scanned = find_effect("worm-error")->make(worm(4.0), "model.toml")->scan(campaign);
  ASSERT_EQ(scanned.size(), 17u);
  EXPECT_NEAR(scanned.front()[0], 120.0 * kDegree, 1e-12);
  EXPECT_NEAR(scanned.back()[0], 360.0 / 19.0 * kDegree, 1e-12);
}

/// Both ends of a full turn are one place: 25 positions from -180 to 180 degrees are 24 places.
TEST(WormError, CountsBothEndsOfATurnOnce) {
  std::vector<double> degrees;
  for (int k = -12; k <= 12; ++k) degrees.push_back(15.0 * k);
  const auto scanned = find_effect("worm-error")->make(worm(4.0), "model.toml")->scan(turned_table(degrees));
  ASSERT_EQ(scanned.size(), 9u);
  EXPECT_NEAR(scanned.back()[0], 360.0 / 11.0 * kDegree, 1e-12);
}

/// Six places tell two periods a turn, seven three.
TEST(WormError, IsNoCandidateWherePlacesTellNoTeeth) {
  const EffectKind& kind = *find_effect("worm-error");
  EXPECT_TRUE(kind.candidates(turned_table({0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 360.0})).empty());
  EXPECT_EQ(kind.candidates(turned_table({0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0})).size(), 1u);
  EXPECT_TRUE(find_effect("ring-eccentricity")->candidates(turned_table({0.0, 180.0, 360.0})).empty());
}

/// The largest amplitude that a model file takes is that of the schema's key.
TEST(LargestAmplitude, IsThatOfTheKey) {
  const auto wave = find_effect("worm-error")->make(worm(4.0), "model.toml");
  EXPECT_NEAR(largest_amplitude(*wave, wave->amplitudes()[1]), 1e4 * 1e-6, 1e-15);
}

TEST(WormError, IsOfRotaryAxesAlone) {
  EXPECT_THROW(
      find_effect("worm-error")->make(effect_spec("worm-error", {{"symbol", std::string("EXX")}}), "m"),
      InputError);
  EXPECT_THROW(find_effect("worm-error")->make(worm(0.0), "m"), InputError);
}

TEST(RingEccentricity, IsOneWaveATurnOfTheAngle) {
  const EffectSpec spec = effect_spec("ring-eccentricity", {{"symbol", std::string("ECC")}});
  const Eigen::MatrixXd drivers = drivers_of(turned_table({0.0, 90.0, 180.0}), spec);
  Eigen::MatrixXd expected(3, 2);
  expected << 1, 0, 0, 1, -1, 0;
  EXPECT_LT((drivers - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_THROW(find_effect("ring-eccentricity")
                   ->make(effect_spec("ring-eccentricity", {{"symbol", std::string("EXC")}}), "m"),
               InputError);
}

/// Contacts with normals given in workpiece coordinates; a head that stands at C.
Campaign contacts(double c_deg, const std::vector<Vector3d>& normals) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w b X Y Z C t");
  campaign.machine.tools = {{"probe", Vector3d::Zero(), 0.0}};
  volcal::Setup setup;
  setup.instrument = "probed-sphere";
  setup.name = "T";
  setup.readings.column_set = 1;
  setup.readings.given.resize(6);
  for (const Vector3d& normal : normals) {
    for (const AxisName axis : kAllAxes)
      setup.readings.position[index_of(axis)].push_back(axis == AxisName::C ? c_deg * kDegree : 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      setup.readings.given[k].push_back(0.0);
      setup.readings.given[3 + k].push_back(normal[static_cast<int>(k)]);
    }
    setup.readings.source_line.push_back(2);
  }
  setup.readings.value = {std::vector<double>(normals.size(), 0.0)};
  campaign.setups = {setup};
  return campaign;
}

/// Three lobes: +x 1, +y (90 degrees) cos 270 = 0, sin 270 = -1, a contact on the tool's axis 0, one at 45
/// degrees of elevation above +x 1 / sqrt 2.
TEST(ProbeLobing, FollowsTheNormalAboutTheToolsAxis) {
  const EffectSpec spec = effect_spec("probe-lobing", {{"lobes", 3.0}});
  const Vector3d raised = Vector3d(1, 0, 1).normalized();
  const std::vector<Vector3d> normals = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ(), raised};
  Eigen::MatrixXd expected(4, 2);
  expected << 1, 0, 0, -1, 0, 0, 1 / std::sqrt(2.0), 0;
  EXPECT_LT((drivers_of(contacts(0.0, normals), spec) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

/// The probe turned by 30 degrees: +x of the workpiece is -30 degrees of the probe, cos 90 = 0, sin -90 = -1.
TEST(ProbeLobing, TurnsWithTheTool) {
  const EffectSpec spec = effect_spec("probe-lobing", {{"lobes", 3.0}});
  const Eigen::MatrixXd drivers = drivers_of(contacts(30.0, {Vector3d::UnitX()}), spec);
  EXPECT_NEAR(drivers(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(drivers(0, 1), -1.0, 1e-12);
}

TEST(ProbeLobing, NeedsContactsAndAWholeNumberOfLobes) {
  const EffectKind& kind = *find_effect("probe-lobing");
  EXPECT_TRUE(kind.candidates(turned_table({0.0})).empty());
  EXPECT_EQ(kind.candidates(contacts(0.0, {Vector3d::UnitX()})).size(), 2u);
  EXPECT_THROW(kind.make(effect_spec("probe-lobing", {{"lobes", 2.5}}), "m"), InputError);
  EXPECT_THROW(kind.make(effect_spec("probe-lobing", {}), "m")->check(turned_table({0.0}), {"m", 1}),
               InputError);
}

}  // namespace
}  // namespace volcal
