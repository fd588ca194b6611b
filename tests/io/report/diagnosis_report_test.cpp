// Sections of a diagnosis' report: numbers in their JSON against numbers chosen by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/io/report/drawing.h"
#include "tests/support/hand_made_diagnosis.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

/// Two setups; figures of two drawn readings.
class DiagnosisReport : public ::testing::Test {
 protected:
  DiagnosisReport() {
    campaign_.machine.name = "VMC <1>";
    campaign_.setups.resize(2);
    campaign_.setups[0].name = "S1";
    campaign_.setups[1].name = "S2";
    DiagnosisFigures& figures = diagnosis_.figures;
    figures.leading = {.label = "reversal EXX",
                       .unit = "um",
                       .si_per_unit = 1e-6,
                       .accepted = true,
                       .slope = 4e-6,
                       .u = 0.1e-6,
                       .driver = {-2e6, 2e6},
                       .residual = {-8.5, 7.5},
                       .mean = {{-2e6, 2e6}, {-8.0, 8.0}, {0.5, 0.25}, {4, 16}}};
    DrawnObservation first;
    first.setup = 1;
    first.source_line = 17;
    first.noise = 0.5e-6;
    first.given = 2e-6;
    first.reached = -1e-6;
    first.point_w = {0.1, 0.2, 0.3};
    first.direction_w = {0.0, 0.5, 0.0};
    DrawnObservation second = first;
    second.direction_w.setZero();
    second.held_out = true;
    figures.observations = {first, second};
    figures.observation_count = 5000;
    VariableFigure time{.name = "time", .categories = {}, .drawn = {60.0, 120.0}, .given = {}, .reached = {}};
    time.given[0] = {{90.0}, {1.5e-6}, {0.25e-6}, {2}};
    time.reached[0] = {{90.0}, {0.5e-6}, {0.25e-6}, {2}};
    VariableFigure elevation{
        .name = "elevation", .categories = {}, .drawn = {0.5, -0.25}, .given = {}, .reached = {}};
    VariableFigure run = elevation, tool = elevation;
    run.name = "run";
    tool.name = "tool long";
    figures.variables = {time, elevation, run, tool};
    figures.vectors = {{{0.5, 0.25, 0.125}, {1e-6, 2e-6, 2e-6}, {0.0, 0.0, 1e-6}, 0.3e-6, 40}};
    figures.generic.variables = {"x", "time"};
    for (int d = 0; d < 4; ++d) {
      figures.generic.given.emplace_back(Eigen::MatrixXd::Zero(2, 2));
      figures.generic.reached.emplace_back(Eigen::MatrixXd::Zero(2, 2));
    }
    figures.generic.given[2](1, 0) = -6.5;
    Autocorrelation memory;
    memory.lag = {1, 2};
    memory.gap = {4.0, 8.0};
    memory.pairs = {400, 100};
    memory.residual = {0.5, 0.25};
    memory.expected = {0.5, 0.375};
    memory.whitened = {0.01, -0.02};
    figures.autocorrelation = {memory};
    document_ = Json::parse(report_json(diagnosis_, campaign_, {.date = "2024-05-17"}, &causes_));
  }

  Json page(const std::string& kind) const {
    for (const Json& each : document_.at("pages")) {
      if (each.at("kind") == kind) return each.at("data");
    }
    ADD_FAILURE() << "no page " << kind;
    return {};
  }

  Diagnosis diagnosis_ = testing::hand_made_diagnosis();
  VolumeCauses causes_ = {
      "long",
      5e-6,
      {{"straightness", false, 4e-6, std::nullopt, 0.84}, {"reversal EXX", true, 2e-6, 0.05e-6, 0.16}},
      {"dead path P1"}};
  Campaign campaign_;
  Json document_;
};

TEST_F(DiagnosisReport, EverySectionIsInTheDocumentAndHasARenderer) {
  std::ifstream file(std::filesystem::path(VOLCAL_SOURCE_DIR) / "identify/report/web/src/pages.js");
  std::ostringstream renderers;
  renderers << file.rdbuf();
  std::set<std::string> kinds;
  for (const report::DiagnosisPage& section : report::diagnosis_pages()) {
    const std::string kind(section.kind);
    EXPECT_TRUE(kinds.insert(kind).second) << kind << " is registered twice";
    EXPECT_FALSE(page(kind).empty()) << kind;
    EXPECT_THAT(renderers.str(), HasSubstr("\n  " + kind + ": render"));
  }
  EXPECT_EQ(document_.at("pages").size(), kinds.size());
  EXPECT_EQ(document_.at("title"), "VMC <1>");
}

TEST_F(DiagnosisReport, CausesOfTheVolumetricErrorAreRankedInMicrometresAndPercent) {
  const Json causes = page("volume_causes");
  EXPECT_EQ(causes.at("tool"), "long");
  EXPECT_EQ(causes.at("total_um"), 5.0);
  EXPECT_EQ(causes.at("rows").at(0).at("name"), "straightness");
  EXPECT_TRUE(causes.at("rows").at(0).at("U95_um").is_null());
  EXPECT_EQ(causes.at("rows").at(1).at("found"), true);
  EXPECT_EQ(causes.at("rows").at(1).at("rms_um"), 2.0);
  EXPECT_NEAR(causes.at("rows").at(1).at("U95_um").get<double>(), 0.098, 1e-9);
  EXPECT_EQ(causes.at("rows").at(1).at("share"), 0.16);
  EXPECT_EQ(causes.at("not_in_volume").at(0), "dead path P1");
  const Json without = Json::parse(report_json(diagnosis_, campaign_));
  for (const Json& section : without.at("pages")) EXPECT_NE(section.at("kind"), "volume_causes");
}

TEST_F(DiagnosisReport, ANamedEffectIsExplainedInPlainWords) {
  const Json story = page("story");
  const Json& missing = story.at("missing").at(0);
  EXPECT_THAT(missing.at("plain").get<std::string>(), HasSubstr("stops at two different places"));
  EXPECT_THAT(missing.at("usual_causes").get<std::string>(), HasSubstr("backlash"));
  EXPECT_FALSE(story.at("one_of").at(0).at(0).at("plain").get<std::string>().empty());
}

TEST_F(DiagnosisReport, TheStoryTellsTheErrorBeforeAndAfter) {
  const Json story = page("story");
  EXPECT_EQ(story.at("level"), "warning");
  const std::string before = story.at("before").at(0);
  EXPECT_THAT(before, HasSubstr("2.5 µm RMS"));
  EXPECT_THAT(before, HasSubstr("1.5 µm (95 %: 1.25 to 1.75 µm)"));
  const Json& missing = story.at("missing").at(0);
  EXPECT_EQ(missing.at("label"), "reversal EXX");
  EXPECT_EQ(missing.at("amplitudes").at(0).at("value"), 4.0);
  EXPECT_NEAR(missing.at("amplitudes").at(0).at("U95").get<double>(), 0.196, 1e-9);
  EXPECT_THAT(missing.at("how").get<std::string>(), HasSubstr("log-likelihood of the held-out lines +33.5"));
  EXPECT_THAT(story.at("after").at(0).get<std::string>(), HasSubstr("falls from 1.5 µm to 0 µm"));
  EXPECT_THAT(story.at("after").at(1).get<std::string>(),
              HasSubstr("x and time, along Z, as EBX, about 0.3 µm"));
  ASSERT_EQ(story.at("ladder").size(), 2U);
  EXPECT_EQ(story.at("ladder").at(1).at("systematic_high_um"), 0.5);
  const Json& below = story.at("below").at(0);
  EXPECT_EQ(below.at("effects"), 3);
  EXPECT_EQ(below.at("not_visible"), 1);
  EXPECT_EQ(below.at("smallest"), 0.5);
  EXPECT_EQ(below.at("largest"), 0.75);
}

TEST_F(DiagnosisReport, EvidenceHasItsThreshold) {
  const Json evidence = page("evidence");
  EXPECT_NEAR(evidence.at("threshold").get<double>(), -2.301, 1e-3);  // 0.5 %
  EXPECT_EQ(evidence.at("added").size(), 1U);
  const Json& sets = evidence.at("alternatives");
  ASSERT_EQ(sets.size(), 2U);
  EXPECT_EQ(sets.at(0).at(0).at("label"), "reversal EYY");
  EXPECT_EQ(sets.at(1).at(0).at("label"), "reversal EZZ");
  EXPECT_EQ(evidence.at("ranking").size(), 3U);
  EXPECT_EQ(evidence.at("ranking").at(0).at("visible_fraction"), 0.75);
}

TEST_F(DiagnosisReport, WhatIsToldApartAndWhatToMeasure) {
  const Json confounding = page("confounding");
  EXPECT_EQ(confounding.at("cosine"), (Json{Json::array(), {0.96}, {nullptr, nullptr}}));
  const Json& effects = confounding.at("effects");
  ASSERT_EQ(effects.size(), 3U);
  EXPECT_EQ(effects.at(0).at("role"), "added");
  EXPECT_EQ(effects.at(1).at("role"), "alternative");
  EXPECT_EQ(effects.at(2).at("role"), "alternative");  // of a further set
  EXPECT_EQ(effects.at(0).at("name"), "reversal:EXX:dir_x:step");
  EXPECT_TRUE(effects.at(0).at("can_be_asked").get<bool>());
  const Json& limit = effects.at(0).at("limits").at(0);
  EXPECT_EQ(limit.at("mdb"), 0.5);
  EXPECT_EQ(limit.at("mib"), 1.75);
  EXPECT_EQ(limit.at("rival"), "reversal EYY");
  const Json& proposal = confounding.at("proposals").at(0);
  EXPECT_EQ(proposal.at("separates").at(1).at("label"), "reversal EYY");
  EXPECT_NEAR(proposal.at("now").get<double>(), 1.581, 1e-9);      // square root of 2.5
  EXPECT_NEAR(proposal.at("reached").get<double>(), 2.739, 1e-9);  // of 7.5
  EXPECT_NEAR(proposal.at("plain").get<double>(), 1.768, 1e-9);    // of 3.125
  EXPECT_EQ(proposal.at("readings"), 48);
}

TEST_F(DiagnosisReport, AProposalSaysWhatIsDoneBeforeWhatItIsGoodFor) {
  MeasurementProposal& visit = diagnosis_.proposals.front();
  visit.finding.data["measurement"] = "measure P1 again after 3 h";
  visit.separates = {EffectName::of_parts("axis-coupling", "EAY", "z", "linear"),
                     EffectName::of_parts("resolution", "EYX", "x", "finer")};
  diagnosis_.confounding.names[2] = visit.separates[1];
  MeasurementProposal nothing = visit;
  nothing.action.clear();
  nothing.finding = {FindingCode::MeasurementNoneSeparates,
                     {{"effects", std::vector<std::string>{"a", "b"}}}};
  nothing.gain = std::numeric_limits<double>::infinity();
  diagnosis_.proposals.push_back(nothing);
  document_ = Json::parse(report_json(diagnosis_, campaign_));
  const Json proposals = page("confounding").at("proposals");
  EXPECT_EQ(proposals.at(0).at("what"), "Measure P1 again after 3 h");
  EXPECT_EQ(proposals.at(0).at("separates").at(0).at("label"), "axis-coupling:EAY:z:linear");
  EXPECT_EQ(proposals.at(0).at("separates").at(1).at("label"), "EYX finer");
  EXPECT_EQ(proposals.at(1).at("what"), "No candidate measurement");
  EXPECT_FALSE(proposals.at(1).at("helps").get<bool>());
  EXPECT_TRUE(proposals.at(1).at("gain").is_null());
  EXPECT_FALSE(page("confounding").at("effects").at(2).at("can_be_asked").get<bool>());
}

TEST_F(DiagnosisReport, PlotsAreInEdgeUnits) {
  const Json leading = page("added_variable");
  EXPECT_EQ(leading.at("amplitude"), 4.0);
  EXPECT_EQ(leading.at("driver"), (Json{-2.0, 2.0}));
  EXPECT_EQ(leading.at("residual"), (Json{-8.5, 7.5}));
  EXPECT_EQ(leading.at("mean").at("count"), (Json{4, 16}));
  const Json against = page("residual_variables");
  EXPECT_EQ(against.at("total"), 5000);
  EXPECT_EQ(against.at("variables").at(0).at("unit"), "min");
  EXPECT_EQ(against.at("variables").at(0).at("x"), (Json{1.0, 2.0}));
  EXPECT_EQ(against.at("variables").at(0).at("length").at("given").at("mean").at(0), 1.5);
  EXPECT_EQ(against.at("variables").at(0).at("length").at("reached").at("noise").at(0), 0.25);
  EXPECT_FALSE(against.at("variables").at(0).contains("angle"));
  const Json& elevation = against.at("variables").at(1);
  EXPECT_EQ(elevation.at("title"), "Elevation of the beam");
  EXPECT_EQ(elevation.at("unit"), "deg");
  EXPECT_NEAR(elevation.at("x").at(0).get<double>(), 28.648, 1e-9);  // 0.5 rad
  EXPECT_EQ(against.at("variables").at(2).at("title"), "Run");
  EXPECT_EQ(against.at("variables").at(3).at("title"), "Tool long");
  EXPECT_EQ(against.at("records").at("held_out"), (Json{0, 1}));
  EXPECT_EQ(against.at("records").at("reached").at(0), -1.0);
}

TEST_F(DiagnosisReport, AnAlternativeIsNotSaidToBeAdded) {
  EXPECT_FALSE(page("added_variable").at("alternative").get<bool>());
  diagnosis_.one_of = diagnosis_.effects;
  diagnosis_.effects.clear();
  document_ = Json::parse(report_json(diagnosis_, campaign_));
  EXPECT_TRUE(page("added_variable").at("alternative").get<bool>());
  diagnosis_.further_one_of = {diagnosis_.one_of};
  diagnosis_.sets.clear();
  diagnosis_.one_of = {testing::found_effect("reversal", "EYY", 1e-6)};
  document_ = Json::parse(report_json(diagnosis_, campaign_));
  EXPECT_TRUE(page("added_variable").at("alternative").get<bool>());
  EXPECT_THAT(page("story").at("after").at(0).get<std::string>(),
              HasSubstr("With reversal EXX, one of the alternatives, the systematic error"));
}

/// A reading that feels half of a displacement along Y asks for twice its residual; one that feels none is
/// not drawn.
TEST_F(DiagnosisReport, VectorsPointAlongWhatReadingsFeel) {
  const Json vectors = page("residual_vectors");
  ASSERT_EQ(vectors.at("single").size(), 1U);
  EXPECT_EQ(vectors.at("single").at(0).at("given_um"), (Json{0, 4.0, 0}));
  EXPECT_EQ(vectors.at("single").at(0).at("point_mm"), (Json{100.0, 200.0, 300.0}));
  EXPECT_EQ(vectors.at("means").at(0).at("given_um"), (Json{1.0, 2.0, 2.0}));
  EXPECT_EQ(vectors.at("means").at(0).at("readings"), 40);
}

TEST_F(DiagnosisReport, MapMemoryMdbAndNoise) {
  const Json map = page("generic_map");
  EXPECT_EQ(map.at("directions").at(2).at("name"), "Z");
  EXPECT_EQ(map.at("directions").at(2).at("given"), (Json{{0}, {-6.5, 0}}));
  const Json memory = page("autocorrelation").at("instruments").at(0);
  EXPECT_EQ(memory.at("instrument"), "laser-tracer");
  EXPECT_EQ(memory.at("band"), (Json{0.1, 0.2}));
  EXPECT_EQ(memory.at("whitened").at(1), -0.02);
  const Json detectable = page("detectable");
  EXPECT_EQ(detectable.at("not_visible"), 1);
  EXPECT_EQ(detectable.at("rows").at(1).at("mdb"), 0.75);
  EXPECT_EQ(detectable.at("rows").at(1).at("volumetric_um"), 0.375);
  EXPECT_TRUE(detectable.at("rows").at(2).at("mdb").is_null());
  EXPECT_FALSE(detectable.at("rows").at(2).at("visible").get<bool>());
  const Json noise = page("noise_model");
  EXPECT_EQ(noise.at("rows").at(1).at("value"), 0.5);
  EXPECT_EQ(noise.at("rows").at(1).at("unit"), "µm");
  EXPECT_EQ(noise.at("removed_readings"), 3);
}

/// Every section and control, without a browser; names of the user's are no markup.
TEST_F(DiagnosisReport, EverySectionDrawsItself) {
  campaign_.setups[0].name = "<i>S1</i> & 2";
  campaign_.setups[1].name = "<i>S2</i>";
  diagnosis_.figures.leading.unit = "<i>um</i>";
  VariableFigure setup{.name = "setup",
                       .categories = {"<i>S1</i> & 2", "<i>S2</i>"},
                       .drawn = {0.0, 1.0},
                       .given = {},
                       .reached = {}};
  VariableFigure temperature = diagnosis_.figures.variables.front();
  temperature.name = "T_<i>spindle</i>";
  diagnosis_.figures.variables.insert(diagnosis_.figures.variables.end(), {setup, temperature});
  for (EffectFinding& effect : diagnosis_.ranking) effect.label += " <i>x</i>";
  diagnosis_.ladder.back().added = "<i>reversal</i> EXX";
  const test::Drawing drawing = test::draw_report(report_json(diagnosis_, campaign_));
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
  EXPECT_THAT(drawing.output, ::testing::StartsWith("10 sections, "));
}

/// Five standard deviations of noise in a bin stand out, one and a half do not.
TEST_F(DiagnosisReport, ResidualsOpenOnWhatStandsOutAndElseOnTheFirstVariable) {
  VariableFigure x{.name = "x", .categories = {}, .drawn = {0.1, 0.2}, .given = {}, .reached = {}};
  x.given[0] = {{0.15}, {0.25e-6}, {0.25e-6}, {2}};
  VariableFigure z = x;
  z.name = "z";
  z.given[0] = {{0.15}, {1.25e-6}, {0.25e-6}, {2}};
  diagnosis_.figures.variables = {x, z};
  const test::Drawing on_z = test::draw_report(report_json(diagnosis_, campaign_));
  if (!on_z.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_THAT(on_z.output, HasSubstr("opens on Position Z"));
  diagnosis_.figures.variables[1].given[0].mean = {0.375e-6};
  const test::Drawing on_x = test::draw_report(report_json(diagnosis_, campaign_));
  EXPECT_EQ(on_x.exit_code, 0) << on_x.output;
  EXPECT_THAT(on_x.output, HasSubstr("opens on Position X"));
}

TEST_F(DiagnosisReport, IsOnePageWithoutMarkupInItsData) {
  if (!report_available()) GTEST_SKIP() << how_to_get_report();
  const std::string page = report_html(diagnosis_, campaign_);
  EXPECT_THAT(page, HasSubstr("VMC &lt;1&gt; – volcal diagnosis"));
  EXPECT_THAT(page, HasSubstr("VMC \\u003c1>"));
}

/// Three outliers of the diagnosis by hand, which a fit takes back unless an option says otherwise.
TEST(DiagnosisText, SaysWhichReadingsAFitWouldTakeBack) {
  Diagnosis diagnosis = testing::hand_made_diagnosis();
  EXPECT_EQ(
      removed_in_fit_text(diagnosis, "campaign.toml", "extended.toml"),
      "! the diagnosis left out 3 readings as outliers; `volcal fit` takes them back and finds other values "
      "unless it removes them, too\n"
      "next: volcal fit campaign.toml --model extended.toml --outliers remove -o RESULT\n");
  diagnosis.removed_readings.resize(1);
  EXPECT_THAT(removed_in_fit_text(diagnosis, "c", "m"), HasSubstr("left out 1 reading as outlier;"));
  diagnosis.removed_readings.clear();
  EXPECT_EQ(removed_in_fit_text(diagnosis, "c", "m"), "");
}

}  // namespace
}  // namespace volcal
