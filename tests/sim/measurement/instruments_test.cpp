#include "volcal/sim/measurement/instruments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <vector>

#include "volcal/sim/machine/reference_machines.h"

namespace volcal::sim {
namespace {

/// A machine of 1 m cube with EXX = 10 um and ECX = 20 urad everywhere (w b X Y Z t), tool (0, 0, -100) mm.
class InstrumentTest : public ::testing::Test {
 protected:
  InstrumentTest() : truth_(machine()) {
    truth_.set_error(*ErrorSymbol::parse("EXX"), [](double) { return 10e-6; });
    truth_.set_error(*ErrorSymbol::parse("ECX"), [](double) { return 20e-6; });
  }

  static Machine machine() {
    Machine machine = machine_from_code("w b X Y Z t", {{{0, 1}, {0, 1}, {0, 1}}});
    machine.tools = {{"tool", {0.0, 0.0, -0.1}, 0.0}};
    return machine;
  }

  static CommandedPoint at(double x, double y, double z, std::int32_t line = 0) {
    CommandedPoint point;
    point.position = {x, y, z, 0, 0, 0};
    point.direction = {1, 1, 1, 1, 1, 1};
    point.line = line;
    return point;
  }

  static SetupPlan plan(const std::string& instrument, std::vector<CommandedPoint> points) {
    SetupPlan plan;
    plan.name = "S";
    plan.instrument = instrument;
    plan.points = std::move(points);
    return plan;
  }

  volcal::Setup reading_of(const SetupPlan& plan) const {
    return measure(plan, {truth_, environment_, {{0.0, 0.0, -0.1}}, 7, false}, 100.0);
  }

  TruthMachine truth_;
  Environment environment_;
};

// At x, y, z the functional point is (x + 10 um - 20 urad y, y, z - 100 mm) but for second order (< 0.2 nm).
constexpr double kSecondOrder = 3e-10;

TEST_F(InstrumentTest, LaserTracerReadsDistanceLessDeadPath) {
  SetupPlan tracer = plan("laser-tracer", {at(0.3, 0.4, 0.1)});
  tracer.truth.station = {0.0, 0.0, 0.0};
  tracer.truth.dead_path = 0.123;
  // P = (0.3 + 10 um - 8 um, 0.4, 0): 0.5 m + 0.6 x 2 um
  EXPECT_NEAR(reading_of(tracer).readings.value[0][0], 0.5 + 1.2e-6 - 0.123, kSecondOrder);
  tracer.truth.length_scale = 1e-6;
  EXPECT_NEAR(reading_of(tracer).readings.value[0][0], 0.5 + 1.2e-6 - 0.123 + 0.5e-6, kSecondOrder);
}

TEST_F(InstrumentTest, LaserTrackerReadsSphericalCoordinatesInItsOwnFrame) {
  SetupPlan tracker = plan("laser-tracker", {at(0.3, 0.4, 0.6)});
  tracker.truth.station = {0.0, 0.0, 0.0};
  // P = (0.3 + 2 um, 0.4, 0.5); R^2 = 0.5
  const auto value = reading_of(tracker).readings.value;
  EXPECT_NEAR(value[0][0], std::sqrt(0.5) + 2e-6 * 0.3 / std::sqrt(0.5), kSecondOrder);
  EXPECT_NEAR(value[1][0], std::atan2(0.4, 0.3) - 2e-6 * 0.4 / 0.25, kSecondOrder);
  EXPECT_NEAR(value[2][0], std::atan2(0.5, 0.5) - 2e-6 * 0.6 * 0.5 / 0.5, kSecondOrder);
  tracker.truth.station_rotation = {0.0, 0.0, 0.01};  // station turned by +10 mrad about z sees azimuth less
  EXPECT_NEAR(reading_of(tracker).readings.value[1][0], value[1][0] - 0.01, 1e-14);
}

TEST_F(InstrumentTest, BallBarReadsDistanceToItsTrueCentre) {
  SetupPlan bar = plan("ball-bar", {at(0.65, 0.5, 0.1), at(0.5, 0.65, 0.1)});
  bar.truth.centre = {0.5, 0.5 + 5e-6, 0.0};
  bar.truth.length_error = 3e-6;
  const volcal::Setup setup = reading_of(bar);
  // Along x: 0 um of error (10 - 20 x 0.5); along y: the centre is 5 um nearer.
  EXPECT_NEAR(setup.readings.value[0][0], 0.15 + 0e-6 + 3e-6, kSecondOrder);
  EXPECT_NEAR(setup.readings.value[0][1], 0.15 - 5e-6 + 3e-6, kSecondOrder);
}

TEST_F(InstrumentTest, DisplacementFollowsItsBeam) {
  SetupPlan line = plan("displacement", {at(0, 0.25, 0), at(0.5, 0.25, 0), at(1, 0.25, 0)});
  line.truth.offset = 4e-6;
  volcal::Setup setup = reading_of(line);  // no direction: first to last point, x; error 10 - 5 um
  EXPECT_NEAR(setup.readings.value[0][1], 0.5 + 5e-6 + 4e-6, kSecondOrder);
  line.column_set = 1;
  setup = reading_of(line);
  EXPECT_NEAR(setup.readings.value[0][1], 5e-6 + 4e-6, kSecondOrder);
  line.truth.line_offset = {{0, -1e-6}};
  EXPECT_NEAR(reading_of(line).readings.value[0][1], 5e-6 - 1e-6, kSecondOrder);
  line.options.set("direction", Eigen::Vector3d(2.0, 0.0, 0.0));
  EXPECT_NEAR(reading_of(line).readings.value[0][2], 5e-6 - 1e-6, kSecondOrder);
}

TEST_F(InstrumentTest, DisplacementOfAReturningPassPointsToTheFarthestPoint) {
  SetupPlan line = plan("displacement", {at(0, 0.25, 0), at(1, 0.25, 0, 0), at(0, 0.25, 0, 1)});
  EXPECT_NEAR(reading_of(line).readings.value[0][1], 1.0 + 5e-6, kSecondOrder);
}

/// From far, back on the spot, from below again, and once more after it went back unrecorded.
TEST_F(InstrumentTest, AxesOverrunThePointsWhereTheyTurn) {
  const double position[] = {0.0, 0.2, 0.2, 0.1, 0.05, 0.18, 0.15, 0.25};
  const int direction[] = {1, 1, -1, -1, 1, 1, 1, 1};
  const double far = std::numeric_limits<double>::infinity(), overrun = 1e-3;
  const double travelled[] = {far,     far,          overrun, overrun + 0.1, overrun, overrun + 0.13,
                              overrun, overrun + 0.1};
  std::vector<CommandedPoint> points;
  for (std::size_t i = 0; i < std::size(position); ++i) {
    points.push_back(at(position[i], 0.25, 0.0));
    points.back().direction[0] = static_cast<std::int8_t>(direction[i]);
  }
  std::vector<double> seen(points.size(), -1.0);
  const SetupPlan line = plan("displacement", points);
  truth_.add_state_error(*ErrorSymbol::parse("EXX"), [&](const MachineState& state) {
    const auto row = static_cast<std::size_t>(std::lround((state.time - 100.0) / line.seconds_per_reading));
    seen.at(row) = state.since_reversal[0];
    return 0.0;
  });
  reading_of(line);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isinf(travelled[i])) {
      EXPECT_TRUE(std::isinf(seen[i])) << i;
    } else {
      EXPECT_NEAR(seen[i], travelled[i], 1e-12) << i;
    }
  }
}

TEST_F(InstrumentTest, StraightnessReadsAgainstATurnedArtefact) {
  truth_.set_error(*ErrorSymbol::parse("EYX"), [](double x) { return 6e-6 * x * x; });
  SetupPlan line = plan("straightness", {at(0, 0, 0), at(0.5, 0, 0), at(1, 0, 0)});
  line.options.set("direction", Eigen::Vector3d(0.0, 1.0, 0.0));
  line.truth.offset = 1e-6;
  line.truth.artefact_rotation = {0.0, 0.0, 8e-6};  // the reference rises by 8 um/m
  const volcal::Setup setup = reading_of(line);
  EXPECT_NEAR(setup.readings.value[0][1], 1.5e-6 - 4e-6 + 1e-6, kSecondOrder);
  EXPECT_NEAR(setup.readings.value[0][2], 6e-6 - 8e-6 + 1e-6, kSecondOrder);
}

TEST_F(InstrumentTest, ASquareShowsSquarenessWhateverItsRotation) {
  TruthMachine truth(machine());
  truth.set_location(*LocationSymbol::parse("EC0Y"), 12e-6);  // u_Y = e_Y - 12 urad e_X
  SetupPlan along_x = plan("straightness", {at(0, 0, 0), at(1, 0, 0)});
  along_x.options.set("direction", Eigen::Vector3d(0.0, 1.0, 0.0));
  SetupPlan along_y = plan("straightness", {at(0, 0, 0), at(0, 1, 0)});
  along_y.options.set("direction", Eigen::Vector3d(1.0, 0.0, 0.0));
  along_x.truth.artefact_rotation = along_y.truth.artefact_rotation = {0.0, 0.0, 35e-6};
  const auto rise = [&](const SetupPlan& line) {
    const auto value =
        measure(line, {truth, environment_, {{0.0, 0.0, -0.1}}, 7, false}, 0.0).readings.value[0];
    return value[1] - value[0];
  };
  EXPECT_NEAR(rise(along_x), -35e-6, kSecondOrder);
  EXPECT_NEAR(rise(along_y), -12e-6 + 35e-6, kSecondOrder);
  EXPECT_NEAR(rise(along_x) + rise(along_y), -12e-6, kSecondOrder);
}

TEST_F(InstrumentTest, AngleOfToolTableAndBoth) {
  truth_ = TruthMachine(machine_from_code("w X' b Y Z t", {{{0, 1}, {0, 1}, {0, 1}}}));
  truth_.set_error(*ErrorSymbol::parse("EBX"), [](double x) { return 10e-6 * x; });
  truth_.set_error(*ErrorSymbol::parse("EBY"), [](double y) { return 20e-6 * y; });
  SetupPlan level = plan("angle", {at(0.5, 0.25, 0)});
  level.options.set("axis", Eigen::Vector3d(0.0, 1.0, 0.0));
  level.truth.offset = 1e-6;
  EXPECT_NEAR(reading_of(level).readings.value[0][0], 5e-6 + 5e-6 + 1e-6, 1e-10);
  level.options.set("body", std::string("tool"));
  EXPECT_NEAR(reading_of(level).readings.value[0][0], 5e-6 + 1e-6, 1e-10);
  level.options.set("body", std::string("table"));
  EXPECT_NEAR(reading_of(level).readings.value[0][0], -5e-6 + 1e-6, 1e-10);
}

TEST_F(InstrumentTest, VolumetricPointsCarryTheirAlignment) {
  SetupPlan points = plan("volumetric-points", {at(0.3, 0.4, 0.1)});
  points.truth.alignment = {{1e-6, 2e-6, 3e-6}, {0.0, 0.0, 10e-6}};
  const auto value = reading_of(points).readings.value;
  // error (2, 0, 0) um + shift + 10 urad about z at (0.3, 0.4): (-4, 3, 0) um
  EXPECT_NEAR(value[0][0], 2e-6 + 1e-6 - 4e-6, kSecondOrder);
  EXPECT_NEAR(value[1][0], 0.0 + 2e-6 + 3e-6, kSecondOrder);
  EXPECT_NEAR(value[2][0], 3e-6, kSecondOrder);
}

TEST_F(InstrumentTest, NoiseHasTheStatedSize) {
  SetupPlan tracer = plan("laser-tracer", std::vector<CommandedPoint>(20000, at(0.3, 0.4, 0.1)));
  tracer.truth.station = {0.3, 0.4, -2.0};
  tracer.noise = {0.3e-6, 0.2e-6, 0.0, 0.6e-6};
  const std::vector<double> value = reading_of(tracer).readings.value[0];
  double mean = 0.0;
  for (const double v : value) mean += v / static_cast<double>(value.size());
  double variance = 0.0;
  for (const double v : value) variance += (v - mean) * (v - mean) / static_cast<double>(value.size());
  // 0.3^2 + (0.2 x 2)^2 + 0.6^2 = 0.61; the estimate's standard deviation is 0.5 %
  EXPECT_NEAR(std::sqrt(variance), std::sqrt(0.61) * 1e-6, 0.015e-6);
}

TEST_F(InstrumentTest, RecordsClockTemperaturesLinesAndDirections) {
  environment_.channels = {{.name = "air", .start = 19.0, .drift = 0.5}};
  SetupPlan points = plan("volumetric-points", {at(0, 0, 0, 3), at(1, 0, 0, 4)});
  points.seconds_per_reading = 2.0;
  const volcal::Setup setup = reading_of(points);
  EXPECT_EQ(setup.readings.time, (std::vector<double>{100.0, 102.0}));
  EXPECT_EQ(setup.readings.temperature.at("air"), (std::vector<double>{69.0, 70.0}));
  EXPECT_EQ(setup.readings.line, (std::vector<std::int32_t>{3, 4}));
  EXPECT_EQ(setup.readings.direction[0], (std::vector<std::int8_t>{1, 1}));
  EXPECT_EQ(setup.readings.position[0], (std::vector<double>{0.0, 1.0}));
  EXPECT_TRUE(setup.readings.position[3].empty());
}

TEST_F(InstrumentTest, RefusesWhatItCannotMeasure) {
  EXPECT_THROW(reading_of(plan("sundial", {at(0, 0, 0)})), std::invalid_argument);
  EXPECT_THROW(reading_of(plan("laser-tracer", {})), std::invalid_argument);
}

TEST(TemperatureChannel, DriftsWavesAndSteps) {
  const TemperatureChannel channel{.name = "X",
                                   .start = 20.0,
                                   .drift = 1e-3,
                                   .amplitude = 2.0,
                                   .period = 400.0,
                                   .phase = 0.0,
                                   .step = 5.0,
                                   .step_time = 150.0};
  EXPECT_NEAR(channel.at(100.0), 20.0 + 0.1 + 2.0, 1e-12);
  EXPECT_NEAR(channel.at(300.0), 20.0 + 0.3 - 2.0 + 5.0, 1e-12);
}

}  // namespace
}  // namespace volcal::sim
