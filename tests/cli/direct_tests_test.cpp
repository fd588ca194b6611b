/// Direct tests of rotary axes and drift at rest, simulated with errors that are known and judged by `volcal
/// compare`: figures by hand from the sealed truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

/// Of the tests in `list` that whose `key` is `name`.
Json test_named(const Json& list, const std::string& key, const std::string& name) {
  for (const Json& each : list) {
    if (each.at(key) == name) return each;
  }
  return Json::object();
}

class DirectTests : public ::testing::Test {
 protected:
  std::string in(const std::string& name) const { return (scratch_.path() / name).string(); }

  /// `volcal compare` of the study's campaign with the nominal machine.
  Json compared(const std::string& structure, const std::string& study) {
    EXPECT_EQ(run_program("init \"" + structure + "\" -o " + in("machine")).exit_code, 0);
    std::ofstream(in("machine/tests.toml")) << "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\n"
                                            << study;
    const auto simulated = run_program("simulate " + in("machine/tests.toml") + " -o " + in("campaign"));
    EXPECT_EQ(simulated.exit_code, 0) << simulated.errors;
    const auto run = run_program("compare " + in("campaign/campaign.toml") + " nominal --json");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return Json::parse(run.output).at("models").back().at("standards");
  }

  testing::ScratchFolder scratch_;
};

/// EXC = 3 um cos 2C, EZC = 2 um cos C, EAC = 10 urad cos 2C, a reversal of 20 urad of ECC. Ranges: 6 um
/// radially along X and none along Y at the centre's height, 4 um axially, all of it one wave a turn, 20 urad
/// of tilt about X; the reversal at every target.
TEST_F(DirectTests, OfARotaryAxisShowItsErrors) {
  const Json figures = compared("w C' b X Y Z t", R"([truth]
kind = "perfect"
[truth.functions]
EXC = { basis = "fourier", degree = 2, coefficients_um = [0.0, 0.0, 0.0, 3.0, 0.0] }
EZC = { basis = "fourier", degree = 1, coefficients_um = [0.0, 2.0, 0.0] }
EAC = { basis = "fourier", degree = 2, coefficients_urad = [0.0, 0.0, 0.0, 10.0, 0.0] }
[truth.reversals_urad]
ECC = 20.0
[[measurements]]
kind = "angle-lines"
axes = ["C"]
points = 25
runs = 2
noise = { constant_urad = 0.01 }
[[measurements]]
kind = "axis-of-rotation"
heights_mm = [0.0, 100.0]
frame = "machine"
noise = { constant_um = 0.002, repeatability_um = 0.0 }
)");
  const Json angle = figures.at("iso230_2_rotary").at(0);
  EXPECT_EQ(angle.at("setup"), "angle_C");
  EXPECT_NEAR(angle.at("readings").at("B_urad").get<double>(), 20.0, 0.1);
  EXPECT_NEAR(angle.at("readings").at("M_urad").get<double>(), 0.0, 0.1);
  const auto motion = [&](const std::string& name, const std::string& key) {
    return test_named(figures.at("iso230_7"), "motion", name).at("readings").at(key).get<double>();
  };
  EXPECT_NEAR(motion("radial X", "total_um"), 6.0, 0.05);
  EXPECT_NEAR(motion("radial Y", "total_um"), 0.0, 0.05);
  EXPECT_NEAR(motion("axial Z", "total_um"), 4.0, 0.05);
  EXPECT_NEAR(motion("axial Z", "fundamental_um"), 4.0, 0.05);
  EXPECT_NEAR(motion("tilt about X", "total_urad"), 20.0, 0.5);
  EXPECT_NEAR(motion("tilt about Y", "total_urad"), 0.0, 0.5);
  const auto fitted = run_program("fit " + in("campaign/campaign.toml") + " --json -o " + in("result"));
  ASSERT_LT(fitted.exit_code, 2) << fitted.errors << "sphere and zero are one along the axis of C";
  EXPECT_THAT(fitted.output, HasSubstr("\"rank_deficient\""));
}

/// The channel rises by 1 K in an hour, for four: growth of the spindle and its tilt are what the sealed
/// answer says per kelvin.
TEST_F(DirectTests, OfDriftAtRestShowWhatIsHidden) {
  const Json figures = compared("w C' b X Y Z t", R"([truth]
kind = "perfect"
[[temperatures]]
channel = "spindle"
start_degC = 20.0
drift_K_per_hour = 1.0
[[hidden]]
kind = "tool-growth-channel"
channel = "spindle"
amplitude_um = 2.0
[[hidden]]
kind = "thermal-tilt"
symbol = "EBZ"
channel = "spindle"
amplitude_urad = 3.0
[[measurements]]
kind = "drift-at-rest"
tools = ["short", "long"]
noise = { constant_um = 0.002 }
)");
  const Json hidden = Json::parse(content(scratch_.path() / "campaign/truth/hidden.json"));
  EXPECT_NE(hidden.dump().find("tool-growth-channel"), std::string::npos) << "sealed";
  const auto drift = [&](const std::string& name, const std::string& key) {
    return test_named(figures.at("iso230_3"), "drift", name).at("readings").at(key).get<double>();
  };
  EXPECT_NEAR(drift("Z displacement", "range_um"), 4.0 * 2.0, 0.05);
  EXPECT_NEAR(drift("Z displacement", "first_hour_um"), 2.0, 0.05);
  EXPECT_NEAR(drift("Z displacement", "change_um"), -8.0, 0.05);
  EXPECT_NEAR(drift("tilt B", "range_urad"), 4.0 * 3.0, 0.2);
  EXPECT_NEAR(drift("tilt B", "any_hour_urad"), 3.0, 0.2);
  const Json of_z = test_named(figures.at("iso230_3"), "drift", "Z displacement");
  EXPECT_NEAR(of_z.at("temperatures_degC").at("spindle").at(1).get<double>(), 24.0, 1e-3);
}

}  // namespace
}  // namespace volcal
