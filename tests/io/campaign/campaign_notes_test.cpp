// What is noticed while a campaign is read and is no error.

#include "volcal/identify/io/campaign/campaign_notes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/broken_campaigns.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string kLine =
    "x_mm,y_mm,z_mm,displacement_mm\n0,0,0,0\n50,0,0,50\n100,0,0,100\n50,0,0,50.001\n0,0,0,0\n";

/// One displacement setup on a machine of X, Y and Z; `keys`: further lines of the setup.
class NotesTest : public ::testing::Test {
 protected:
  Campaign read(const std::string& csv, const std::string& keys = "",
                const std::string& campaign = "") const {
    testing::spill(scratch_.path() / "machine.toml", machine());
    testing::spill(scratch_.path() / "line.csv", csv);
    testing::spill(scratch_.path() / "campaign.toml",
                   "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n" + campaign +
                       "[[setups]]\nname = \"X\"\ninstrument = \"displacement\"\ndata = \"line.csv\"\n"
                       "direction = [1, 0, 0]\nnoise = { constant_um = 1.0 }\n" +
                       keys);
    return read_campaign((scratch_.path() / "campaign.toml").string());
  }

  static std::string machine() {
    std::string text = "format = \"volcal-machine-1\"\nstructure = \"w X' b Y Z t\"\n";
    for (const char axis : {'X', 'Y', 'Z'})
      text += std::string("[axes.") + axis + "]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n";
    return text + "[tools.probe]\noffset_mm = [0.0, 0.0, 0.0]\n";
  }

  testing::ScratchFolder scratch_;
};

/// A table that is recorded within a turn: over 0 and back, then half a turn from 300 to 120 and on.
TEST(NotesOnATable, DirectionsFollowOverTheEndOfATurn) {
  const testing::ScratchFolder scratch;
  testing::spill(
      scratch.path() / "machine.toml",
      "format = \"volcal-machine-1\"\nstructure = \"w C' b Z t\"\n[axes.C]\ntravel_deg = [0, 360]\n"
      "home_deg = 0.0\ncentre_mm = [0, 0, 0]\n[axes.Z]\ntravel_mm = [0, 500]\nhome_mm = 0.0\n"
      "[tools.probe]\noffset_mm = [0, 0, 0]\n");
  testing::spill(scratch.path() / "turn.csv",
                 "c_deg,z_mm,angle_urad\n300,0,0\n0,0,1\n60,0,2\n0,0,1\n300,0,0\n120,0,1\n180,0,2\n");
  testing::spill(scratch.path() / "campaign.toml",
                 "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"R\"\n"
                 "instrument = \"angle\"\ndata = \"turn.csv\"\naxis = [0, 0, 1]\n"
                 "noise = { constant_urad = 1.0 }\n");
  const Campaign campaign = read_campaign((scratch.path() / "campaign.toml").string());
  EXPECT_THAT(campaign.setups[0].readings.direction[index_of(AxisName::C)],
              ElementsAre(1, 1, 1, -1, -1, 0, 1));
  EXPECT_THAT(
      sentences(campaign.notes),
      Contains(HasSubstr("half a turn of C goes either way: the direction of approach of 1 reading")));
}

TEST_F(NotesTest, DirectionsFollowFromTheOrder) {
  const Campaign campaign = read(kLine);
  EXPECT_THAT(campaign.setups[0].readings.direction[0], ElementsAre(1, 1, 1, -1, -1));
  EXPECT_THAT(campaign.setups[0].readings.direction[1], IsEmpty()) << "Y stands still";
  EXPECT_THAT(sentences(campaign.notes),
              ElementsAre(AllOf(HasSubstr("dir_x in X"), HasSubstr("\"as-recorded\""))));
}

TEST_F(NotesTest, DirectionsStayUnknownWhereAskedFor) {
  for (const Campaign& campaign :
       {read(kLine, "directions = \"as-recorded\"\n"), read(kLine, "", "directions = \"as-recorded\"\n")}) {
    EXPECT_THAT(campaign.setups[0].readings.direction[0], IsEmpty());
    EXPECT_THAT(campaign.notes, IsEmpty());
  }
}

/// All towards +: nothing could be learnt from it, and a model's reversal is to be told as unrecorded.
TEST_F(NotesTest, DirectionsThatNeverChangeStayUnknown) {
  const Campaign campaign = read("x_mm,y_mm,z_mm,displacement_mm\n0,0,0,0\n50,0,0,50\n100,0,0,100\n");
  EXPECT_THAT(campaign.setups[0].readings.direction[0], IsEmpty());
  EXPECT_THAT(campaign.notes, IsEmpty());
}

TEST_F(NotesTest, ColumnsThatAreNotReadAreNamedWithTheKeyThatReadsThem) {
  const std::string csv =
      "x_mm,y_mm,z_mm,displacement_mm,direction_x,diry,Time [ms],temp_x,Remark,dir_z\n"
      "0,0,0,0,1,1,0,20,a,1\n50,0,0,50,1,1,5000,20,b,1\n";
  const Campaign campaign = read(csv);
  EXPECT_THAT(
      sentences(campaign.notes),
      ElementsAre(AllOf(HasSubstr("setup \"X\": direction_x, diry, Time [ms], temp_x, Remark of line.csv are "
                                  "not read"),
                        HasSubstr("columns = { dir_x = \"direction_x\", dir_y = \"diry\", time_s = "
                                  "\"Time [ms]\", T_x_degC = \"temp_x\" }"),
                        HasSubstr("scale = { time_s = 0.001 }"))));
  const Campaign mapped =
      read(csv,
           "columns = { dir_x = \"direction_x\", dir_y = \"diry\", time_s = \"Time [ms]\", "
           "T_x_degC = \"temp_x\" }\nscale = { time_s = 0.001 }\n");
  EXPECT_THAT(mapped.setups[0].readings.time, ElementsAre(0.0, 5.0));
  EXPECT_THAT(sentences(mapped.notes), ElementsAre(HasSubstr("Remark of line.csv is not read")));
}

TEST_F(NotesTest, ConstantsStandForWhatStoodStill) {
  const Campaign campaign = read("Target,Ref\n0,0\n100,100.001\n",
                                 "columns = { x_mm = \"Target\", displacement_mm = \"Ref\" }\n"
                                 "constants = { y_mm = 250.0, z_mm = 10.0, T_air_degC = 21.5 }\n");
  const Readings& readings = campaign.setups[0].readings;
  EXPECT_THAT(readings.position[1], ElementsAre(0.25, 0.25));
  EXPECT_THAT(readings.position[2], ElementsAre(0.01, 0.01));
  EXPECT_THAT(readings.temperature.at("air"), ElementsAre(21.5, 21.5));
}

TEST_F(NotesTest, ConstantsAreCheckedLikeColumns) {
  try {
    read("x_mm,displacement_mm\n0,0\n100,100.001\n", "constants = { y_mm = 2500.0, z_mm = 0.0 }\n");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.problem(), HasSubstr("y_mm = 2500 lies outside the travel"));
    EXPECT_THAT(error.place().file, HasSubstr("campaign.toml"));
    EXPECT_EQ(error.place().line, 9);
  }
}

/// The remedy must not read one axis as another one.
TEST_F(NotesTest, AMissingAxisIsNoOtherAxis) {
  try {
    read("x_mm,z_mm,displacement_mm\n0,0,0\n100,0,100\n");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.problem(), HasSubstr("column y_mm is missing"));
    EXPECT_THAT(error.remedy(), HasSubstr("constants = { y_mm = 0.0 }"));
    EXPECT_THAT(error.remedy(), Not(HasSubstr("y_mm = \"x_mm\"")));
    EXPECT_THAT(error.remedy(), Not(HasSubstr("y_mm = \"z_mm\"")));
  }
}

TEST_F(NotesTest, AFileInACodePageIsRead) {
  const std::string csv = "Position;Y;Z;Abweichung [\xB5m]\n-0,0;0;0;-49,2\n100,0;0;0;48,1\n";
  const std::string keys =
      "delimiter = \";\"\ndecimal = \",\"\ncolumns = { x_mm = \"Position\", y_mm = \"Y\", z_mm = \"Z\", "
      "deviation_um = "
      "\"Abweichung [\xC2\xB5m]\" }\n";
  for (const char* encoding : {"cp1252", "latin1"}) {
    const Campaign campaign = read(csv, keys + "encoding = \"" + encoding + "\"\n");
    EXPECT_NEAR(campaign.setups[0].readings.value[0][0], -49.2e-6, 1e-15) << encoding;
  }
  EXPECT_THROW(read(csv, keys), InputError);
  const Campaign all = read(csv, keys, "encoding = \"cp1252\"\n");
  EXPECT_NEAR(all.setups[0].readings.value[0][0], -49.2e-6, 1e-15) << "for all files that are not UTF-8";
  const std::string utf8 = "Position;Y;Z;Abweichung [\xC2\xB5m]\n-0,0;0;0;-49,2\n100,0;0;0;48,1\n";
  EXPECT_NO_THROW(read(utf8, keys, "encoding = \"cp1252\"\n")) << "a file that is UTF-8 is read as it is";
}

TEST_F(NotesTest, RowsThatRepeatAreTold) {
  std::string rows = "0,0,0,0.0011,0\n50,0,0,50.0021,5\n100,0,0,99.9987,10\n";
  const Campaign once = read("x_mm,y_mm,z_mm,displacement_mm,time_s\n" + rows);
  EXPECT_THAT(once.notes, IsEmpty());
  const Campaign twice =
      read("x_mm,y_mm,z_mm,displacement_mm,time_s\n" + rows + rows, "directions = \"as-recorded\"\n");
  EXPECT_THAT(sentences(twice.notes),
              ElementsAre(HasSubstr("3 of 6 rows repeat an earlier row in every column, line 5 that of "
                                    "line 2")));
}

/// The file of a run under another time and run; readings in whole micrometres can agree by themselves.
TEST_F(NotesTest, CopiesWithOtherTimesAreTold) {
  const auto runs = [](const char* format) {
    std::string csv = "x_mm,y_mm,z_mm,displacement_mm,time_s,run\n";
    for (int row = 0; row < 20; ++row) {
      const int k = row % 10;
      csv += fmt::format("{},0,0,", 20 * k) +
             fmt::format(fmt::runtime(format), 20 * k + 1e-3 * std::sin(k + 1)) +
             fmt::format(",{},{}\n", 5 * row, 1 + row / 10);
    }
    return csv;
  };
  EXPECT_THAT(sentences(read(runs("{:.6f}")).notes),
              Contains(HasSubstr("10 of 20 rows repeat an earlier row in all but its time, line 12 that of "
                                 "line 2")));
  EXPECT_THAT(sentences(read(runs("{:.3f}")).notes), Not(Contains(HasSubstr("repeat an earlier row"))));
}

/// Without times equal readings may be chance: three of ten of a coarse dial gauge are no copies.
TEST_F(NotesTest, EqualReadingsOfACoarseInstrumentAreNoCopies) {
  std::string csv = "x_mm,y_mm,z_mm,deviation_um\n";
  for (const char* value : {"1", "2", "1", "3", "2", "4", "5", "6", "7", "8"})
    csv += "10,0,0," + std::string(value) + "\n";
  EXPECT_THAT(read(csv).notes, IsEmpty());
}

TEST_F(NotesTest, DirectionsAgainstTheOrderAreTold) {
  std::string csv = "x_mm,y_mm,z_mm,displacement_mm,dir_x\n";
  for (int k = 0; k <= 5; ++k) csv += std::to_string(20 * k) + ",0,0," + std::to_string(20 * k) + ",-1\n";
  for (int k = 4; k >= 0; --k) csv += std::to_string(20 * k) + ",0,0," + std::to_string(20 * k) + ",1\n";
  EXPECT_THAT(sentences(read(csv).notes), Contains(AllOf(HasSubstr("10 of 10 moves of X go against dir_x"),
                                                         HasSubstr("scale = { dir_x = -1 }"))));
  const Campaign mended = read(csv, "scale = { dir_x = -1 }\n");
  EXPECT_THAT(mended.notes, IsEmpty());
  EXPECT_EQ(mended.setups[0].readings.direction[0][3], 1);
}

TEST_F(NotesTest, DirectionsAgainstMoreMovesThanChanceAllowsAreTold) {
  // Of every three moves two go up.
  const auto scattered = [](int direction) {
    std::string csv = "x_mm,y_mm,z_mm,displacement_mm,dir_x\n0,0,0,0,1\n";
    double x = 0.0;
    for (int k = 0; k < 150; ++k) {
      x += k % 3 == 2 ? -1.0 : 2.0;
      csv += fmt::format("{0},0,0,{0},{1}\n", x, direction);
    }
    return csv;
  };
  EXPECT_THAT(read(scattered(1)).notes, IsEmpty());
  EXPECT_THAT(sentences(read(scattered(-1)).notes),
              Contains(HasSubstr("100 of 150 moves of X go against dir_x")));
}

TEST_F(NotesTest, ApproachesFromOneSideAreTaken) {
  std::string csv = "x_mm,y_mm,z_mm,displacement_mm,dir_x\n";
  for (int k = 0; k <= 100; ++k) csv += fmt::format("{0},0,0,{0},1\n", 4 * k);
  for (int k = 99; k >= 0; --k) csv += fmt::format("{0},0,0,{0}.001,1\n", 4 * k);
  EXPECT_THAT(read(csv).notes, IsEmpty());
}

TEST_F(NotesTest, TimesInMillisecondsAreTold) {
  std::string csv = "x_mm,y_mm,z_mm,displacement_mm,time_s\n";
  for (int k = 0; k < 30; ++k)
    csv += std::to_string(10 * k) + ",0,0," + std::to_string(10 * k) + "," + std::to_string(5000 * k) + "\n";
  EXPECT_THAT(sentences(read(csv).notes),
              Contains(AllOf(HasSubstr("its readings are 5000 s apart and span 1.7 days"),
                             HasSubstr("scale = { time_s = 0.001 }"))));
  EXPECT_THAT(read(csv, "scale = { time_s = 0.001 }\n").notes, IsEmpty());
}

TEST_F(NotesTest, TimesInDaysAreTold) {
  std::string csv = "x_mm,y_mm,z_mm,displacement_mm,time_s\n";
  for (int k = 0; k < 10; ++k)
    csv += std::to_string(10 * k) + ",0,0," + std::to_string(10 * k) + "," +
           std::to_string(45000.0 + k * 5.8e-5) + "\n";
  EXPECT_THAT(sentences(read(csv).notes), Contains(HasSubstr("minutes, hours or days")));
}

TEST_F(NotesTest, SetupsWithTheSameReadingsAreTold) {
  read(kLine);
  testing::spill(scratch_.path() / "copy.csv", kLine);
  const std::string second =
      "directions = \"as-recorded\"\n[[setups]]\nname = \"again\"\ninstrument = \"displacement\"\ndata = "
      "\"copy.csv\"\n"
      "direction = [1, 0, 0]\nnoise = { constant_um = 1.0 }\ndirections = \"as-recorded\"\n";
  EXPECT_THAT(sentences(read(kLine, second).notes),
              ElementsAre(HasSubstr("setups \"X\" and \"again\" hold the same readings")));
}

/// An axis that stands still and whose encoder scatters by 1 um has no direction of approach.
TEST_F(NotesTest, ScatterOfAStandingAxisIsNoApproach) {
  const Campaign campaign = read(
      "x_mm,y_mm,z_mm,displacement_mm\n0,10.0012,0,0\n50,9.9991,0,50\n100,10.0008,0,100\n50,9.9989,0,50.001\n"
      "0,10.0002,0,0\n");
  EXPECT_THAT(campaign.setups[0].readings.direction[0], ElementsAre(1, 1, 1, -1, -1));
  EXPECT_THAT(campaign.setups[0].readings.direction[1], IsEmpty());
}

/// A direction of an axis that the machine lacks is no slip of another one.
TEST_F(NotesTest, NamesOfOtherAxesAreNoSlips) {
  const Campaign campaign = read("x_mm,y_mm,z_mm,displacement_mm,dir_a\n0,0,0,0,1\n50,0,0,50,1\n");
  EXPECT_THAT(sentences(campaign.notes), ElementsAre("setup \"X\": dir_a of line.csv is not read"));
  try {
    read("Tx,y_mm,z_mm,displacement_mm,Tz\n0,0,0,0,1\n50,0,0,50,1\n", "columns = { x_mm = \"Ty\" }\n");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.remedy(), Not(HasSubstr("did you mean")));
  }
}

/// A table C turns below a displacement along X; `of_c`: further lines of [axes.C].
Campaign turned_table(const std::string& of_c, double last_deg) {
  const std::string axes =
      "[axes.X]\ntravel_mm = [0, 500]\nhome_mm = 0\n[axes.C]\ntravel_deg = [0, 360]\nhome_deg = 0\n" + of_c;
  const Machine machine = parse_machine("format = \"volcal-machine-1\"\nstructure = \"w C' b X t\"\n" + axes +
                                            "[tools.probe]\noffset_mm = [0, 0, 0]\n",
                                        "machine.toml");
  const std::string setup =
      "[[setups]]\nname = \"X\"\ninstrument = \"displacement\"\ndirection = [1, 0, 0]\n"
      "noise = { constant_um = 1.0 }\ndirections = \"as-recorded\"\n";
  const std::vector<double> x_mm{0.0, 100.0}, c_deg{0.0, last_deg};
  const std::vector<NumberColumn> columns{{"x_mm", x_mm}, {"c_deg", c_deg}, {"displacement_mm", x_mm}};
  return campaign_in_memory("format = \"volcal-campaign-1\"\n" + setup, "campaign", machine, {columns});
}

TEST(CentresOfRotation, AreNotedWhereNobodyStatesThem) {
  EXPECT_THAT(sentences(turned_table("", 90.0).notes), ElementsAre(HasSubstr("where the line of C is")));
  EXPECT_THAT(turned_table("centre_mm = [0, 0, 0]\n", 90.0).notes, IsEmpty());
  EXPECT_THAT(turned_table("", 0.0).notes, IsEmpty()) << "C stands still";
}

TEST(CentresOfRotation, AreWrittenWhereTheyWereStated) {
  EXPECT_THAT(machine_toml(turned_table("", 90.0).machine), Not(HasSubstr("centre_mm")));
  EXPECT_THAT(machine_toml(turned_table("centre_mm = [0, 0, 0]\n", 90.0).machine), HasSubstr("centre_mm"));
}

}  // namespace
}  // namespace volcal
