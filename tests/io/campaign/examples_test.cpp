/// The five campaigns of datasets/examples, written by a separate program, as they must be understood.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"

namespace volcal {
namespace {

const std::string kExamples = std::string(VOLCAL_SOURCE_DIR) + "/datasets/examples/";
const std::string kSmallExample = std::string(VOLCAL_SOURCE_DIR) + "/tests/data/small/";

TEST(Examples, StructureCampaignsHoldEightTracerRuns) {
  for (const std::string name : {"structure-0", "structure-1", "structure-2", "structure-3"}) {
    const Campaign campaign = read_campaign(kExamples + name + "/campaign.toml");
    EXPECT_EQ(campaign.setups.size(), 8U) << name;
    EXPECT_EQ(campaign.reading_count(), 6048U) << name;
    std::set<std::string> stations;
    for (const volcal::Setup& setup : campaign.setups) {
      stations.insert(setup.options.text("station").value());
      EXPECT_DOUBLE_EQ(setup.repeatability, 0.6e-6);
      EXPECT_DOUBLE_EQ(setup.noise.number("constant").value(), 0.25e-6);
      EXPECT_DOUBLE_EQ(setup.noise.number("per_metre").value(), 0.3e-6);
    }
    EXPECT_EQ(stations.size(), 4U) << name;
    const ModelSpec model = read_model(kExamples + name + "/model.toml", campaign.machine);
    EXPECT_EQ(model.default_function.basis, "bspline");
    EXPECT_EQ(model.default_function.knots, KnotChoice::Automatic);
  }
}

TEST(Examples, ReadingsAreInSi) {
  const Campaign campaign = read_campaign(kExamples + "structure-0/campaign.toml");
  const volcal::Setup& setup = campaign.setups[0];
  const Readings& readings = setup.readings;
  EXPECT_TRUE(setup.options.vector("station")->isApprox(Eigen::Vector3d(-0.2518, -0.1261, -0.0635), 1e-12));
  EXPECT_EQ(campaign.machine.tools[setup.tool].name, "short");
  EXPECT_DOUBLE_EQ(readings.position[0][1], 0.081359);
  EXPECT_DOUBLE_EQ(readings.value[0][1], 0.035527560);
  EXPECT_DOUBLE_EQ(readings.time[1], 4.0);
  EXPECT_DOUBLE_EQ(readings.temperature.at("air")[1], 19.366);
  EXPECT_EQ(readings.temperature.size(), 4U);
  EXPECT_EQ(readings.direction[0][1], 1);
  EXPECT_EQ(readings.source_line[1], 3);
  EXPECT_TRUE(readings.position[3].empty());
}

TEST(Examples, MixedCampaignHasFiveInstruments) {
  const Campaign campaign = read_campaign(kExamples + "mixed-1/campaign.toml");
  std::map<std::string, int> count;
  for (const volcal::Setup& setup : campaign.setups) ++count[setup.instrument];
  const std::map<std::string, int> expected = {
      {"angle", 9}, {"ball-bar", 6}, {"displacement", 13}, {"laser-tracer", 2}, {"straightness", 18}};
  EXPECT_EQ(count, expected);
}

TEST(Examples, TruthIsReadAsPoints) {
  const Campaign campaign = read_campaign(kExamples + "mixed-1/truth/campaign.toml");
  ASSERT_EQ(campaign.setups.size(), 1U);
  EXPECT_EQ(campaign.setups[0].readings.channels(), 3U);
  EXPECT_DOUBLE_EQ(campaign.setups[0].readings.value[1][0], -9.287564e-6);
}

/// Headers of its own, semicolons, decimal commas, text cells, a preamble, millimetres where um are expected.
TEST(InstrumentFile, IsReadAsTheInstrumentWroteIt) {
  const Campaign campaign = read_campaign(kSmallExample + "campaign.toml");
  const Readings& readings = campaign.setups[4].readings;
  ASSERT_EQ(readings.size(), 12U);
  EXPECT_DOUBLE_EQ(readings.position[0][0], 0.050);
  EXPECT_DOUBLE_EQ(readings.position[2][0], -0.250);
  EXPECT_DOUBLE_EQ(readings.value[0][0], 0.02782 * 1000.0 * 1e-6);
  EXPECT_DOUBLE_EQ(readings.sigma[0], 1.2e-6);
  EXPECT_EQ(readings.source_line[0], 5);
}

TEST(SmallModel, IsUnderstood) {
  const Campaign campaign = read_campaign_description(kSmallExample + "campaign.toml");
  const ModelSpec model = read_model(kSmallExample + "model.toml", campaign.machine);
  const auto function = [&](const char* symbol) { return model.function(*ErrorSymbol::parse(symbol)); };
  EXPECT_EQ(function("EXX").degree, 2);
  EXPECT_EQ(function("EXX").intervals, 4);
  EXPECT_THAT(function("EYX").breakpoints,
              ::testing::Pointwise(::testing::DoubleEq(), {0.0, 0.1, 0.25, 0.5}));
  EXPECT_EQ(function("EAX").basis, "zero");
  EXPECT_EQ(function("EBX").basis, "legendre");
  EXPECT_EQ(function("EBX").degree, 4);
  EXPECT_EQ(function("ECZ").knots, KnotChoice::Automatic);
  ASSERT_EQ(model.locations_off.size(), 1U);
  EXPECT_EQ(model.locations_off[0].name(), "EC0Y");
  ASSERT_EQ(model.effects.size(), 1U);
  EXPECT_EQ(model.effects[0].options.text("symbol"), "EXX");
  EXPECT_TRUE(campaign.setups[0].readings.source_line.empty());
}

/// The setup's own repeatability and noise go before the campaign's.
TEST(Noise, IsInheritedFromTheCampaign) {
  const Machine machine = read_campaign_description(kSmallExample + "campaign.toml").machine;
  const std::string text =
      "format = \"volcal-campaign-1\"\nmachine = \"m\"\n[noise]\nconstant_um = 2\nconstant_urad = 3\n"
      "repeatability_um = 0.7\n"
      "[[setups]]\nname = \"a\"\ninstrument = \"displacement\"\ndata = \"a.csv\"\ntool = \"none\"\n"
      "[[setups]]\nname = \"b\"\ninstrument = \"angle\"\ndata = \"b.csv\"\ntool = \"none\"\naxis = [1, 0, "
      "0]\n"
      "[[setups]]\nname = \"c\"\ninstrument = \"displacement\"\ndata = \"c.csv\"\ntool = \"none\"\n"
      "noise = { per_metre_um = 1 }\nrepeatability_um = 0\n";
  const Campaign campaign = parse_campaign_description(text, "c.toml", machine);
  EXPECT_DOUBLE_EQ(campaign.setups[0].noise.number("constant").value(), 2e-6);
  EXPECT_DOUBLE_EQ(campaign.setups[0].repeatability, 0.7e-6);
  EXPECT_DOUBLE_EQ(campaign.setups[1].noise.number("constant").value(), 3e-6);
  EXPECT_FALSE(campaign.setups[2].noise.has("constant"));
  EXPECT_DOUBLE_EQ(campaign.setups[2].noise.number("per_metre").value(), 1e-6);
  EXPECT_DOUBLE_EQ(campaign.setups[2].repeatability, 0.0);
}

}  // namespace
}  // namespace volcal
