/// Readings that a campaign leaves out: how they are named, what is refused, that they come back from a file.

#include "volcal/identify/io/campaign/left_out_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

class LeftOutReadings : public ::testing::Test {
 protected:
  Campaign read(const std::string& leave_out) const {
    std::ofstream(path("machine.toml"))
        << "format = \"volcal-machine-1\"\nname = \"m\"\nstructure = \"w X b Y Z t\"\n"
           "[axes.X]\ntravel_mm = [0, 100]\nhome_mm = 0\n[axes.Y]\ntravel_mm = [0, 100]\nhome_mm = 0\n"
           "[axes.Z]\ntravel_mm = [0, 100]\nhome_mm = 0\n"
           "[tools.short]\noffset_mm = [0, 0, -100]\n";
    std::ofstream(path("points.csv")) << "# two comment lines\nx_mm,y_mm,z_mm,ex_um,ey_um,ez_um\n"
                                         "0,0,0,1,2,3\n100,0,0,4,5,6\n0,100,0,7,8,9\n100,100,100,1,1,1\n";
    std::ofstream(path("campaign.toml"))
        << "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\nnoise = { constant_um = 1 }\n"
           "[[setups]]\nname = \"points\"\ninstrument = \"volumetric-points\"\ndata = \"points.csv\"\n"
           "skip_rows = 1\n"
        << leave_out;
    return read_campaign(path("campaign.toml"));
  }
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }

 private:
  testing::ScratchFolder scratch_;
};

TEST_F(LeftOutReadings, AreNamedByLineOfTheFileAndColumn) {
  const Campaign campaign = read(
      "leave_out = [{ rows = [6, 3], columns = [\"ez_um\"], reason = \"slip\" },"
      " { rows = [4], reason = \"bumped\" }]\n");
  const auto& left_out = campaign.setups[0].left_out;
  ASSERT_EQ(left_out.size(), 5U);
  EXPECT_EQ(left_out[0].row, 0U);
  EXPECT_EQ(left_out[0].channel, 2U);
  EXPECT_EQ(left_out[0].reason, "slip");
  for (std::size_t channel = 0; channel < 3; ++channel) {
    EXPECT_EQ(left_out[1 + channel].row, 1U);
    EXPECT_EQ(left_out[1 + channel].channel, channel);
    EXPECT_EQ(left_out[1 + channel].reason, "bumped");
  }
  EXPECT_EQ(left_out[4].row, 3U);
  EXPECT_EQ(campaign.setups[0].rows_left_out(), (std::vector<bool>{false, true, false, false}));
}

TEST_F(LeftOutReadings, SurviveBeingWritten) {
  const Campaign campaign = read(
      "leave_out = [{ rows = [3, 5], columns = [\"ez_um\", \"ex_um\"], reason = \"a \\\"slip\\\"\" }]\n");
  std::filesystem::create_directory(path("copy"));
  write_campaign(campaign, path("copy"), "../machine.toml");
  const Campaign copy = read_campaign(path("copy/campaign.toml"));
  ASSERT_EQ(copy.setups[0].left_out.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(copy.setups[0].left_out[i].row, campaign.setups[0].left_out[i].row);
    EXPECT_EQ(copy.setups[0].left_out[i].channel, campaign.setups[0].left_out[i].channel);
    EXPECT_EQ(copy.setups[0].left_out[i].reason, "a \"slip\"");
  }
}

TEST_F(LeftOutReadings, AreRefusedWithPlaceAndRemedy) {
  struct Case {
    std::string entry, problem, remedy;
  };
  const std::vector<Case> cases = {
      {"{ rows = [2], reason = \"r\" }", "has no reading in that line", "3 to 6"},
      {"{ rows = [3.5], reason = \"r\" }", "leaves out row 3.5", "3 to 6"},
      {"{ rows = [1e300], reason = \"r\" }", "leaves out row 1e+300", "3 to 6"},
      {"{ rows = [-1], reason = \"r\" }", "leaves out row -1", "3 to 6"},
      {"{ rows = [], reason = \"r\" }", "rows is empty", "name lines of the file"},
      {"{ reason = \"r\" }", "rows is missing", ""},
      {"{ rows = [3] }", "reason is missing", ""},
      {"{ rows = [3], reason = \"\" }", "reason is empty", "say why"},
      {"{ rows = [3], columns = [\"ez\"], reason = \"r\" }", "unknown column ez", "ez_um"},
      {"{ rows = [3, 3], reason = \"r\" }", "leaves out row 3 twice", "once"},
      {"{ rows = [3, 4, 5, 6], reason = \"r\" }", "leaves out all its readings", "remove the setup"},
      {"{ row = [3], reason = \"r\" }", "row", "rows"},
  };
  for (const Case& each : cases) {
    try {
      read("leave_out = [" + each.entry + "]\n");
      ADD_FAILURE() << each.entry << " was accepted";
    } catch (const InputError& error) {
      const std::string text = error.what();
      EXPECT_THAT(text, HasSubstr("campaign.toml:9")) << each.entry;
      EXPECT_THAT(text, HasSubstr(each.problem)) << each.entry;
      EXPECT_THAT(text, HasSubstr(each.remedy)) << each.entry;
    }
  }
}

}  // namespace
}  // namespace volcal
