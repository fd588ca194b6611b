/// Every command on a campaign with nothing to estimate: figures, exit 0, and of --json one document.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class NothingToEstimate : public ::testing::Test {
 protected:
  NothingToEstimate() {
    std::ofstream machine(path("machine.toml"));
    machine << "format = \"volcal-machine-1\"\nname = \"wide\"\nstructure = \"w b X Y Z t\"\n"
               "[datum]\nprimary = \"X\"\nsecondary = \"Y\"\n";
    for (const char* axis : {"X", "Y", "Z"})
      machine << "[axes." << axis
              << "]\ntravel_mm = [-300.0, 300.0]\nhome_mm = 0.0\nreference_point_mm = [0.0, 0.0, 0.0]\n";
    machine << "[tools.t]\noffset_mm = [0.0, 0.0, 0.0]\n";
    std::ofstream(path("model.toml")) << "format = \"volcal-model-1\"\nmachine = "
                                         "\"machine.toml\"\n[functions]\ndefault = { basis = \"zero\" }\n"
                                         "[locations]\nEC0Y = \"zero\"\nEA0Z = \"zero\"\nEB0Z = \"zero\"\n";
    std::ofstream(path("campaign.toml"))
        << "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"P\"\n"
           "instrument = \"volumetric-points\"\ndata = \"p.csv\"\ntool = \"t\"\nalignment = \"none\"\n"
           "noise = { constant_um = 1.0 }\n";
    std::ofstream(path("p.csv")) << "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um\n0,0,0,1,0,0\n100,0,0,2,1,0\n"
                                    "0,100,50,3,2,1\n30,-100,50,3,2,1\n";
  }

  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  /// Its standard output as one document.
  nlohmann::json document(const std::string& command) const {
    const testing::ProgramRun run = testing::run_program(command + " --json");
    EXPECT_EQ(run.exit_code, 0) << command << run.errors;
    EXPECT_EQ(run.errors, "") << command;
    EXPECT_TRUE(nlohmann::json::accept(run.output)) << run.output;
    return nlohmann::json::parse(run.output, nullptr, false);
  }
  std::string fit() const {
    return "fit " + path("campaign.toml") + " --model " + path("model.toml") + " -o " + path("result");
  }

 private:
  testing::ScratchFolder scratch_;
};

// Twelve components with sigma = 1 um: squares 1 + 5 + 14 + 14 = 34 um^2.
TEST_F(NothingToEstimate, FitAndValidateGiveTheFiguresOfTheReadings) {
  const auto fitted = document(fit());
  EXPECT_NEAR(fitted.at("chi2").get<double>(), 34.0, 1e-9);
  EXPECT_NEAR(fitted.at("dof").get<double>(), 12.0, 1e-12);
  EXPECT_EQ(fitted.at("rank").at("parameters"), 0);
  const auto figures = document("validate " + path("result") + " " + path("campaign.toml"));
  EXPECT_NEAR(figures.at("rms_after_um").get<double>(), std::sqrt(34.0 / 4.0), 1e-9);
  EXPECT_EQ(figures.at("rms_before_um"), figures.at("rms_after_um"));
}

TEST_F(NothingToEstimate, CompareDiagnoseAndMonteCarloEnd) {
  const auto compared = document("compare " + path("campaign.toml") + " nominal");
  EXPECT_EQ(compared.at("models").at(0).at("total").at("observations"), 12);
  const std::string model = " --model " + path("model.toml");
  const auto diagnosis = document("diagnose " + path("campaign.toml") + model + " -o " + path("diagnosis"));
  EXPECT_TRUE(diagnosis.contains("verdict"));
  const auto drawn = document("montecarlo " + path("campaign.toml") + model + " -n 1000 -o " + path("drawn"));
  EXPECT_EQ(drawn.at("draws"), 1000);
  EXPECT_TRUE(drawn.at("quantities").empty());
}

TEST_F(NothingToEstimate, WhatCannotHoldNothingSaysSo) {
  ASSERT_EQ(testing::run_program(fit()).exit_code, 0);
  const std::string result = path("result");
  for (const char* format : {"linuxcnc", "linuxcnc-grid", "neutral-csv", "klipper"}) {
    const testing::ProgramRun zeros =
        testing::run_program("tables " + result + " --dry-run --format " + format);
    EXPECT_EQ(zeros.exit_code, 0) << format << zeros.errors;
  }
  const testing::ProgramRun csv = testing::run_program("tables " + result + " --format csv -o " + path("t"));
  EXPECT_EQ(csv.exit_code, 2);
  EXPECT_THAT(csv.errors, HasSubstr("every error motion and squareness is switched off in the model"));
  const testing::ProgramRun npz = testing::run_program("export " + result + " --npz " + path("x.npz"));
  EXPECT_EQ(npz.exit_code, 2);
  EXPECT_THAT(npz.errors, HasSubstr("nothing was estimated"));
}

TEST_F(NothingToEstimate, ValidateSaysThatTheFitSawTheseReadings) {
  ASSERT_EQ(testing::run_program(fit()).exit_code, 0);
  const std::string validate = "validate " + path("result") + " " + path("campaign.toml");
  const testing::ProgramRun same = testing::run_program(validate);
  EXPECT_THAT(same.output, HasSubstr("Readings that the fit was made from"));
  EXPECT_THAT(same.output, HasSubstr("! this is the campaign that the fit was made from"));
  EXPECT_THAT(same.output, Not(HasSubstr("never saw")));
  EXPECT_EQ(document(validate).at("fitted_readings"), 4);
  // The same readings in another order and under another name are the same readings.
  std::ofstream(path("p.csv"))
      << "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um\n30,-100,50,3,2,1\n0,0,0,1,0,0\n100,0,0,2,1,0\n"
         "0,100,50,3,2,1\n";
  EXPECT_EQ(document(validate).at("fitted_readings"), 4);
  std::ofstream(path("campaign.toml"), std::ios::app)
      << "[[setups]]\nname = \"Q\"\ninstrument = \"volumetric-points\"\ndata = \"q.csv\"\ntool = \"t\"\n"
         "alignment = \"none\"\nnoise = { constant_um = 1.0 }\n";
  std::ofstream(path("q.csv")) << "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um\n50,0,0,1,0,0\n";
  EXPECT_THAT(testing::run_program(validate).output,
              HasSubstr("the fit was made from 4 of 5 readings, those of P"));
  std::ofstream(path("p.csv")) << "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um\n0,0,0,1,0,0.001\n100,0,0,2,1,0\n";
  const testing::ProgramRun unseen = testing::run_program(validate);
  EXPECT_THAT(unseen.output, HasSubstr("Readings that the fit never saw"));
  EXPECT_THAT(unseen.output, Not(HasSubstr("! ")));
}

}  // namespace
}  // namespace volcal
