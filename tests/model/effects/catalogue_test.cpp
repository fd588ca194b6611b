// Effects of the catalogue against hand calculations.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/lagged_channel.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/travel_since_turning.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using testing_support::effect_campaign;
using testing_support::kEffectRows;

class Catalogue : public ::testing::Test {
 protected:
  Catalogue() { model_.default_function.basis = "zero"; }

  std::size_t index(const std::string& setup) const {
    for (std::size_t i = 0; i < campaign_.setups.size(); ++i) {
      if (campaign_.setups[i].name == setup) return i;
    }
    throw std::out_of_range(setup);
  }
  const Readings& readings(const std::string& setup) const { return campaign_.setups[index(setup)].readings; }

  Eigen::MatrixXd drivers(const EffectSpec& spec, const std::string& setup) const {
    const MeasurementModel model(campaign_, model_);
    const auto effect = find_effect(spec.kind)->make(spec, "model.toml");
    return effect->drivers(setup_views(campaign_, model.binding(), model.chain())[index(setup)],
                           effect->shape_values());
  }

  /// Change of a reading when the effect's first amplitude goes from 0 to this.
  double change(const EffectSpec& spec, double amplitude, const std::string& setup, std::size_t row,
                int channel = 0) const {
    ModelSpec with_effect = model_;
    with_effect.effects = {spec};
    const MeasurementModel model(campaign_, with_effect);
    Eigen::VectorXd parameters = model.initial_parameters();
    double low[kMaxChannels], high[kMaxChannels];
    model.predict(index(setup), row, parameters, low);
    parameters[model.binding().effects[0].first_parameter] = amplitude;
    model.predict(index(setup), row, parameters, high);
    return high[channel] - low[channel];
  }

  Campaign campaign_ = effect_campaign();
  ModelSpec model_;
};

/// A ramp r t is followed by r (t - tau (1 - exp(-t / tau))): exact, since it is linear between readings.
TEST_F(Catalogue, ALaggedTemperatureFollowsARamp) {
  constexpr double kRate = 0.5 / 3600.0, kLag = 1500.0;
  for (volcal::Setup& setup : campaign_.setups) {
    auto& column = setup.readings.temperature["ramp"];
    for (const double time : setup.readings.time) column.push_back(20.0 + kRate * time);
  }
  const EffectSpec spec = effect_spec(
      "lagged-temperature",
      {{"symbol", std::string("EAZ")}, {"temperature", std::string("ramp")}, {"time_constant", kLag}});
  for (const char* setup : {"S1", "S2", "S3"}) {
    const Eigen::MatrixXd driver = drivers(spec, setup);
    for (std::size_t row = 0; row < kEffectRows; ++row) {
      const double t = readings(setup).time[row];
      EXPECT_NEAR(driver(static_cast<Eigen::Index>(row), 0), kRate * (t - kLag * (1.0 - std::exp(-t / kLag))),
                  1e-12);
    }
  }
}

/// After a step by 1 K between two readings far apart in time nothing is left to follow; before, nothing.
TEST_F(Catalogue, ALaggedTemperatureSettles) {
  for (volcal::Setup& setup : campaign_.setups) {
    setup.readings.temperature["step"].assign(kEffectRows, setup.name == "S3" ? 21.0 : 20.0);
  }
  const EffectSpec spec =
      effect_spec("lagged-expansion", {{"temperature", std::string("step")}, {"time_constant", 60.0}});
  EXPECT_EQ(drivers(spec, "S2").norm(), 0.0);
  const Eigen::MatrixXd after = drivers(spec, "S3");
  EXPECT_EQ(after.cols(), 3);
  EXPECT_NEAR(after(static_cast<Eigen::Index>(kEffectRows) - 1, 2), 1.0, 1e-3);
}

/// What is kept for the next effect that asks is what is found without, also once it begins anew.
TEST_F(Catalogue, LaggedTemperaturesAreKeptAsTheyAreFound) {
  const MeasurementModel model(campaign_, model_);
  for (const char* setup : {"S1", "S3"}) {
    const SetupView view = setup_views(campaign_, model.binding(), model.chain())[index(setup)];
    ASSERT_NE(view.histories, nullptr);
    SetupView alone = view;
    alone.histories = nullptr;
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 0; i < KeptHistories::kMost + 4; ++i) {
        const double lag = 300.0 + 10.0 * static_cast<double>(i);
        EXPECT_EQ(lagged_excess(view, "spindle", lag), lagged_excess(alone, "spindle", lag));
      }
    }
    EXPECT_NE(view.histories->find("spindle", 300.0 + 10.0 * (KeptHistories::kMost + 3)), nullptr);
    EXPECT_EQ(view.histories->find("spindle", 299.0), nullptr);
    EXPECT_EQ(view.histories->find("column", 300.0), nullptr);
    EXPECT_GT(lagged_excess(alone, "spindle", 300.0).norm(), 0.0);
  }
}

/// A tilt about y by a x: a tracer sees P move by a x (z, 0, -x) from the middle of the travel, a level on
/// the tool or the table reads a x, a ball-bar and a relative angle nothing.
TEST_F(Catalogue, AFoundationTiltIsSeenFromTheFloor) {
  constexpr double kTilt = 20e-6;
  const EffectSpec spec =
      effect_spec("foundation-tilt", {{"axis", std::string("X")}, {"about", std::string("y")}});
  const Eigen::Vector3d station(-0.4, -0.3, -0.2), pivot(0.5, 0.5, 0.5), tool(0.0, 0.0, -0.1);
  const Eigen::Vector3d position(readings("S1").position[0][3], readings("S1").position[1][3],
                                 readings("S1").position[2][3]);
  const Eigen::Vector3d point = position + tool;
  const Eigen::Vector3d moved =
      point + kTilt * position.x() * Eigen::Vector3d(point.z() - pivot.z(), 0.0, pivot.x() - point.x());
  EXPECT_NEAR(change(spec, kTilt, "S1", 3), (moved - station).norm() - (point - station).norm(), 1e-10);
  EXPECT_EQ(change(spec, kTilt, "B1", 3), 0.0);
  EXPECT_EQ(change(spec, kTilt, "D1", 3), 0.0);
  volcal::Setup& level = campaign_.setups[index("A1")];
  level.options.set("axis", Eigen::Vector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(change(spec, kTilt, "A1", 3), 0.0);
  for (const char* body : {"tool", "table"}) {
    level.options.set("body", std::string(body));
    EXPECT_NEAR(change(spec, kTilt, "A1", 3), kTilt * level.readings.position[0][3], 1e-15) << body;
  }
}

/// Its square, about the two other directions, is a candidate only beside instruments that do not see it.
TEST_F(Catalogue, AFoundationTiltAloneIsAnErrorMotion) {
  const EffectKind* kind = find_effect("foundation-tilt");
  EXPECT_EQ(kind->candidates(campaign_).size(), 18U);
  std::erase_if(campaign_.setups,
                [](const volcal::Setup& setup) { return setup.instrument != "laser-tracer"; });
  EXPECT_TRUE(kind->candidates(campaign_).empty());
}

/// Its own circle sees sin 2 phi with the sign of the sense; at the poles of a circle in another plane, where
/// both coordinates are as small as the centre is wrong, nothing is seen.
TEST_F(Catalogue, AServoMismatchActsOnCirclesOfItsPlane) {
  constexpr double kRadius = 0.15, kLag = 2e-6, kWrong = 2e-6;
  volcal::Setup& bar = campaign_.setups[index("B1")];
  const Eigen::Vector3d tool = campaign_.machine.tools[bar.tool].offset, centre(0.25, 0.25, 0.1);
  bar.options.set("centre", Eigen::Vector3d(centre + Eigen::Vector3d(kWrong, -kWrong, 0.0)));
  const auto place = [&](std::size_t row, const Eigen::Vector3d& from_centre) {
    for (Eigen::Index k = 0; k < 3; ++k)
      bar.readings.position[static_cast<std::size_t>(k)][row] = (centre + from_centre - tool)[k];
  };
  const double diagonal = kRadius / std::sqrt(2.0);
  place(0, {diagonal, diagonal, 0.0});  // first quadrant, counter-clockwise: x falls, y rises
  bar.readings.direction[0][0] = -1;
  bar.readings.direction[1][0] = 1;
  place(1, {diagonal, diagonal, 0.0});
  bar.readings.direction[0][1] = 1;
  bar.readings.direction[1][1] = -1;
  place(2, {0.0, 0.0, kRadius});
  const EffectSpec spec =
      effect_spec("servo-mismatch", {{"axis", std::string("X")}, {"second_axis", std::string("Y")}});
  EXPECT_NEAR(change(spec, kLag, "B1", 0), kLag, 1e-10);
  EXPECT_NEAR(change(spec, kLag, "B1", 1), -kLag, 1e-10);
  EXPECT_NEAR(change(spec, kLag, "B1", 2), 0.0, 1e-10);
}

/// X lags by T seconds: it is v T short of where it should be, v = 2 m/min less nothing where it crosses the
/// Y axis; at 45 degrees the radius changes by v T / 2, as the mismatch of the plane says.
TEST_F(Catalogue, AnAxisThatFollowsLateIsBehindByItsVelocity) {
  constexpr double kRadius = 0.15, kFeed = 2.0 / 60.0, kLate = 1e-4;
  volcal::Setup& bar = campaign_.setups[index("B1")];
  const Eigen::Vector3d tool = campaign_.machine.tools[bar.tool].offset, centre(0.25, 0.25, 0.1);
  bar.options.set("centre", centre);
  bar.readings.feed.assign(kEffectRows, kFeed);
  const auto place = [&](std::size_t row, double angle) {
    const Eigen::Vector3d point = centre + kRadius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    for (Eigen::Index k = 0; k < 3; ++k)
      bar.readings.position[static_cast<std::size_t>(k)][row] = (point - tool)[k];
    bar.readings.direction[0][row] = std::sin(angle) > 0 ? -1 : 1;  // counter-clockwise
    bar.readings.direction[1][row] = std::cos(angle) > 0 ? 1 : -1;
  };
  constexpr double kQuarter = 0.25 * std::numbers::pi;
  place(0, 2.0 * kQuarter);
  place(1, kQuarter);
  place(2, 3.0 * kQuarter);
  const EffectSpec lag =
      effect_spec("following-error", {{"axis", std::string("X")}, {"by", std::string("feed")}});
  EXPECT_NEAR(drivers(lag, "B1")(0, 0), kFeed, 1e-12) << "moves towards -, late is towards +";
  EXPECT_NEAR(change(lag, kLate, "B1", 0), 0.0, 1e-10) << "along the circle";
  EXPECT_NEAR(change(lag, kLate, "B1", 1), 0.5 * kFeed * kLate, 1e-10);
  EXPECT_NEAR(change(lag, kLate, "B1", 2), -0.5 * kFeed * kLate, 1e-10);
  const EffectSpec mismatch = effect_spec(
      "servo-mismatch",
      {{"axis", std::string("X")}, {"second_axis", std::string("Y")}, {"by", std::string("feed")}});
  for (std::size_t row = 0; row < 3; ++row)
    EXPECT_NEAR(change(mismatch, kLate, "B1", row), change(lag, kLate, "B1", row), 1e-10);
  EXPECT_EQ(drivers(lag, "S1").norm(), 0.0) << "readings at rest";
}

TEST_F(Catalogue, AnAxisIsLateWhereCirclesMoveItInTwoPlanes) {
  const EffectKind* kind = find_effect("following-error");
  const auto drivers_of = [&] {
    std::vector<std::string> names;
    for (const EffectSpec& spec : kind->candidates(campaign_))
      names.push_back(kind->make(spec, "model.toml")->name().driver.name());
    return names;
  };
  EXPECT_THAT(drivers_of(), ::testing::ElementsAre("dir_x feed", "dir_y feed", "dir_z feed"));
  auto& bar = campaign_.setups[index("B1")].readings;
  bar.feed.clear();
  EXPECT_THAT(drivers_of(), ::testing::ElementsAre("dir_x", "dir_y", "dir_z"));
  for (double& position : bar.position[index_of(AxisName::Z)]) position *= 1e-3;
  EXPECT_THAT(drivers_of(), ::testing::IsEmpty()) << "one plane: the mismatch says it";
}

TEST_F(Catalogue, ALateAxisIsALinearOneAndItsErrorGrowsWithTheFeedOrNot) {
  const EffectKind* kind = find_effect("following-error");
  const auto make = [&](const std::string& axis, const std::string& by) {
    return kind->make(effect_spec("following-error", {{"axis", axis}, {"by", by}}), "model.toml");
  };
  EXPECT_EQ(make("X", "feed")->amplitudes()[0].unit(), "ms");
  EXPECT_THROW(make("C", "feed"), InputError);
  EXPECT_THROW(make("X", "time"), InputError);
}

TEST_F(Catalogue, AMismatchByFeedNeedsFeedsThatDiffer) {
  const EffectKind* kind = find_effect("servo-mismatch");
  auto& feed = campaign_.setups[index("B1")].readings.feed;
  feed.assign(kEffectRows, 0.02);
  feed.front() *= 1.0 + 1e-9;
  EXPECT_EQ(kind->candidates(campaign_).size(), 3U);
  feed.back() = 0.04;
  EXPECT_EQ(kind->candidates(campaign_).size(), 6U);
  const EffectSpec spec = kind->candidates(campaign_)[1];
  feed.clear();
  const auto effect = kind->make(spec, "model.toml");
  EXPECT_THROW(effect->check(campaign_, {"model.toml", 1}), InputError);
}

/// A circle in XY says nothing about Z, which moves by what the table is tilted.
TEST_F(Catalogue, AServoMismatchIsLookedForInPlanesOfCircles) {
  const EffectKind* kind = find_effect("servo-mismatch");
  campaign_.setups[index("B1")].readings.feed.clear();
  EXPECT_EQ(kind->candidates(campaign_).size(), 3U);
  auto& z = campaign_.setups[index("B1")].readings.position[index_of(AxisName::Z)];
  for (double& position : z) position *= 1e-3;
  ASSERT_EQ(kind->candidates(campaign_).size(), 1U);
  EXPECT_EQ(kind->make(kind->candidates(campaign_)[0], "model.toml")->name().target.name(), "XY");
}

/// A beam of 1 mrad reads half a ppm too short; a path that runs backwards counts with its sign.
TEST_F(Catalogue, ABeamThatIsNotParallelReadsTooShort) {
  const EffectSpec spec = effect_spec("beam-misalignment", {{"setup", std::string("D1")}});
  campaign_.setups[index("D1")].options.set("direction", Eigen::Vector3d(2.0, 0.0, 0.0));
  const auto& x = readings("D1").position[0];
  EXPECT_NEAR(change(spec, 0.5e-6, "D1", 9), -0.5e-6 * (x[9] - x[0]), 1e-15);
  EXPECT_EQ(change(spec, 0.5e-6, "S1", 9), 0.0);
}

TEST_F(Catalogue, AnEccentricEncoderWavesOncePerTurn) {
  volcal::Setup& tracker = campaign_.setups[index("K1")];
  for (std::size_t row = 0; row < kEffectRows; ++row) {
    tracker.readings.value[1][row] = 0.3 * static_cast<double>(row);
    tracker.readings.value[2][row] = 0.02 * static_cast<double>(row);
  }
  const auto spec = [](const char* encoder) {
    return effect_spec("encoder-eccentricity",
                       {{"station", std::string("K1")}, {"encoder", std::string(encoder)}});
  };
  EXPECT_NEAR(drivers(spec("azimuth"), "K1")(7, 0), std::cos(2.1), 1e-12);
  EXPECT_NEAR(drivers(spec("azimuth"), "K1")(7, 1), std::sin(2.1), 1e-12);
  EXPECT_NEAR(drivers(spec("elevation"), "K1")(7, 1), std::sin(0.14), 1e-12);
  EXPECT_NEAR(change(spec("elevation"), 3e-6, "K1", 7, 2), 3e-6 * std::cos(0.14), 1e-15);
  EXPECT_EQ(change(spec("elevation"), 3e-6, "K1", 7, 1), 0.0);
  EXPECT_EQ(drivers(spec("azimuth"), "S1").norm(), 0.0);
}

/// The tools of the two setups at P1 are one; that of S2 is carried in no other, and B1 has a centre of its
/// own.
TEST_F(Catalogue, AToolIsClampedAnewForASetup) {
  const EffectSpec spec = effect_spec("tool-clamping", {{"setup", std::string("S3")}});
  EXPECT_TRUE((drivers(spec, "S3").array() == 1.0).all());
  EXPECT_EQ(drivers(spec, "S1").norm(), 0.0);
  const auto candidates = [&] {
    std::vector<std::string> setups;
    for (const EffectSpec& each : find_effect("tool-clamping")->candidates(campaign_))
      setups.push_back(*each.options.text("setup"));
    return setups;
  };
  EXPECT_THAT(candidates(), ::testing::ElementsAre("S1", "S3"));
  campaign_.setups[index("S2")].tool = campaign_.setups[index("S1")].tool;
  EXPECT_THAT(candidates(), ::testing::ElementsAre("S1", "S3"));  // nobody else reads from P2
  campaign_.setups[index("S2")].options.set("station", std::string("P1"));
  EXPECT_THAT(candidates(), ::testing::ElementsAre("S1", "S2", "S3"));
}

TEST_F(Catalogue, ARunIsShiftedAgainstTheOthers) {
  const EffectSpec spec = effect_spec("run-offset", {{"setup", std::string("S2")}, {"run", 1.0}});
  EXPECT_EQ(change(spec, 2e-6, "S2", 11), 0.0);
  EXPECT_NEAR(change(spec, 2e-6, "S2", 12), 2e-6, 1e-15);
  EXPECT_EQ(change(spec, 2e-6, "S1", 12), 0.0);
  for (const EffectSpec& candidate : find_effect("run-offset")->candidates(campaign_)) {
    EXPECT_EQ(candidate.options.number("run"), 1.0);
    EXPECT_NE(candidate.options.text("setup"), "A1");
  }
}

/// EC0Y of 1 urad turns the travel of Y by -1 um/m along x (u_Y = e_Y - EC0Y e_X).
TEST_F(Catalogue, SquarenessDriftsWithAChannel) {
  const EffectSpec spec = effect_spec(
      "squareness-drift", {{"symbol", std::string("EC0Y")}, {"temperature", std::string("spindle")}});
  const auto effect = find_effect("squareness-drift")->make(spec, "model.toml");
  EXPECT_EQ(effect->amplitudes()[0].target.symbol, (ErrorSymbol{Component::X, AxisName::Y}));
  EXPECT_EQ(effect->amplitudes()[0].unit(), "urad/K");
  EXPECT_NEAR(drivers(spec, "S1")(10, 0), -2.0 * readings("S1").position[1][10], 1e-12);
}

/// P1 is visited from 0 to 460 s and from 7000 to 7460 s, a reading every 20 s.
TEST_F(Catalogue, EventsAreLookedForBetweenReadings) {
  for (const EffectSpec& spec : find_effect("station-event")->candidates(campaign_)) {
    if (spec.options.text("station") != "P1") continue;
    const auto scan = find_effect("station-event")->make(spec, {})->scan(campaign_);
    int first_visit = 0, between = 0, second_visit = 0;
    for (const Eigen::VectorXd& time : scan) {
      if (time[0] < 460.0) ++first_visit;
      if (time[0] > 460.0 && time[0] < 7000.0) ++between;
      if (time[0] > 7000.0) ++second_visit;
      const double since_a_reading = std::fmod(time[0], 20.0);
      EXPECT_TRUE(since_a_reading == 10.0 || time[0] == 3730.0) << time[0];
    }
    EXPECT_EQ(between, 1);
    EXPECT_EQ(first_visit, 11);
    EXPECT_EQ(second_visit, 11);
    return;
  }
  FAIL() << "no event at P1";
}

/// X: 0 100 200 towards +, back at 200 and 100 towards -, then from below again and on.
TEST_F(Catalogue, TravelCountsFromWhereTheAxisTurned) {
  volcal::Setup& setup = campaign_.setups[index("S1")];
  Readings& readings = setup.readings;
  readings.time.clear();
  const double position[] = {0.0, 0.1, 0.2, 0.2, 0.1, 0.05, 0.08, 0.18, 0.15, 0.25};
  const int direction[] = {1, 1, 1, -1, -1, 1, 1, 1, 1, 1};
  const double unknown = std::numeric_limits<double>::infinity();
  const double travelled[] = {unknown, unknown, unknown, 0.0, 0.1, 0.0, 0.03, 0.13, 0.0, 0.1};
  for (std::size_t row = 0; row < 10; ++row) {
    readings.position[0][row] = position[row];
    readings.direction[0][row] = static_cast<std::int8_t>(direction[row]);
  }
  const std::vector<double> found = travel_since_turning(campaign_.machine, setup, AxisName::X);
  for (std::size_t row = 0; row < 10; ++row) {
    if (std::isinf(travelled[row])) {
      EXPECT_TRUE(std::isinf(found[row])) << row;
    } else {
      EXPECT_NEAR(found[row], travelled[row], 1e-15) << row;
    }
  }
  const EffectSpec spec = effect_spec("pre-travel", {{"symbol", std::string("EXX")}, {"length", 0.05}});
  const Eigen::MatrixXd driver = drivers(spec, "S1");
  EXPECT_EQ(driver(1, 0), 0.0) << "nothing is known of how far it has come";
  EXPECT_NEAR(driver(3, 0), -0.5, 1e-15);
  EXPECT_NEAR(driver(4, 0), -0.5 * std::exp(-2.0), 1e-15);
  EXPECT_NEAR(driver(6, 0), 0.5 * std::exp(-0.6), 1e-15);
}

/// Poses of a table have no order: what is left after long travel stands there.
TEST_F(Catalogue, PosesWithoutAnOrderHaveNoPreTravel) {
  const MeasurementModel model(campaign_, model_);
  SetupView view = setup_views(campaign_, model.binding(), model.chain())[0];
  const EffectSpec spec = effect_spec("pre-travel", {{"symbol", std::string("EXX")}});
  const auto effect = find_effect(spec.kind)->make(spec, "model.toml");
  EXPECT_GT(effect->drivers(view, effect->shape_values()).norm(), 0.0);
  view.is_path = false;
  EXPECT_EQ(effect->drivers(view, effect->shape_values()).norm(), 0.0);
}

/// Half towards each side, by the kelvin over 20 degC; by the square of the way from home.
TEST_F(Catalogue, AReversalChangesWithTemperatureAndWithTheSquareOfTheTravel) {
  const EffectSpec warm = effect_spec(
      "thermal-reversal", {{"symbol", std::string("EYY")}, {"temperature", std::string("spindle")}});
  const EffectSpec curved = effect_spec("curved-reversal", {{"symbol", std::string("EYY")}});
  EXPECT_EQ(find_effect("thermal-reversal")->make(warm, "")->amplitudes()[0].unit(), "um/K");
  for (const std::size_t row : {3UL, 8UL}) {
    const double half = 0.5 * readings("S1").direction[1][row], y = readings("S1").position[1][row];
    const auto at = static_cast<Eigen::Index>(row);
    EXPECT_NEAR(drivers(warm, "S1")(at, 0), half * 0.2 * static_cast<double>(row), 1e-12);
    EXPECT_NEAR(drivers(curved, "S1")(at, 0), half * y * y, 1e-15);
  }
}

TEST_F(Catalogue, AProductOfThreePositions) {
  const auto spec = [](const char* axes) {
    return effect_spec("triple-coupling", {{"symbol", std::string("EAY")}, {"axes", std::string(axes)}});
  };
  const double x = readings("S1").position[0][5], y = readings("S1").position[1][5],
               z = readings("S1").position[2][5];
  EXPECT_NEAR(drivers(spec("Z Y Z"), "S1")(5, 0), y * z * z, 1e-15);
  EXPECT_NEAR(drivers(spec("X Y Z"), "S1")(5, 0), x * y * z, 1e-15);
  const EffectKind* kind = find_effect("triple-coupling");
  EXPECT_EQ(kind->make(spec("Z Y Z"), "")->amplitudes()[0].label, "EAY by y z^2");
  for (const char* wrong : {"Z Z Z", "Y Z", "Y Z Q", "Y Z Z Z"})
    EXPECT_THROW(kind->make(spec(wrong), "model.toml"), InputError) << wrong;
  // Nine rotations by seven products, and a displacement in three directions by each of the seven.
  EXPECT_EQ(kind->candidates(campaign_).size(), 9U * 7U + 3U * 7U);
}

TEST_F(Catalogue, AWaveGrowsWithTheWayFromHome) {
  const EffectSpec spec =
      effect_spec("growing-lead-error", {{"symbol", std::string("EXX")}, {"period", 0.02}});
  const double x = readings("S1").position[0][7], phase = 2.0 * std::numbers::pi * x / 0.02;
  const Eigen::MatrixXd driver = drivers(spec, "S1");
  EXPECT_NEAR(driver(7, 0), x * std::cos(phase), 1e-12);
  EXPECT_NEAR(driver(7, 1), x * std::sin(phase), 1e-12);
  EXPECT_EQ(find_effect(spec.kind)->make(spec, "")->amplitudes()[1].unit(), "um/m");
}

/// Circumference of the pinion; ball screws end at some 2.5 m.
TEST_F(Catalogue, ARackRepeatsItsErrorWithThePinionOnLongAxesAlone) {
  const EffectSpec spec = effect_spec("rack-error", {{"symbol", std::string("EXX")}, {"period", 0.125}});
  const double phase = 2.0 * std::numbers::pi * readings("S1").position[0][7] / 0.125;
  const Eigen::MatrixXd driver = drivers(spec, "S1");
  EXPECT_NEAR(driver(7, 0), std::cos(phase), 1e-12);
  EXPECT_NEAR(driver(7, 1), std::sin(phase), 1e-12);
  const EffectKind* kind = find_effect("rack-error");
  EXPECT_TRUE(kind->candidates(campaign_).empty()) << "no axis is longer than two metres";
  campaign_.machine.axes.front().travel_max = campaign_.machine.axes.front().travel_min + 3.35;
  ASSERT_EQ(kind->candidates(campaign_).size(), 1U);
  EXPECT_EQ(*kind->candidates(campaign_).front().options.text("symbol"), "EXX");
  const std::vector<Eigen::VectorXd> periods = kind->make(spec, "")->scan(campaign_);
  EXPECT_NEAR(periods.front()[0], 0.6, 1e-12);
  EXPECT_GT(periods.back()[0], 0.06);
  for (std::size_t i = 1; i < periods.size(); ++i)
    EXPECT_NEAR(1.0 / periods[i][0] - 1.0 / periods[i - 1][0], 0.5 / 3.35, 1e-9)
        << "half a period over the travel";
}

/// Of a ramp r t the core lags by r tau (1 - exp(-t / tau)), in the end by tau times the rate.
TEST_F(Catalogue, WhatFollowsTheRateOfATemperature) {
  constexpr double kRate = 0.5 / 3600.0, kConstant = 900.0;
  for (volcal::Setup& setup : campaign_.setups) {
    auto& column = setup.readings.temperature["ramp"];
    for (const double time : setup.readings.time) column.push_back(20.0 + kRate * time);
  }
  const EffectSpec spec = effect_spec(
      "temperature-rate",
      {{"symbol", std::string("EAZ")}, {"temperature", std::string("ramp")}, {"time_constant", kConstant}});
  for (const char* setup : {"S1", "S3"}) {
    const double t = readings(setup).time[9];
    EXPECT_NEAR(drivers(spec, setup)(9, 0), kRate * kConstant * (1.0 - std::exp(-t / kConstant)), 1e-12);
  }
  EXPECT_EQ(find_effect(spec.kind)->make(spec, "")->scan(campaign_).size(), 1U);
}

/// S1 and S3 stand at P1, S2 at P2, K1 and D1 are lasers too: one amplitude for what has one cause.
TEST_F(Catalogue, ADeadPathIsOfASetupOfAStationOrOfAllLasers) {
  const auto spec = [](const char* key, const char* name) {
    EffectSpec made = effect_spec("dead-path", {{"temperature", std::string("spindle")}});
    if (key != nullptr) made.options.set(key, std::string(name));
    return made;
  };
  const auto acts_on = [&](const EffectSpec& which) {
    std::vector<std::string> names;
    for (const volcal::Setup& setup : campaign_.setups) {
      if (drivers(which, setup.name).norm() > 0.0) names.push_back(setup.name);
    }
    return names;
  };
  EXPECT_THAT(acts_on(spec("setup", "S3")), ::testing::ElementsAre("S3"));
  EXPECT_THAT(acts_on(spec("station", "P1")), ::testing::ElementsAre("S1", "S3"));
  EXPECT_THAT(acts_on(spec(nullptr, "")), ::testing::ElementsAre("S1", "S2", "S3", "K1", "D1"));
  EXPECT_NEAR(drivers(spec("station", "P1"), "S3")(10, 0), 2.0, 1e-12);
  EffectSpec both = spec("setup", "S1");
  both.options.set("station", std::string("P1"));
  EXPECT_THROW(find_effect("dead-path")->make(both, "model.toml"), InputError);

  std::vector<std::string> shared;
  for (const EffectSpec& each : find_effect("dead-path")->candidates(campaign_)) {
    const std::string name = full_name(find_effect("dead-path")->make(each, "model.toml")->name());
    if (name.find(" of ") == name.npos) shared.push_back(name.substr(10, name.rfind(':') - 10));
  }
  EXPECT_THAT(shared, ::testing::ElementsAre("station P1:time", "station P1:T_air", "station P1:T_spindle",
                                             "readings:time", "readings:T_air", "readings:T_spindle"));
}

TEST_F(Catalogue, AllStationsDriftTogether) {
  const EffectSpec all = effect_spec("station-drift", {});
  for (const char* setup : {"S1", "S2", "K1"})
    EXPECT_NEAR(drivers(all, setup)(6, 1), readings(setup).time[6], 1e-9) << setup;
  EXPECT_EQ(drivers(all, "D1").norm(), 0.0);
  EXPECT_EQ(drivers(effect_spec("station-drift", {{"station", std::string("P2")}}), "S1").norm(), 0.0);
}

TEST_F(Catalogue, ATrackerThatIsCarriedHasOneEncoder) {
  const auto carried = [&] {
    std::vector<std::string> names;
    for (const EffectSpec& each : find_effect("encoder-eccentricity")->candidates(campaign_)) {
      if (!each.options.text("station")) names.push_back(*each.options.text("encoder"));
    }
    return names;
  };
  EXPECT_THAT(carried(), ::testing::IsEmpty()) << "one station";
  volcal::Setup second = campaign_.setups[index("K1")];
  second.name = "K2";
  campaign_.setups.push_back(second);
  EXPECT_THAT(carried(), ::testing::ElementsAre("azimuth", "elevation"));
  const EffectSpec spec = effect_spec("encoder-eccentricity", {{"encoder", std::string("azimuth")}});
  EXPECT_GT(drivers(spec, "K1").norm(), 0.0);
  EXPECT_EQ(drivers(spec, "K1"), drivers(spec, "K2"));
}

}  // namespace
}  // namespace volcal
