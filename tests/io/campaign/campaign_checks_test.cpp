/// Readings against what the commanded positions foresee: points of a tracker on one line.

#include "volcal/identify/io/campaign/campaign_checks.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/refusal.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using Points = std::vector<Eigen::Vector3d>;

class TrackerReadings : public ::testing::Test {
 protected:
  TrackerReadings() {
    write("machine.toml",
          "format = \"volcal-machine-1\"\nstructure = \"w b X Y Z t\"\n"
          "[axes.X]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n[axes.Y]\ntravel_mm = [0.0, 500.0]\n"
          "home_mm = 0.0\n[axes.Z]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n"
          "[tools.short]\noffset_mm = [0.0, 0.0, 0.0]\n");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path() / name) << text;
  }
  /// Of points at mm, with noise of 1 um and 1 urad, by azimuths times `sign`; the station is guessed at
  /// `guess`.
  std::string refused(const Points& points, const Eigen::Vector3d& station, const Eigen::Vector3d& guess,
                      unsigned seed, double sign = 1.0) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    std::string rows = "x_mm,y_mm,z_mm,length_mm,azimuth_deg,elevation_deg\n";
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d v = p - station;
      const double urad = 1e-6 * 180.0 / std::numbers::pi;
      rows +=
          fmt::format("{},{},{},{:.7f},{:.9f},{:.9f}\n", p.x(), p.y(), p.z(), v.norm() + 1e-3 * noise(random),
                      sign * std::atan2(v.y(), v.x()) * 180.0 / std::numbers::pi + urad * noise(random),
                      std::asin(v.z() / v.norm()) * 180.0 / std::numbers::pi + urad * noise(random));
    }
    write("t.csv", rows);
    write("campaign.toml",
          fmt::format(
              "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"T\"\n"
              "instrument = \"laser-tracker\"\ndata = \"t.csv\"\nstation_mm = [{:.1f}, {:.1f}, {:.1f}]\n"
              "tool = \"short\"\nnoise = {{ constant_um = 1.0, angle_urad = 1.0 }}\n",
              guess.x(), guess.y(), guess.z()));
    return testing::refusal([&] { read_campaign((scratch_.path() / "campaign.toml").string()); });
  }
  static Points line(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    Points points;
    for (int i = 0; i <= 20; ++i) points.emplace_back(from + (to - from) * (i / 20.0));
    return points;
  }

  testing::ScratchFolder scratch_;
  const Eigen::Vector3d station_{-300.0, -200.0, -700.0}, guess_{-293.0, -205.0, -694.0};
};

TEST_F(TrackerReadings, OnALineAreTaken) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    EXPECT_EQ(refused(line({0, 0, 0}, {500, 0, 0}), station_, guess_, seed), "") << seed;
    EXPECT_EQ(refused(line({250, 500, 0}, {250, 0, 0}), station_, guess_, seed), "") << seed;
    EXPECT_EQ(refused(line({0, 0, 0}, {500, 500, 500}), station_, guess_, seed), "") << seed;
  }
}

/// A line that runs through the station leaves the turn about it open.
TEST_F(TrackerReadings, OnALineThroughTheStationAreTaken) {
  for (unsigned seed = 0; seed < 12; ++seed)
    EXPECT_EQ(refused(line({100, 0, 0}, {500, 0, 0}), {-50.0, 3.0, 2.0}, {-50.0, -4.0, 7.0}, seed), "")
        << seed;
}

/// A mirrored plate of 500 x 500 x 200 mm is turned over by the best rotation: its heights are reversed.
TEST_F(TrackerReadings, ReversedAnglesAreRefusedWherePointsFillAVolume) {
  Points points;
  for (const double y : {0.0, 250.0, 500.0}) {
    for (const double z : {0.0, 100.0, 200.0}) {
      for (const Eigen::Vector3d& p : line({0, y, z}, {500, y, z})) points.push_back(p);
    }
  }
  const Eigen::Vector3d aside(-1500.0, 250.0, 100.0), guess(-1493.0, 245.0, 106.0);
  EXPECT_EQ(refused(points, aside, guess, 1), "");
  EXPECT_THAT(refused(points, aside, guess, 1, -1.0), HasSubstr("changes by -"));
}

}  // namespace
}  // namespace volcal
