#pragma once
/// A campaign that the program simulates from a study in a folder of its own, and the program's fit of it.

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal::testing {

inline const std::string kDemoMachine = VOLCAL_SOURCE_DIR "/datasets/demo/machine.toml";

class SimulatedCampaign {
 public:
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }

  /// `measurements`: the study's TOML after its seed. The model has `knots` knots per function.
  void simulate(int seed, const std::string& measurements, int degree, int knots,
                const std::string& machine = kDemoMachine) const {
    std::ofstream(path("study.toml"))
        << "format = \"volcal-study-1\"\nmachine = \"" << machine << "\"\nseed = " << seed << "\n"
        << measurements;
    std::ofstream(path("model.toml"))
        << "format = \"volcal-model-1\"\nmachine = \"" << machine
        << "\"\n[functions]\ndefault = { basis = \"bspline\", degree = " << degree << ", knots = " << knots
        << " }\n";
    const ProgramRun run = run_program("simulate " + path("study.toml") + " -o " + path("campaign"));
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }
  ProgramRun fit(const std::string& options) const {
    return run_program("fit " + path("campaign/campaign.toml") + " --model " + path("model.toml") + " -o " +
                       path("result") + " " + options);
  }

 private:
  ScratchFolder scratch_;
};

}  // namespace volcal::testing
