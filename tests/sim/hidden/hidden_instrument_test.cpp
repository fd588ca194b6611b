/// Hidden effects that act on tools, instruments and readings, by hand; each kind in a whole campaign.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string_view>

#include "volcal/sim/hidden/hidden_effects.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

Options instrument_options(const std::vector<std::pair<std::string, OptionValue>>& entries) {
  Options made;
  for (const auto& [stem, value] : entries) made.set(stem, value);
  return made;
}

std::string instrument_text(const char* value) { return value; }

/// A perfect machine of a 1 m cube, tool (0, 0, -0.1); the clock stands at 7200 s.
class HiddenInstrument : public ::testing::Test {
 protected:
  HiddenInstrument() {
    machine_.tools = {{"tool", {0.0, 0.0, -0.1}, 0.0}, {"other", {0.0, 0.0, -0.1}, 0.0}};
    environment_.channels = {{.name = "air", .start = 23.0}};
  }

  SetupPlan& plan(const std::string& instrument, double x, double y, double z) {
    plans_.resize(1);
    plans_[0].name = "S";
    plans_[0].instrument = instrument;
    plans_[0].points.resize(1);
    plans_[0].points[0].position = {x, y, z, 0, 0, 0};
    plans_[0].points[0].direction.fill(1);
    return plans_[0];
  }

  std::vector<double> read(const TruthMachine& machine, const Interference& interference) const {
    const MeasuringConditions conditions{machine, environment_, {{0, 0, -0.1}, {0, 0, -0.1}}, 3, false,
                                         false,   &interference};
    std::vector<double> last;
    for (const auto& channel : measure(plans_[0], conditions, kTime).readings.value) {
      last.push_back(channel.back());
    }
    return last;
  }

  /// Change of the last reading, by component, that a hidden effect makes.
  std::vector<double> change(const HiddenEffect& effect, double amplitude) const {
    TruthMachine machine(machine_);
    Interference interference;
    HiddenScene scene{machine, interference};
    const std::vector<double> before = read(machine, interference);
    add_hidden(effect, amplitude, {machine_, environment_, plans_}, scene);
    std::vector<double> after = read(machine, interference);
    for (std::size_t k = 0; k < after.size(); ++k) after[k] -= before[k];
    return after;
  }

  static constexpr double kTime = 7200.0;
  Machine machine_ = machine_from_code("w b X Y Z t", {{{0, 1}, {0, 1}, {0, 1}}});
  Environment environment_;
  std::vector<SetupPlan> plans_;
};

constexpr double kExact = 1e-15;
constexpr double kInstrumentSecondOrder = 1e-10;

TEST_F(HiddenInstrument, LengthScales) {
  plan("laser-tracer", 0.3, 0.4, 0.1).options.set("station", instrument_text("P1"));  // 0.5 m from the origin
  EXPECT_NEAR(change({"length-scale", {}}, 2e-6)[0], 1e-6, kExact);
  EXPECT_NEAR(change({"length-scale", instrument_options({{"station", instrument_text("P1")}})}, 2e-6)[0],
              1e-6, kExact);
  EXPECT_NEAR(change({"air-index", instrument_options({{"channel", instrument_text("air")}})}, -1e-6)[0],
              -1.5e-6, kExact);
  EXPECT_THROW(change({"length-scale", instrument_options({{"station", instrument_text("P2")}})}, 2e-6),
               InputError);
  EXPECT_THROW(change({"length-scale", instrument_options({{"setup", instrument_text("T")}})}, 2e-6),
               InputError);
}

TEST_F(HiddenInstrument, DeadPathInAir) {
  plan("laser-tracer", 0.3, 0.4, 0.1).truth.dead_path = 0.8;
  EXPECT_NEAR(change({"dead-path-air", instrument_options({{"channel", instrument_text("air")}})}, 1e-6)[0],
              0.8 * 3e-6, kExact);
  EXPECT_NEAR(change({"dead-path-air", {}}, 1e-6)[0], 0.8 * 2e-6, kExact);  // 2 h
  EXPECT_NEAR(change({"dead-path-air", instrument_options({{"dead_path", 0.2}})}, 1e-6)[0], 0.2 * 2e-6,
              kExact);
}

TEST_F(HiddenInstrument, StationsMove) {
  plan("laser-tracer", 0.3, 0.4, 0.1);  // beam (0.6, 0.8, 0)
  const Eigen::Vector3d along_y(0.0, 2.0, 0.0);
  EXPECT_NEAR(change({"station-drift", instrument_options({{"direction", along_y}})}, 5e-6)[0], -0.8 * 10e-6,
              kInstrumentSecondOrder);
  EXPECT_NEAR(
      change({"station-event", instrument_options({{"direction", along_y}, {"time", 7200.0}})}, 5e-6)[0],
      -4e-6, kInstrumentSecondOrder);
  EXPECT_EQ(
      change({"station-event", instrument_options({{"direction", along_y}, {"time", 7201.0}})}, 5e-6)[0],
      0.0);
  EXPECT_NEAR(
      change({"station-swing", instrument_options({{"direction", along_y}, {"period", 86400.0}})}, 5e-6)[0],
      -2e-6,
      kInstrumentSecondOrder);  // a twelfth of the period: half
  const Options warmed =
      instrument_options({{"direction", along_y}, {"channel", instrument_text("air")}});  // by 3 K
  EXPECT_NEAR(change({"station-expansion", warmed}, 1e-6)[0], -0.8 * 3e-6, kInstrumentSecondOrder);
  EXPECT_THROW(change({"station-drift", instrument_options({{"direction", Eigen::Vector3d(0, 0, 0)}})}, 5e-6),
               InputError);
}

TEST_F(HiddenInstrument, ToolsGrow) {
  plan("volumetric-points", 0.3, 0.4, 0.1);
  const double grown = 1.0 - std::exp(-2.0);
  EXPECT_NEAR(change({"tool-growth", instrument_options({{"time_constant", 3600.0}})}, 8e-6)[2],
              -8e-6 * grown, kExact);
  EXPECT_NEAR(change({"tool-growth-on-off", instrument_options({{"time_constant", 3600.0}, {"off", 3600.0}})},
                     8e-6)[2],
              -8e-6 * (1.0 - std::exp(-1.0)) * std::exp(-1.0), kExact);
  const Options sideways = instrument_options({{"channel", instrument_text("air")},
                                               {"direction", Eigen::Vector3d(3, 0, 0)},
                                               {"tool", instrument_text("tool")}});
  EXPECT_NEAR(change({"tool-growth-channel", sideways}, 2e-6)[0], 6e-6, kExact);
  const Options error =
      instrument_options({{"tool", instrument_text("tool")}, {"direction", Eigen::Vector3d(0, 1, 0)}});
  EXPECT_NEAR(change({"tool-offset", error}, 2e-6)[1], 2e-6, kExact);
  plans_[0].tool = 1;
  EXPECT_EQ(change({"tool-growth-channel", sideways}, 2e-6)[0], 0.0);
  EXPECT_EQ(change({"tool-offset", error}, 2e-6)[1], 0.0);
}

TEST_F(HiddenInstrument, AToolIsClampedAnewForASetup) {
  const std::string setup = plan("volumetric-points", 0.3, 0.4, 0.1).name;
  const Options clamping = instrument_options({{"setup", setup}, {"direction", Eigen::Vector3d(0, 3, 0)}});
  EXPECT_NEAR(change({"tool-clamping", clamping}, 1e-6)[1], 1e-6, kExact);
  plans_.push_back(plans_[0]);
  plans_[0].name = "S2";
  EXPECT_EQ(change({"tool-clamping", clamping}, 1e-6)[1], 0.0);
}

TEST_F(HiddenInstrument, BallBars) {
  SetupPlan& bar = plan("ball-bar", 0.65, 0.5, 0.1);
  bar.truth.centre = {0.5, 0.5, 0.0};
  EXPECT_NEAR(change({"bar-length", {}}, 3e-6)[0], 3e-6, kExact);
  bar.points[0].velocity[0] = 1.0 / 30.0;  // 2 m/min along the bar
  EXPECT_NEAR(change({"servo-mismatch", instrument_options({{"axis", instrument_text("X")}})}, 3e-6)[0],
              -6e-6, kExact);
}

TEST_F(HiddenInstrument, ABeamBesideItsPathReadsLessByTheCosine) {
  SetupPlan& line = plan("displacement", 0.0, 0.0, 0.0);
  line.points.push_back(line.points[0]);
  line.points[1].position[0] = 1.0;
  line.options.set("direction", Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(change({"beam-cosine", {}}, 1e-3)[0], std::cos(1e-3) - 1.0, kExact);
  EXPECT_NEAR(change({"beam-cosine", {}}, 1e-3)[0], -0.5e-6, 1e-12);
}

TEST_F(HiddenInstrument, TrackerEncoders) {
  plan("laser-tracker", 0.4, 0.4, 0.1);  // azimuth 45 deg, elevation 0
  const double quarter = std::numbers::pi / 4.0;
  const std::vector<double> azimuth = change({"encoder-eccentricity", {}}, 4e-6);
  EXPECT_NEAR(azimuth[1], 4e-6 * std::sin(quarter), kExact);
  EXPECT_EQ(azimuth[0], 0.0);
  EXPECT_EQ(azimuth[2], 0.0);
  const Options elevation =
      instrument_options({{"encoder", instrument_text("elevation")}, {"phase", quarter}});
  EXPECT_NEAR(change({"encoder-eccentricity", elevation}, 4e-6)[2], 4e-6 * std::sin(quarter), kExact);
}

TEST_F(HiddenInstrument, AMachineThatTiltsIsSeenFromTheFloor) {
  plan("laser-tracer", 0.5, 0.5, 1.0).truth.station = {0.5 - 1.0, 0.5,
                                                       0.9};  // beam along x, 0.4 above the pivot
  const Options by_x = instrument_options({{"by", instrument_text("X")}, {"about", instrument_text("y")}});
  // u = 0.5: 10 urad about y through (0.5, 0.5, 0.5) moves the point 0.4 m above it by +4 um in x.
  EXPECT_NEAR(change({"foundation-tilt", by_x}, 20e-6)[0], 4e-6, kInstrumentSecondOrder);
  Options at_point = by_x;
  at_point.set("pivot", Eigen::Vector3d(0.5, 0.5, 0.9));
  EXPECT_NEAR(change({"foundation-tilt", at_point}, 20e-6)[0], 0.0, kInstrumentSecondOrder);
  SetupPlan& level = plan("angle", 0.5, 0.5, 1.0);
  level.options.set("axis", Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(change({"foundation-tilt", by_x}, 20e-6)[0], 0.0);
  level.options.set("body", instrument_text("table"));
  EXPECT_NEAR(change({"foundation-tilt", by_x}, 20e-6)[0], 10e-6, kExact);
}

// ---- every kind in a campaign ----

Study every_instrument() {
  Study study;
  study.machine = reference_machines()[0];
  study.environment.channels = {
      {.name = "air", .start = 21.0, .drift = 1e-4, .amplitude = 0.4, .period = 5000.0},
      {.name = "column", .start = 22.0, .drift = 2e-4}};
  Tracking tracer;
  tracer.grid = {4, 3, 3};
  Tracking tracker = tracer;
  tracker.instrument = "laser-tracker";
  study.measurements = {{"", tracer}, {"tracker", tracker}, {"", BallBarCircles{}}, {"", Diagonals{}}};
  return study;
}

const char* any_name(const HiddenKind& kind, std::string_view key) {
  static const std::map<std::string_view, const char*> names = {
      {"about", "y"},    {"by", "Y"},        {"and", "Z"},       {"axis", "X"},
      {"axes", "X Y Z"}, {"tool", "side_x"}, {"minus", "column"}};
  if (key == "symbol") return kind.kind.starts_with("squareness") ? "EC0Y" : "EAX";
  const auto found = names.find(key);
  return found == names.end() ? "air" : found->second;
}

/// Plausible settings from the schema alone.
HiddenEffect any_effect(const HiddenKind& kind) {
  HiddenEffect effect{kind.kind, {}};
  for (const KeySchema& key : kind.keys) {
    if (!key.required) continue;
    if (key.type == KeyType::Number) {
      const bool time = key.key.ends_with("_s");
      effect.options.set(std::string(key.key.substr(0, key.key.rfind('_'))), time ? 900.0 : 0.15);
    }
    if (key.type == KeyType::Vector3) effect.options.set("direction", Eigen::Vector3d(1, 1, 0));
    if (key.type == KeyType::Text) effect.options.set(key.key, instrument_text(any_name(kind, key.key)));
  }
  return effect;
}

TEST(HiddenKinds, AreManyAndDescribed) {
  std::set<std::string> names;
  std::map<std::string, int> groups;
  for (const HiddenKind& kind : hidden_kinds()) {
    EXPECT_TRUE(names.insert(kind.kind).second) << kind.kind;
    EXPECT_FALSE(kind.formula.empty()) << kind.kind;
    ++groups[kind.group];
    for (const KeySchema& key : kind.keys) EXPECT_FALSE(key.help.empty()) << kind.kind << " " << key.key;
  }
  EXPECT_GE(groups["unlisted"], 10);
  EXPECT_EQ(groups.size(), 6U);
}

TEST(HiddenKinds, EachShowsInTheReadingsWithTheWantedSize) {
  for (const HiddenKind& kind : hidden_kinds()) {
    if (kind.group == "rotary") continue;  // hidden_rotary_test.cpp
    SCOPED_TRACE(kind.kind);
    Study study = every_instrument();
    study.hidden = {any_effect(kind)};
    study.hidden[0].rms = 0.7e-6;
    const SimulatedCampaign first = simulate(study);
    ASSERT_EQ(first.hidden.size(), 1U);
    EXPECT_NEAR(first.hidden[0].rms, 0.7e-6, 1e-12);
    EXPECT_LE(first.hidden[0].rms_within_setups, first.hidden[0].rms * (1.0 + 1e-12));
    EXPECT_GT(first.hidden[0].amplitude, 0.0);

    study.hidden[0].rms.reset();
    study.hidden[0].amplitude = first.hidden[0].amplitude;
    const SimulatedCampaign again = simulate(study);
    EXPECT_EQ(again.hidden[0].rms, first.hidden[0].rms);
    double moved = 0.0;
    for (std::size_t i = 0; i < first.campaign.setups.size(); ++i) {
      EXPECT_EQ(first.campaign.setups[i].readings.value, again.campaign.setups[i].readings.value);
      EXPECT_EQ(first.unseen.setups[i].readings.value, again.unseen.setups[i].readings.value);
      const auto& with = first.unseen.setups[i].readings.value;
      const auto& without = first.unseen_without_hidden.setups[i].readings.value;
      for (std::size_t k = 0; k < with.size(); ++k) {
        for (std::size_t row = 0; row < with[k].size(); ++row) {
          moved = std::max(moved, std::abs(with[k][row] - without[k][row]));
        }
      }
    }
    EXPECT_GT(moved, 0.1e-6);
    EXPECT_LT(moved, 100e-6);
  }
}

}  // namespace
}  // namespace volcal::sim
