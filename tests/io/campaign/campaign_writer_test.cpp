#include "volcal/identify/io/campaign_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <variant>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/studies/files/simulation_writer.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal {
namespace {

constexpr double kTenthNanometre = 1e-10;

sim::Study every_instrument() {
  sim::Study study;
  study.machine = sim::reference_machines()[1];
  study.machine.axes[0].expansion = ScaleExpansion{11e-6, 0.5e-6, "X"};
  study.machine.tools[1].offset_sigma = 2e-6;
  study.environment.channels = {{.name = "X", .start = 20.7, .drift = 1e-4}, {.name = "air", .start = 21.0}};
  sim::Tracking tracer;
  tracer.grid = {3, 3, 2};
  tracer.station_sigma = 2e-3;
  tracer.length_scale_sigma = 0.3e-6;
  sim::Tracking tracker;
  tracker.instrument = "laser-tracker";
  tracker.grid = {3, 3, 3};
  sim::BallBarCircles circles;
  circles.length_sigma = 0.5e-6;
  circles.points_per_turn = 24;
  sim::AxisLines lines;
  lines.offset_per_line = true;
  study.measurements = {
      {"", tracer},          {"tracker", tracker},           {"", circles},        {"", sim::Diagonals{}},
      {"", lines},           {"", sim::StraightnessLines{}}, {"", sim::Squares{}}, {"", sim::AngleLines{}},
      {"", sim::PointGrid{}}};
  return study;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

void expect_same(const Options& written, const Options& read) {
  ASSERT_EQ(written.all().size(), read.all().size());
  for (const auto& [key, value] : written.all()) {
    const std::string& stem = key.first;
    SCOPED_TRACE(stem);
    if (std::holds_alternative<std::string>(value)) {
      EXPECT_EQ(*written.text(stem), read.text(stem).value());
    }
    if (std::holds_alternative<double>(value)) {
      EXPECT_DOUBLE_EQ(*written.number(stem), read.number(stem).value());
    }
    if (std::holds_alternative<Eigen::Vector3d>(value)) {
      EXPECT_LT((*written.vector(stem) - read.vector(stem).value()).norm(), 1e-15);
    }
  }
}

void expect_same(const Campaign& written, const Campaign& read) {
  ASSERT_EQ(written.setups.size(), read.setups.size());
  for (std::size_t i = 0; i < written.setups.size(); ++i) {
    const Setup& a = written.setups[i];
    const Setup& b = read.setups[i];
    SCOPED_TRACE(a.name);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.instrument, b.instrument);
    EXPECT_EQ(a.tool, b.tool);
    EXPECT_DOUBLE_EQ(a.repeatability, b.repeatability);
    expect_same(a.options, b.options);
    expect_same(a.noise, b.noise);
    EXPECT_EQ(a.readings.column_set, b.readings.column_set);
    EXPECT_EQ(a.readings.direction, b.readings.direction);
    EXPECT_EQ(a.readings.line, b.readings.line);
    EXPECT_EQ(a.readings.run, b.readings.run);
    EXPECT_EQ(a.readings.source_line, b.readings.source_line);
    expect_near(a.readings.time, b.readings.time, 1e-4);
    ASSERT_EQ(a.readings.value.size(), b.readings.value.size());
    for (std::size_t k = 0; k < a.readings.value.size(); ++k) {
      expect_near(a.readings.value[k], b.readings.value[k], kTenthNanometre);
    }
    for (std::size_t k = 0; k < kAxisCount; ++k) {
      expect_near(a.readings.position[k], b.readings.position[k], kTenthNanometre);
    }
    ASSERT_EQ(a.readings.temperature.size(), b.readings.temperature.size());
    for (const auto& [channel, values] : a.readings.temperature) {
      expect_near(values, b.readings.temperature.at(channel), 1e-4);
    }
  }
}

TEST(CampaignWriter, EveryInstrumentIsReadBack) {
  const testing::ScratchFolder scratch;
  const sim::SimulatedCampaign simulated = sim::simulate(every_instrument());
  for (int again = 0; again < 2; ++again) {
    AtomicFolder folder((scratch.path() / "campaign").string());
    write_simulation(simulated, folder);
    folder.commit();
  }
  expect_same(simulated.campaign, read_campaign((scratch.path() / "campaign/campaign.toml").string()));
  expect_same(simulated.validation,
              read_campaign((scratch.path() / "campaign/truth/campaign.toml").string()));
  EXPECT_TRUE(std::filesystem::exists((scratch.path() / "campaign/model.toml").string()));
  EXPECT_TRUE(std::filesystem::exists((scratch.path() / "campaign/truth/error_functions.csv").string()));
}

TEST(CampaignWriter, TheTruthHasMotionsAndLocationsOfRotaryAxes) {
  const testing::ScratchFolder scratch;
  sim::Study study;
  study.machine = sim::machine_from_code("w C' b X Y Z t", {{{0, 1}, {0, 1}, {0, 1}}});
  study.truth.perfect = true;
  study.truth.locations = {{*LocationSymbol::parse("EX0C"), 10e-6}, {*LocationSymbol::parse("EA0C"), -30e-6}};
  study.truth.alter = [](sim::TruthMachine& truth) {
    truth.set_error(*ErrorSymbol::parse("EXC"), [](double q) { return 2e-6 + 5e-6 * std::cos(q); });
  };
  sim::PointGrid points;
  points.rotary = sim::RotaryMotion::Grid;
  study.measurements = {{"", points}};
  AtomicFolder folder((scratch.path() / "campaign").string());
  write_simulation(sim::simulate(study), folder);
  folder.commit();
  std::ifstream file(scratch.path() / "campaign/truth/error_functions.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  // The constant 2 um of EXC is in EX0C, with the sign of the workpiece side.
  for (const char* row : {"EXC,C,-180,deg,-5.000000,um\n", "EXC,C,0,deg,5.000000,um\n",
                          "ECC,C,90,deg,0.000000,urad\n", "EX0C,,,,8.000000,um\n", "EY0C,,,,0.000000,um\n",
                          "EA0C,,,,-30.000000,urad\n", "EB0C,,,,0.000000,urad\n", "EC0C,,,,0.000000,urad\n"})
    EXPECT_NE(text.find(row), std::string::npos) << row;
}

TEST(CampaignWriter, WritesShortNumbersInEdgeUnits) {
  Campaign campaign;
  campaign.machine = sim::reference_machines()[0];
  volcal::Setup setup;
  setup.name = "line 1/a";
  setup.instrument = "displacement";
  setup.readings.position[0] = {0.1, 0.12345678912};
  setup.readings.position[1] = setup.readings.position[2] = {0.0, -0.0};
  setup.readings.direction[0] = {1, -1};
  setup.readings.value = {{1e-6, -2.5e-3}};
  setup.readings.source_line = {2, 3};
  EXPECT_EQ(readings_file_name(setup), "line_1_a.csv");
  EXPECT_EQ(readings_csv(setup, campaign.machine),
            "x_mm,y_mm,z_mm,dir_x,displacement_mm\n"
            "100,0,0,1,0.001\n"
            "123.4567891,0,0,-1,-2.5\n");
}

TEST(CampaignWriter, RefusesFilesOfOneName) {
  Campaign campaign;
  campaign.machine = sim::reference_machines()[0];
  campaign.setups.resize(2);
  campaign.setups[0].name = "a b";
  campaign.setups[1].name = "a_b";
  for (volcal::Setup& setup : campaign.setups) setup.instrument = "displacement";
  EXPECT_THROW(campaign_toml(campaign, "machine.toml"), std::invalid_argument);
  campaign.setups.resize(1);
  campaign.setups[0].instrument = "tape-measure";
  EXPECT_THROW(campaign_toml(campaign, "machine.toml"), std::invalid_argument);
}

TEST(CampaignWriter, DemoSimulatesAndIsReadBack) {
  const testing::ScratchFolder scratch;
  const sim::Study study = read_study(std::string(VOLCAL_SOURCE_DIR) + "/datasets/demo/study.toml");
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  EXPECT_EQ(simulated.campaign.setups.size(), 15U);
  AtomicFolder folder((scratch.path() / "demo").string());
  write_simulation(simulated, folder);
  folder.commit();
  expect_same(simulated.campaign, read_campaign((scratch.path() / "demo/campaign.toml").string()));
}

}  // namespace
}  // namespace volcal
