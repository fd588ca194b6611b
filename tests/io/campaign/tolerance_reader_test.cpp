#include "volcal/identify/io/campaign/tolerance_reader.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

constexpr const char* kMachine =
    "format = \"volcal-machine-1\"\nstructure = \"w X' Y' b Z t\"\n"
    "[axes.X]\ntravel_mm = [0, 800]\nhome_mm = 0\n[axes.Y]\ntravel_mm = [0, 500]\nhome_mm = 0\n"
    "[axes.Z]\ntravel_mm = [-400, 0]\nhome_mm = 0\n[tools.t]\noffset_mm = [0, 0, -200]\n";

class ToleranceFiles : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_.path() / name).string();
    std::ofstream(path) << text;
    return path;
  }
  std::string machine(const std::string& tolerances = {}) const {
    return write("machine.toml", kMachine + tolerances);
  }
  std::string tolerances(const std::string& body, const std::string& head = {}) const {
    return write("tolerances.toml", "format = \"volcal-tolerances-1\"\n" + head + "[tolerances]\n" + body);
  }
  static std::string problem_of(const std::string& path, const std::string& with) {
    try {
      read_design(path, with);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

 private:
  testing::ScratchFolder folder_;
};

double width(const Tolerances& tolerances, const char* name) {
  if (const auto symbol = LocationSymbol::parse(name)) return tolerances.squareness.at(*symbol);
  return tolerances.functions.at(*ErrorSymbol::parse(name));
}

TEST_F(ToleranceFiles, ClassesHoldForTheirErrorsAndOneErrorInTheirPlace) {
  const DesignedMachine design = read_design(
      machine(), tolerances("positioning_um = 10\nEYY_um = 6.0\nstraightness_um = 8\nangles_urad = 15\n"
                            "EBX_urad = 0\nsquareness_urad = 20\nEC0Y_urad = 12\n"));
  EXPECT_DOUBLE_EQ(width(design.tolerances, "EXX"), 10e-6);
  EXPECT_DOUBLE_EQ(width(design.tolerances, "EYY"), 6e-6);
  EXPECT_DOUBLE_EQ(width(design.tolerances, "EZX"), 8e-6);
  EXPECT_DOUBLE_EQ(width(design.tolerances, "ECZ"), 15e-6);
  EXPECT_EQ(width(design.tolerances, "EBX"), 0.0);
  EXPECT_DOUBLE_EQ(width(design.tolerances, "EB0Z"), 20e-6);
  EXPECT_DOUBLE_EQ(width(design.tolerances, "EC0Y"), 12e-6);
  EXPECT_EQ(design.tolerances.functions.size(), 18U);
  EXPECT_EQ(design.tolerances.squareness.size(), 3U);
}

TEST_F(ToleranceFiles, StandInTheMachineFileOrNameIt) {
  const std::string in_machine = machine("[tolerances]\nEXX_um = 5\n");
  EXPECT_TRUE(is_design(in_machine, ""));
  EXPECT_DOUBLE_EQ(width(read_design(in_machine, "").tolerances, "EXX"), 5e-6);
  EXPECT_EQ(read_machine(in_machine).axes.size(), 3U) << "other commands read the machine as before";
  const std::string alone = tolerances("EXX_um = 4\n", "machine = \"machine.toml\"\n");
  EXPECT_TRUE(is_design(alone, ""));
  EXPECT_DOUBLE_EQ(width(read_design(alone, "").tolerances, "EXX"), 4e-6);
  EXPECT_DOUBLE_EQ(width(read_design(in_machine, alone).tolerances, "EXX"), 4e-6);
}

TEST_F(ToleranceFiles, MistakesHavePlaceAndRemedy) {
  const struct {
    const char* body;
    const char* said;
  } cases[] = {{"EXX_mm = 0.01\n", "EXX"},
               {"EXX = 10\n", "EXX"},
               {"straigthness_um = 8\n", "did you mean \"straightness_um\"?"},
               {"EXX_um = -1\n", "tolerances.toml:3"},
               {"EXX_um = \"ten\"\n", "tolerances.toml:3"},
               {"EAC_urad = 5\n", "error of a rotary axis"},
               {"EA0Y_urad = 5\n", "EA0Y_urad"},
               {"", "states no tolerance"}};
  for (const auto& each : cases) {
    const std::string said = problem_of(machine(), tolerances(each.body));
    EXPECT_NE(said.find(each.said), std::string::npos) << each.body << said;
    EXPECT_NE(said.find("tolerances.toml"), std::string::npos) << said;
  }
  EXPECT_NE(problem_of(machine(), "").find("--tolerances"), std::string::npos);
  EXPECT_NE(problem_of(tolerances("EXX_um = 1\n"), "").find("machine"), std::string::npos);
  EXPECT_THROW(read_machine(machine("[tolerances]\nEXX_mm = 5\n")), InputError) << "a slip in any command";
}

}  // namespace
}  // namespace volcal
