/// [[hidden]] tables and sealed noise of a study, and what is written of them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/studies/files/hidden_answer_writer.h"
#include "volcal/studies/files/simulation_writer.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal {
namespace {

const std::string kHiddenHead = "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\n";
const std::string kAir = "[[temperatures]]\nchannel = \"air\"\nstart_degC = 21.0\ndrift_K_per_hour = 0.5\n";
const std::string kTracer = R"([[measurements]]
kind = "laser-tracer"
grid = [4, 3, 3]
revisits = 1
shuffled = true
noise = { constant_um = 0.3, wander_um = 0.4, wander_time_s = 500.0, line_um = 0.2, outlier_share = 0.02, outlier_sigma = 9.0 }
)";

sim::Study parse_hidden(const std::string& body) {
  return parse_study(kHiddenHead + body, "study.toml", sim::reference_machines()[0]);
}

TEST(HiddenStudy, ReadsEffectsInSi) {
  const sim::Study study = parse_hidden(kAir + kTracer + R"([[hidden]]
kind = "screw-lead"
symbol = "EXX"
period_mm = 10
phase_deg = 90.0
amplitude_um = 2.0
[[hidden]]
kind = "station-drift"
station = "P1"
direction = [0, 0, 1]
rms_um = 0.5
[[hidden]]
kind = "scale-expansion"
axis = "Y"
channel = "air"
amplitude_um_per_m_K = 8.0
[[hidden]]
kind = "cross-axis"
symbol = "EAY"
by = "Z"
power = 2
amplitude_urad = 4.0
)");
  ASSERT_EQ(study.hidden.size(), 4U);
  EXPECT_EQ(study.hidden[0].kind, "screw-lead");
  EXPECT_DOUBLE_EQ(*study.hidden[0].options.number("period"), 0.01);
  EXPECT_NEAR(*study.hidden[0].options.number("phase"), 1.5707963267948966, 1e-15);
  EXPECT_DOUBLE_EQ(*study.hidden[0].amplitude, 2e-6);
  EXPECT_FALSE(study.hidden[0].rms.has_value());
  EXPECT_DOUBLE_EQ(*study.hidden[1].rms, 0.5e-6);
  EXPECT_FALSE(study.hidden[1].amplitude.has_value());
  EXPECT_DOUBLE_EQ(*study.hidden[2].amplitude, 8e-6);
  EXPECT_DOUBLE_EQ(*study.hidden[3].amplitude, 4e-6);
  EXPECT_EQ(*study.hidden[3].options.number("power"), 2.0);
  const sim::Measurement& measurement = study.measurements[0];
  EXPECT_TRUE(measurement.shuffled);
  const auto& tracer = std::get<sim::Tracking>(measurement.settings);
  EXPECT_EQ(tracer.revisits, 1);
  EXPECT_DOUBLE_EQ(tracer.noise.drift, 0.4e-6);
  EXPECT_EQ(tracer.noise.drift_time, 500.0);
  EXPECT_DOUBLE_EQ(tracer.noise.line, 0.2e-6);
  EXPECT_EQ(tracer.noise.outlier_share, 0.02);
  EXPECT_EQ(tracer.noise.outlier_size, 9.0);
  EXPECT_EQ(sim::simulate(study).campaign.setups.size(), 16U);
}

TEST(HiddenStudy, ReadsFeedAndAngularNoise) {
  const sim::Study study = parse_hidden(R"(unseen = true
[[measurements]]
kind = "ball-bar-circles"
feed_mm_min = 3000.0
record_feed = true
[[measurements]]
kind = "angle-lines"
noise = { constant_urad = 0.4, wander_urad = 0.3, line_urad = 0.2 }
)");
  EXPECT_TRUE(study.unseen);
  const auto& circles = std::get<sim::BallBarCircles>(study.measurements[0].settings);
  EXPECT_DOUBLE_EQ(circles.feed, 0.05);
  const auto& angles = std::get<sim::AngleLines>(study.measurements[1].settings);
  EXPECT_DOUBLE_EQ(angles.noise.drift, 0.3e-6);
  EXPECT_DOUBLE_EQ(angles.noise.line, 0.2e-6);
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  for (const double feed : simulated.campaign.setups[0].readings.feed) EXPECT_NEAR(feed, 0.05, 1e-12);
  EXPECT_TRUE(simulated.campaign.setups.back().readings.feed.empty());
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(HiddenStudy, SealsTheAnswerBesideUnseenReadings) {
  const testing::ScratchFolder scratch;
  const sim::SimulatedCampaign simulated = sim::simulate(parse_hidden(kAir + kTracer + R"([[hidden]]
kind = "thermal-tilt"
symbol = "EAZ"
channel = "air"
rms_um = 1.5
[[hidden]]
kind = "tool-offset"
tool = "side_x"
direction = [1, 0, 0]
amplitude_um = 3.0
)"));
  AtomicFolder folder((scratch.path() / "out").string());
  write_simulation(simulated, folder);
  folder.commit();
  const std::filesystem::path truth = scratch.path() / "out/truth";
  const auto json = nlohmann::json::parse(content(truth / "hidden.json"));
  EXPECT_EQ(json["format"], "volcal-hidden-1");
  ASSERT_EQ(json["effects"].size(), 2U);
  EXPECT_EQ(json["effects"][0]["kind"], "thermal-tilt");
  EXPECT_EQ(json["effects"][0]["symbol"], "EAZ");
  EXPECT_EQ(json["effects"][0]["unit"], "urad");
  EXPECT_EQ(json["effects"][0]["per"], "K");
  EXPECT_NEAR(json["effects"][0]["rms_um"].get<double>(), 1.5, 1e-5);
  EXPECT_EQ(json["effects"][1]["amplitude"], 3.0);
  EXPECT_EQ(json["effects"][1]["direction"], nlohmann::json({1.0, 0.0, 0.0}));
  EXPECT_EQ(json["noise"].size(), 16U);
  EXPECT_EQ(json["noise"][0]["wander_um"], 0.4);
  ASSERT_EQ(json["outliers"].size(), simulated.outliers.size());
  EXPECT_GT(simulated.outliers.size(), 0U);
  EXPECT_EQ(json["outliers"][0]["row"], simulated.outliers[0].row + 2);

  // Nothing of it in what the user gets.
  const std::string campaign = content(scratch.path() / "out/campaign.toml");
  for (const char* word : {"hidden", "wander", "line_um", "outlier", "tilt"}) {
    EXPECT_EQ(campaign.find(word), std::string::npos) << word;
  }
  const Campaign unseen = read_campaign((truth / "unseen/campaign.toml").string());
  const Campaign without = read_campaign((truth / "unseen_without_hidden/campaign.toml").string());
  ASSERT_EQ(unseen.setups.size(), 16U);
  double largest = 0.0;
  for (std::size_t i = 0; i < unseen.setups.size(); ++i) {
    const Readings& seen = simulated.campaign.setups[i].readings;
    const Readings& other = unseen.setups[i].readings;
    EXPECT_EQ(unseen.setups[i].name, simulated.campaign.setups[i].name);
    ASSERT_EQ(other.size(), seen.size());
    EXPECT_NEAR(other.time.front(), seen.time.front(), 1e-4);
    EXPECT_NEAR(other.time.back(), seen.time.back(), 1e-4);
    EXPECT_NE(other.position[0], seen.position[0]);
    for (std::size_t row = 0; row < other.size(); ++row) {
      largest = std::max(largest, std::abs(other.value[0][row] - without.setups[i].readings.value[0][row]));
    }
  }
  EXPECT_GT(largest, 1e-6);
  EXPECT_LT(largest, 20e-6);
}

TEST(HiddenStudy, WritesNoAnswerUnlessAskedFor) {
  const testing::ScratchFolder scratch;
  for (const bool asked : {false, true}) {
    sim::Study study = parse_hidden(kTracer);
    study.unseen = asked;
    AtomicFolder folder((scratch.path() / "out").string());
    write_simulation(sim::simulate(study), folder);
    folder.commit();
    EXPECT_EQ(std::filesystem::exists(scratch.path() / "out/truth/hidden.json"), asked);
    EXPECT_EQ(std::filesystem::exists(scratch.path() / "out/truth/unseen/campaign.toml"), asked);
  }
}

TEST(HiddenStudy, GuideListsEveryKindWithItsKeys) {
  const std::string guide = content(std::string(VOLCAL_SOURCE_DIR) + "/docs/hidden-effects.md");
  for (const sim::HiddenKind& kind : sim::hidden_kinds()) {
    const std::size_t begin = guide.find("| `" + kind.kind + "` |");
    ASSERT_NE(begin, std::string::npos) << kind.kind;
    const std::string row = guide.substr(begin, guide.find('\n', begin) - begin);
    for (const KeySchema& key : kind.keys) {
      EXPECT_NE(row.find("`" + key.key + "`"), std::string::npos) << kind.kind << " " << key.key;
    }
    EXPECT_NE(row.find(kind.unit), std::string::npos) << kind.kind;
  }
}

struct BadEffect {
  std::string body;
  int line;              ///< that the message names, the table starting at line 6
  std::string expected;  ///< in the message
};

class BadHiddenTables : public ::testing::TestWithParam<BadEffect> {};

TEST_P(BadHiddenTables, NameLineAndProblem) {
  const std::string measurement = "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [2, 2, 2]\n";
  try {
    sim::simulate(parse_hidden(measurement + "[[hidden]]\n" + GetParam().body));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, "study.toml");
    EXPECT_EQ(error.place().line, GetParam().line) << error.what();
    EXPECT_NE(std::string(error.what()).find(GetParam().expected), std::string::npos) << error.what();
    EXPECT_FALSE(error.remedy().empty());
  }
}

INSTANTIATE_TEST_SUITE_P(
    HiddenStudy, BadHiddenTables,
    ::testing::Values(
        BadEffect{"symbol = \"EXX\"\n", 6, "kind"}, BadEffect{"kind = \"reversl\"\n", 7, "reversl"},
        BadEffect{"kind = \"reversal\"\namplitude_um = 1\n", 6, "symbol"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXX\"\n", 6, "amplitude_um"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXX\"\namplitude_urad = 1\n", 9, "amplitude_um"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EAX\"\namplitude_um = 1\n", 9, "amplitude_urad"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXX\"\namplitude_um = 1\nrms_um = 1\n", 10, "both"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXX\"\nrms_um = -1\n", 9, "rms_um"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXX\"\namplitude_um = 1\nperiod_mm = 1\n", 10,
                  "period_mm"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXW\"\namplitude_um = 1\n", 6, "EXW"},
        BadEffect{"kind = \"reversal\"\nsymbol = \"EXC\"\namplitude_um = 1\n", 6, "EXC"},
        BadEffect{"kind = \"screw-lead\"\nsymbol = \"EXX\"\namplitude_um = 1\nperiod_m = 1\n", 10,
                  "period_mm"},
        BadEffect{"kind = \"screw-lead\"\nsymbol = \"EXX\"\namplitude_um = 1\nperiod_mm = -1\n", 6, "period"},
        BadEffect{"kind = \"scale-expansion\"\naxis = \"X\"\nchannel = \"oil\"\namplitude_um_per_m_K = 1\n",
                  6, "oil"},
        BadEffect{"kind = \"scale-expansion\"\naxis = \"Q\"\nchannel = \"oil\"\namplitude_um_per_m_K = 1\n",
                  8, "Q"},
        BadEffect{"kind = \"station-drift\"\ndirection = [1, 0, 0]\nstation = \"P9\"\namplitude_um = 1\n", 6,
                  "P9"},
        BadEffect{"kind = \"tool-offset\"\ndirection = [1, 0, 0]\ntool = \"long\"\namplitude_um = 1\n", 6,
                  "long"},
        BadEffect{"kind = \"bar-length\"\nrms_um = 1\n", 6, "no effect on these readings"}));

TEST(SealedNoise, NumbersAreChecked) {
  const auto message = [](const std::string& noise) -> std::string {
    try {
      parse_hidden("[[measurements]]\nkind = \"diagonals\"\nnoise = { " + noise + " }\n");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("wander_um = -1").find("wander_um"), std::string::npos);
  EXPECT_NE(message("wander_time_s = 0").find("wander_time_s"), std::string::npos);
  EXPECT_NE(message("outlier_share = 0.6").find("outlier_share"), std::string::npos);
  EXPECT_NE(message("line_urad = 1").find("line_urad"), std::string::npos);
  EXPECT_EQ(message("line_um = 1"), "");
}

}  // namespace
}  // namespace volcal
