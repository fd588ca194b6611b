// Circles of a ball-bar as the page draws them.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/workbench/session_json.h"
#include "volcal/identify/workbench/workbench.h"

namespace volcal::workbench {
namespace {

/// A circle there and back without a deviation but for one reading of 50 um, which is left out: it is in no
/// figure of the picture.
TEST(WorkbenchCircles, LeaveOutWhatIsLeftOut) {
  const testing::ScratchFolder folder;
  std::ofstream machine(folder.path() / "machine.toml"), readings(folder.path() / "bar.csv");
  machine << "format = \"volcal-machine-1\"\nstructure = \"w X' b Y Z t\"\n";
  for (const char* axis : {"X", "Y", "Z"})
    machine << "[axes." << axis << "]\ntravel_mm = [-500, 500]\nhome_mm = 0.0\n";
  machine << "[tools.bar]\noffset_mm = [0, 0, 0]\n" << std::flush;
  readings << "x_mm,y_mm,z_mm,line,length_mm\n";
  for (int k = 0; k < 72; ++k) {
    const double angle = 10.0 * (k < 36 ? k : 71 - k) * std::numbers::pi / 180.0;
    readings << 150.0 * std::cos(angle) << ',' << 150.0 * std::sin(angle) << ",0," << k / 36 << ','
             << (k == 7 ? 150.05 : 150.0) << '\n';
  }
  readings.close();
  std::ofstream(folder.path() / "model.toml")
      << "format = \"volcal-model-1\"\n[functions]\ndefault = { basis = \"zero\" }\n";
  std::ofstream(folder.path() / "campaign.toml")
      << "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"B\"\n"
         "instrument = \"ball-bar\"\ndata = \"bar.csv\"\ncentre_mm = [0.0, 0.0, 0.0]\n"
         "noise = { constant_um = 1.0 }\nleave_out = [{ rows = [9], reason = \"slip\" }]\n";
  WorkbenchOptions options;
  options.campaign = (folder.path() / "campaign.toml").string();
  options.model = (folder.path() / "model.toml").string();
  options.threads = 1;
  options.confirm_behind = false;
  Workbench bench(options);
  bench.wait_until_idle();
  const Answer answer = bench.answer("polar", "{}", "one");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const Json circle = Json::parse(answer.body)["circles"][0];
  EXPECT_EQ(circle["rows"].size(), 71U);
  EXPECT_LT(circle["G_measured_um"].get<double>(), 2.0);
}

}  // namespace
}  // namespace volcal::workbench
