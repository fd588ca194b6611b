#include "volcal/studies/files/study_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

const std::string kStudyHead = "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\n";
const std::string kOneMeasurement = "[[measurements]]\nkind = \"diagonals\"\n";

sim::Study parsed_study(const std::string& body) {
  return parse_study(kStudyHead + body, "study.toml", sim::reference_machines()[0]);
}

TEST(SimulationFile, ReadsEverySection) {
  const sim::Study study = parsed_study(R"(
seed = 42
pause_s = 30.0
[truth]
kind = "perfect"
volumetric_rms_um = [10, 12]
wave_scale = 0.5
reversal_max_um = 2.0
[truth.locations_urad]
EC0Y = 12.0
[truth.reversals_um]
EXX = 3
[truth.reversals_urad]
EAX = 4.0
[truth.expansions.X]
expansion_um_per_m_K = 10.0
temperature = "scale"
[[temperatures]]
channel = "scale"
start_degC = 21.0
drift_K_per_hour = 0.36
step_K = 1.0
step_time_s = 100.0
[validation]
points = 50
tools = ["side_x"]
[[measurements]]
kind = "axis-lines"
name = "iso230_2"
axes = ["X", "Z"]
tool = "side_y"
at = [0.5, 0.25, 0.75]
runs = 3
offset_per = "line"
noise = { constant_um = 0.1, per_metre_um = 0.2, repeatability_um = 0.3 }
)");
  EXPECT_EQ(study.seed, 42U);
  EXPECT_EQ(study.pause_between_setups, 30.0);
  EXPECT_TRUE(study.truth.perfect);
  EXPECT_DOUBLE_EQ(study.truth.random.volumetric_rms_min, 10e-6);
  EXPECT_DOUBLE_EQ(study.truth.random.volumetric_rms_max, 12e-6);
  EXPECT_EQ(study.truth.random.wave_scale, 0.5);
  EXPECT_DOUBLE_EQ(study.truth.random.reversal_max, 2e-6);
  EXPECT_DOUBLE_EQ(study.truth.locations.at(*LocationSymbol::parse("EC0Y")), 12e-6);
  EXPECT_DOUBLE_EQ(study.truth.reversals.at(*ErrorSymbol::parse("EXX")), 3e-6);
  EXPECT_DOUBLE_EQ(study.truth.reversals.at(*ErrorSymbol::parse("EAX")), 4e-6);
  EXPECT_DOUBLE_EQ(study.truth.expansions.at(AxisName::X).per_kelvin, 10e-6);
  ASSERT_EQ(study.environment.channels.size(), 1U);
  EXPECT_DOUBLE_EQ(study.environment.channels[0].drift, 1e-4);
  EXPECT_EQ(study.environment.channels[0].step_time, 100.0);
  EXPECT_EQ(study.validation.points, 50);
  EXPECT_EQ(study.validation.tools, std::vector<std::string>{"side_x"});
  ASSERT_EQ(study.measurements.size(), 1U);
  EXPECT_EQ(study.measurements[0].name, "iso230_2");
  const auto& lines = std::get<sim::AxisLines>(study.measurements[0].settings);
  EXPECT_EQ(lines.axes, (std::vector<AxisName>{AxisName::X, AxisName::Z}));
  EXPECT_EQ(lines.tool, "side_y");
  EXPECT_EQ(lines.at, Eigen::Vector3d(0.5, 0.25, 0.75));
  EXPECT_EQ(lines.runs, 3);
  EXPECT_TRUE(lines.offset_per_line);
  EXPECT_DOUBLE_EQ(lines.noise.repeatability, 0.3e-6);
  EXPECT_DOUBLE_EQ(lines.noise.per_metre, 0.2e-6);
}

TEST(SimulationFile, ReadsStationsAndRuns) {
  const sim::Study study = parsed_study(R"(
[[measurements]]
kind = "laser-tracker"
grid = [4, 3, 2]
station_sigma_mm = 2.0
scale_sigma_um_per_m = 0.5
noise = { constant_um = 1.0, angle_urad = 5.0 }
[[measurements.stations]]
name = "A"
position_mm = [-300, -200.0, 50]
[[measurements.runs]]
station = "A"
tool = "short"
)");
  const auto& tracker = std::get<sim::Tracking>(study.measurements[0].settings);
  EXPECT_EQ(tracker.instrument, "laser-tracker");
  EXPECT_EQ(tracker.grid, Eigen::Vector3i(4, 3, 2));
  EXPECT_DOUBLE_EQ(*tracker.station_sigma, 2e-3);
  EXPECT_DOUBLE_EQ(*tracker.length_scale_sigma, 0.5e-6);
  EXPECT_DOUBLE_EQ(tracker.noise.angle, 5e-6);
  ASSERT_EQ(tracker.stations.size(), 1U);
  EXPECT_LT((tracker.stations[0].position_w - Eigen::Vector3d(-0.3, -0.2, 0.05)).norm(), 1e-15);
  ASSERT_EQ(tracker.runs.size(), 1U);
  EXPECT_EQ(sim::simulate(study).campaign.reading_count(), 2U * 24U * 3U);
}

sim::Study parsed_rotary_study(const std::string& body) {
  return parse_study(kStudyHead + body, "study.toml",
                     sim::machine_from_code("w C' A' b X Y Z t", {{{-0.4, 0.4}, {-0.4, 0.4}, {-0.4, 0.4}}}));
}

TEST(SimulationFile, StatesRotaryErrors) {
  const sim::Study study = parsed_rotary_study(R"(
[truth]
kind = "perfect"
[truth.locations_um]
EX0C = 10.0
EY0A = -4
[truth.locations_urad]
EB0A = 30.0
EC0C = 5.0
[truth.reversals_urad]
ECC = 8.0
[truth.functions]
EXC = { basis = "fourier", degree = 1, coefficients_um = [1.0, 3.0, -2.0] }
EAA = { basis = "legendre", degree = 1, coefficients_urad = [0.0, 6.0] }
[[measurements]]
kind = "point-grid"
rotary = "grid"
rotary_axes = { positions = { A = 3, C = 4 } }
)");
  const sim::TruthMachine truth = sim::true_machine(study);
  EXPECT_DOUBLE_EQ(truth.location(*LocationSymbol::parse("EX0C")), 10e-6);
  EXPECT_DOUBLE_EQ(truth.location(*LocationSymbol::parse("EY0A")), -4e-6);
  EXPECT_DOUBLE_EQ(truth.location(*LocationSymbol::parse("EB0A")), 30e-6);
  EXPECT_DOUBLE_EQ(truth.location(*LocationSymbol::parse("EC0C")), 5e-6);
  EXPECT_DOUBLE_EQ(truth.reversal(*ErrorSymbol::parse("ECC")), 8e-6);
  const double half_pi = std::acos(0.0);
  EXPECT_NEAR(truth.function_value(*ErrorSymbol::parse("EXC"), 0.0), 4e-6, 1e-18);
  EXPECT_NEAR(truth.function_value(*ErrorSymbol::parse("EXC"), half_pi), -1e-6, 1e-18);
  EXPECT_NEAR(truth.function_value(*ErrorSymbol::parse("EAA"), half_pi), 3e-6, 1e-18) << "travel +-180 deg";
  const auto& grid = std::get<sim::PointGrid>(study.measurements[0].settings);
  EXPECT_EQ(grid.rotary, sim::RotaryMotion::Grid);
  EXPECT_EQ(grid.rotary_grid.points.at(AxisName::C), 4);
}

TEST(SimulationFile, ReadsMeasurementsOfRotaryAxes) {
  const std::string spheres =
      "[[measurements.spheres]]\nname = \"S1\"\nposition_mm = [100, 0.0, 20]\n"
      "[[measurements.spheres]]\nname = \"S2\"\nposition_mm = [0, 100, 20]\n";
  const sim::Study study = parsed_rotary_study(R"(
[[measurements]]
kind = "r-test"
tools = ["short", "side_x"]
positions = { A = 5, C = 9 }
range_deg = { A = [-90, 30.0] }
frame = "machine"
poses = "singly"
bidirectional = true
noise = { constant_um = 0.7 }
)" + spheres + R"(
[[measurements]]
kind = "probed-sphere"
record = "contacts"
contacts = ["U"]
radius_mm = 17.5
radius_sigma_um = 2.0
)" + spheres + R"(
[[measurements]]
kind = "ball-bar-poses"
length_mm = 80.0
directions = ["x"]
length_sigma_um = 0.0
)" + spheres);
  const auto& r_test = std::get<sim::RTest>(study.measurements[0].settings);
  ASSERT_EQ(r_test.poses.spheres.size(), 2U);
  EXPECT_EQ(r_test.poses.spheres[1].position_w, Eigen::Vector3d(0.0, 0.1, 0.02));
  EXPECT_EQ(r_test.poses.tools, (std::vector<std::string>{"short", "side_x"}));
  EXPECT_EQ(r_test.poses.grid.points.at(AxisName::A), 5);
  EXPECT_NEAR(r_test.poses.grid.range.at(AxisName::A)[1], std::acos(-1.0) / 6.0, 1e-15);
  EXPECT_FALSE(r_test.poses.grid.combined);
  EXPECT_TRUE(r_test.poses.grid.bidirectional);
  EXPECT_EQ(r_test.frame, "machine");
  EXPECT_DOUBLE_EQ(r_test.noise.constant, 0.7e-6);
  const auto& probing = std::get<sim::ProbedSphere>(study.measurements[1].settings);
  EXPECT_TRUE(probing.contacts);
  EXPECT_EQ(probing.kinds, std::vector<std::string>{"U"});
  EXPECT_DOUBLE_EQ(probing.radius, 17.5e-3);
  EXPECT_DOUBLE_EQ(*probing.radius_sigma, 2e-6);
  const auto& bar = std::get<sim::BallBarPoses>(study.measurements[2].settings);
  EXPECT_DOUBLE_EQ(bar.length, 0.08);
  EXPECT_DOUBLE_EQ(*bar.bar.length_sigma, 0.0);
  EXPECT_EQ(bar.frame, "machine");
}

struct BadRotaryStudy {
  std::string body;
  std::string expected;
};

TEST(SimulationFile, RefusesWhatMakesNoSenseOfRotaryAxes) {
  const std::string r_test = "[[measurements]]\nkind = \"r-test\"\n";
  const std::string probing = "[[measurements]]\nkind = \"probed-sphere\"\n";
  const std::string sphere = "[[measurements.spheres]]\nname = \"S1\"\nposition_mm = [0, 0, 0]\n";
  const std::vector<BadRotaryStudy> studies = {
      {r_test, "spheres"},
      {r_test + "positions = { X = 3 }\n" + sphere, "name rotary axes"},
      {r_test + "positions = { A = 0 }\n" + sphere, "positions.A"},
      {r_test + "range_deg = { A = [30, -30] }\n" + sphere, "is not a range"},
      {r_test + "frame = \"bed\"\n" + sphere, "frame"},
      {r_test + "radius_mm = 3.0\n" + sphere, "unknown key"},
      {probing + "radius_mm = 18.0\n" + sphere, "records centres"},
      {"[[measurements]]\nkind = \"point-grid\"\nrotary = \"always\"\n", "rotary"},
      {"[truth.functions]\nEXC = { basis = \"fourier\", degree = 1 }\n" + r_test + sphere, "states no value"},
      {"[truth.functions]\nEXB = { basis = \"fourier\", degree = 1, coefficients_um = [1, 2, 3] }\n" +
           r_test + sphere,
       "is not an error motion of this machine"},
      {"[truth.locations_um]\nEX0B = 1.0\n" + r_test + sphere, "is not an error of this machine"},
      {"[truth.locations_urad]\nEX0C = 1.0\n" + r_test + sphere, "displacements into the one in um"}};
  for (const BadRotaryStudy& study : studies) {
    try {
      parsed_rotary_study(study.body);
      ADD_FAILURE() << "accepted: " << study.body;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(study.expected), std::string::npos)
          << error.what() << " does not say " << study.expected;
    }
  }
}

TEST(SimulationFile, DefaultsAreThoseOfTheSettings) {
  const sim::Study study = parsed_study(kOneMeasurement);
  const sim::Diagonals defaults;
  const auto& read = std::get<sim::Diagonals>(study.measurements[0].settings);
  EXPECT_EQ(read.points, defaults.points);
  EXPECT_EQ(read.noise.constant, defaults.noise.constant);
  EXPECT_EQ(study.seed, 1U);
  EXPECT_EQ(study.validation.points, 400);
}

const std::string kBallBarMeasurement = "[[measurements]]\nkind = \"ball-bar-circles\"\n";
const std::string kRunWithoutPoints =
    "[[measurements.runs]]\nname = \"P1\"\ncentre_mm = [0, 0, 0]\ntool = \"short\"\n";

struct BadStudy {
  std::string body;
  int line;              ///< that the message names
  std::string expected;  ///< in the message
};

void PrintTo(const BadStudy& study, std::ostream* out) { *out << study.expected; }

class BadSimulationFiles : public ::testing::TestWithParam<BadStudy> {};

TEST_P(BadSimulationFiles, NamesLineAndProblem) {
  try {
    sim::simulate(parsed_study(GetParam().body));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, "study.toml");
    EXPECT_EQ(error.place().line, GetParam().line) << error.what();
    EXPECT_NE(std::string(error.what()).find(GetParam().expected), std::string::npos) << error.what();
    EXPECT_FALSE(error.remedy().empty());
  }
}

INSTANTIATE_TEST_SUITE_P(
    SimulationFile, BadSimulationFiles,
    ::testing::Values(
        BadStudy{"seed = -1\n" + kOneMeasurement, 3, "seed"},
        BadStudy{"sed = 1\n" + kOneMeasurement, 3, "sed"}, BadStudy{"seed = 1\n", 0, "measurements"},
        BadStudy{"[[measurements]]\nkind = \"diagonal\"\n", 4, "diagonal"},
        BadStudy{"[[measurements]]\nname = \"d\"\n", 3, "kind"},
        BadStudy{kOneMeasurement + "points = 1\n", 5, "points"},
        BadStudy{kOneMeasurement + "radius_mm = 1\n", 5, "radius_mm"},
        BadStudy{kOneMeasurement + "tool = \"long\"\n", 3, "long"},
        BadStudy{kOneMeasurement + "at = [0.5, 50, 0.5]\n", 5, "at"},
        BadStudy{kOneMeasurement + kOneMeasurement, 5, "body_ppp"},
        BadStudy{"[[measurements]]\nkind = \"ball-bar-circles\"\nradius_mm = 400\n", 3, "leaves the travel"},
        BadStudy{kBallBarMeasurement + "planes = [\"XY\"]\n" + kRunWithoutPoints, 5, "planes of circles"},
        BadStudy{kBallBarMeasurement + kRunWithoutPoints, 5, "has no positions"},
        BadStudy{
            "[[measurements]]\nkind = \"laser-tracer\"\nstations = [{ name = \"\", position_mm = [0, 0, 0] "
            "}]\n",
            5, "stations[1].name is empty"},
        BadStudy{"[[temperatures]]\nchannel = \" \"\n" + kOneMeasurement, 4, "channel is empty"},
        BadStudy{"[[measurements]]\nkind = \"squares\"\nplanes = [\"XX\"]\n", 3, "XX"},
        BadStudy{"[[measurements]]\nkind = \"laser-tracer\"\ngrid = [9, 7]\n", 5, "grid"},
        BadStudy{"[[measurements]]\nkind = \"axis-lines\"\naxes = [\"C\"]\n", 5, "axes"},
        BadStudy{"[truth.locations_urad]\nEA0Y = 1.0\n" + kOneMeasurement, 4, "EC0Y, EA0Z, EB0Z"},
        BadStudy{"[truth.locations_urad]\nEC0C = 1.0\n" + kOneMeasurement, 4, "EC0C"},
        BadStudy{"[truth.reversals_um]\nEAX = 1.0\n" + kOneMeasurement, 4, "EAX"},
        BadStudy{"[truth]\nvolumetric_rms_um = [20, 10]\n" + kOneMeasurement, 4, "range"},
        BadStudy{"[validation]\ntools = [\"none\"]\n" + kOneMeasurement, 4, "none"}));

}  // namespace
}  // namespace volcal
