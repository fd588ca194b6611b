#include "volcal/identify/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>

#include "tests/io/report/drawing.h"
#include "tests/io/report/page_data.h"
#include "tests/io/report/synthetic_fit.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/text/fit_summary.h"
#include "volcal/identify/report/values/correlation.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/model/description/units.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using test::page_data;

std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class ReportTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fit_ = new test::SyntheticFit(test::synthetic_fit());
    document_ = new Json(Json::parse(report_json(fit_->result, fit_->campaign, {.date = "2024-05-17"})));
  }
  static void TearDownTestSuite() {
    delete document_;
    delete fit_;
  }
  static test::SyntheticFit* fit_;
  static Json* document_;
};
test::SyntheticFit* ReportTest::fit_ = nullptr;
Json* ReportTest::document_ = nullptr;

TEST_F(ReportTest, EveryRegisteredPageIsInTheDocumentAndHasARenderer) {
  const std::string renderers =
      file_text(std::filesystem::path(VOLCAL_SOURCE_DIR) / "identify/report/web/src/pages.js");
  std::set<std::string> kinds;
  for (const report::Page& page : report::pages()) {
    const std::string kind(page.kind);
    EXPECT_TRUE(kinds.insert(kind).second) << kind << " is registered twice";
    EXPECT_THAT(renderers, ::testing::HasSubstr("\n  " + kind + ": render"));
  }
  for (const char* absent : {"rotary_axes", "surfaces"}) kinds.erase(absent);  // of this machine and model
  for (const std::string& kind : kinds) EXPECT_FALSE(page_data(*document_, kind).empty()) << kind;
  EXPECT_EQ(document_->at("pages").size(), kinds.size());
}

TEST_F(ReportTest, ShowsAllEighteenFunctionsWithTheirState) {
  const Json data = page_data(*document_, "functions");
  ASSERT_EQ(data.at("functions").size(), 18u);
  for (const Json& function : data.at("functions")) {
    const std::string symbol = function.at("symbol");
    if (symbol == "EAX") {
      EXPECT_EQ(function.at("state"), "off");
      continue;
    }
    EXPECT_EQ(function.at("state"), symbol == "ECZ" ? "invisible" : "identified") << symbol;
    const std::size_t positions = function.at("position").size();
    EXPECT_GE(positions, 41u);
    EXPECT_EQ(function.at("curves").at(0).at("value").size(), positions);
    EXPECT_EQ(function.at("curves").at(0).at("U95").size(), positions);
    EXPECT_EQ(function.at("extrapolated").size(), positions);
    EXPECT_EQ(function.at("knots").size(), 9u);
  }
}

TEST_F(ReportTest, FunctionValuesAreThoseOfTheBasisInMicrometres) {
  const Json functions = page_data(*document_, "functions").at("functions");
  const Json& eyx = functions.at(1);
  ASSERT_EQ(eyx.at("symbol"), "EYX");
  const FitResult& result = fit_->result;
  const ErrorSymbol symbol{Component::Y, AxisName::X};
  const auto place = result.layout.find(symbol);
  ASSERT_TRUE(place);
  const Basis& basis = *result.layout.groups[static_cast<std::size_t>(place->group)].basis;
  const Eigen::VectorXd coefficients = result.layout.coefficients(symbol, result.parameters);
  for (const std::size_t i : {0u, 13u, 40u}) {
    const double q = eyx.at("position").at(i).get<double>() * 1e-3;
    EXPECT_NEAR(eyx.at("curves").at(0).at("value").at(i).get<double>(), basis.value(q, coefficients) * 1e6,
                1e-3);
  }
}

TEST_F(ReportTest, MarksExtrapolatedPositions) {
  const Json page = page_data(*document_, "functions");
  for (const Json& function : page.at("functions")) {
    if (function.at("state") != "identified") continue;
    const bool any =
        std::ranges::any_of(function.at("extrapolated"), [](const Json& flag) { return flag == 1; });
    EXPECT_EQ(any, function.at("axis") == "Y") << function.at("symbol");
  }
}

TEST_F(ReportTest, SquarenessIsInMicroradianWithItsEffectOverTheTravel) {
  const Json rows = page_data(*document_, "locations").at("rows");
  ASSERT_EQ(rows.size(), 4u);  // three identified, one switched off
  EXPECT_EQ(rows.at(0).at("symbol"), "EC0Y");
  EXPECT_EQ(rows.at(0).at("meaning"), "squareness of Y to X");
  EXPECT_EQ(rows.at(1).at("meaning"), "squareness of Z to Y");
  EXPECT_EQ(rows.at(2).at("meaning"), "squareness of Z to X");
  EXPECT_EQ(rows.at(3).at("state"), "off");
  const double value = rows.at(0).at("value");
  EXPECT_NEAR(value, fit_->result.parameters[fit_->result.layout.blocks[0].offset] * 1e6, 1e-2);
  EXPECT_NEAR(rows.at(0).at("over_travel_um").get<double>(), value * 0.5, 1e-2);  // urad x 0.5 m
}

TEST_F(ReportTest, SummarySaysInWordsWhatIsNotVisible) {
  const Json data = page_data(*document_, "summary");
  EXPECT_EQ(data.at("level"), "bad");
  ASSERT_EQ(data.at("invisible").size(), 1u);
  EXPECT_EQ(data.at("invisible").at(0).at("symbol"), "ECZ");
  EXPECT_EQ(data.at("invisible").at(0).at("reason"), "every tool offset lies on Z");
  EXPECT_NE(data.at("invisible").at(0).at("remedy"), "");
}

TEST_F(ReportTest, EveryWorkVolumeHasVectorsAndUncertaintyPerTool) {
  const Json data = page_data(*document_, "volume");
  ASSERT_EQ(data.at("tools").size(), 2u);
  for (const Json& tool : data.at("tools")) {
    EXPECT_EQ(tool.at("point_mm").size(), 125u);
    EXPECT_EQ(tool.at("error_um").size(), 125u);
    EXPECT_EQ(tool.at("u_um").size(), 125u);
    EXPECT_EQ(tool.at("example_um").size(), 125u);
    EXPECT_EQ(tool.at("corner_mm").size(), 8u);
    EXPECT_GT(tool.at("error_rms_um").get<double>(), tool.at("u_rms_um").get<double>());
  }
  EXPECT_EQ(data.at("named_points").size(), 3u);  // two stations, one ball-bar centre
  EXPECT_EQ(data.at("setups").size(), fit_->campaign.setups.size());
}

/// Held against places and directions drawn at random. The grid that is drawn, whose faces weigh more, is off
/// by more than is allowed.
TEST_F(ReportTest, TheSizeOfTheErrorIsThatOverTheVolume) {
  const FitResult& result = fit_->result;
  const KinematicChain chain(result.machine);
  std::mt19937_64 random(5);
  constexpr int kPlaces = 4000;
  const Json data = page_data(*document_, "volume");
  for (std::size_t t = 0; t < result.machine.tools.size(); ++t) {
    const Tool& tool = result.machine.tools[t];
    const ErrorField field(result, tool);
    std::vector<Eigen::Vector3d> points, errors;
    for (int i = 0; i < kPlaces; ++i) {
      AxisPosition position{};
      ApproachDirection direction{};
      for (const Axis& axis : result.machine.axes) {
        std::uniform_real_distribution<double> place(axis.travel_min, axis.travel_max);
        position[index_of(axis.name)] = place(random);
        direction[index_of(axis.name)] = random() % 2 == 0 ? 1 : -1;
      }
      points.push_back(chain.nominal_point_w(position, tool.offset));
      errors.emplace_back(field.at(position, direction).head<3>());
    }
    const VolumetricFigures figures = volumetric_figures(without_rigid_motion(points, errors));
    const double shown = data.at("tools").at(t).at("error_rms_um").get<double>();
    EXPECT_NEAR(shown, figures.rms / kMicro, 0.05 * figures.rms / kMicro) << tool.name;
    double squares = 0.0;
    const Json& drawn = data.at("tools").at(t).at("error_um");
    for (const Json& error : drawn) {
      for (const Json& component : error) squares += component.get<double>() * component.get<double>();
    }
    EXPECT_GT(std::sqrt(squares / static_cast<double>(drawn.size())), 1.05 * figures.rms / kMicro)
        << tool.name;
    EXPECT_GT(data.at("tools").at(t).at("error_max_um").get<double>(), 0.95 * figures.max / kMicro)
        << tool.name;
  }
}

TEST_F(ReportTest, SuspectReadingsAreListedWorstFirst) {
  const Json data = page_data(*document_, "outliers");
  EXPECT_EQ(data.at("removed"), 1);
  const Json& rows = data.at("rows");
  ASSERT_GE(rows.size(), 6u);
  EXPECT_EQ(rows.size(), data.at("suspect").get<std::size_t>());
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_GE(std::abs(rows.at(i - 1).at("w").get<double>()), std::abs(rows.at(i).at("w").get<double>()));
  }
}

/// |w| > 3.29 has a chance of 0.0010019 for one reading; 1 - (1 - 0.0010019)^1402 for any of 1,402.
TEST_F(ReportTest, ChanceOfAnySuspectIsThatOfAllReadings) {
  const Json data = page_data(*document_, "outliers");
  ASSERT_EQ(data.at("observations"), 1402);
  EXPECT_NEAR(data.at("chance").get<double>(), 0.755, 1e-9);
}

TEST(ReportSummary, CountsRemovedReadingsAmongTheSuspect) {
  test::SyntheticFit fit = test::synthetic_fit();
  for (ResidualRecord& record : fit.result.residuals) record.flagged = record.removed = false;
  fit.result.residuals[3].removed = true;
  fit.result.residuals[5].flagged = true;
  const Json document = Json::parse(report_json(fit.result, fit.campaign));
  EXPECT_EQ(page_data(document, "outliers").at("suspect"), 2);
  EXPECT_EQ(page_data(document, "summary").at("figures").at(5).at("label"), "Suspect readings");
  EXPECT_EQ(page_data(document, "summary").at("figures").at(5).at("value"), "2");
}

/// The uncertainty of another tool's error says nothing about the error shown.
TEST(ReportSummary, ErrorAndUncertaintyAreOfOneTool) {
  const test::SyntheticFit fit = test::synthetic_fit();
  const ReportOptions options;
  report::PageInput input(fit.result, fit.campaign, options);
  input.volume.assign(2, {});
  input.volume[0].tool = "worst";
  input.volume[0].error_rms = input.volume[0].error_max = 5e-6;
  input.volume[0].u_rms = 1e-6;
  input.volume[0].u_w = {{1e-6, 0.0, 0.0}};
  input.volume[1].tool = "vaguest";
  input.volume[1].error_rms = input.volume[1].error_max = 2e-6;
  input.volume[1].u_rms = 9e-6;
  input.volume[1].u_w = {{0.0, 9e-6, 0.0}};
  const report::Json figures = report::summary_page(input).at("figures");
  EXPECT_EQ(figures.at(0).at("value"), "5.0");
  EXPECT_EQ(figures.at(0).at("note"), "max 5.0 µm, tool worst");
  EXPECT_EQ(figures.at(1).at("value"), "1.00");
  EXPECT_EQ(figures.at(1).at("note"), "max 1.00 µm, tool worst");
}

TEST_F(ReportTest, HistogramHoldsEveryReading) {
  const Json histogram = page_data(*document_, "residuals").at("histogram");
  std::size_t sum = 0;
  for (const Json& count : histogram.at("count")) sum += count.get<std::size_t>();
  EXPECT_EQ(sum, fit_->result.residuals.size());
}

/// Direction of approach, temperature and length of the beam where they are recorded and change.
TEST(ReportResiduals, AreDrawnAgainstWhateverWasRecorded) {
  test::SyntheticFit fit = test::synthetic_fit();
  const auto axes = [&] {
    std::vector<std::string> names;
    const Json data = page_data(Json::parse(report_json(fit.result, fit.campaign)), "residuals");
    for (const Json& plot : data.at("plots")) names.push_back(plot.at("axis"));
    return names;
  };
  for (volcal::Setup& setup : fit.campaign.setups) {
    for (auto& direction : setup.readings.direction) direction.clear();
    setup.readings.temperature.clear();
  }
  const std::vector<std::string> before = axes();
  EXPECT_THAT(before, ::testing::Not(::testing::Contains("length")));  // made up: always the same
  EXPECT_THAT(before, ::testing::Not(::testing::Contains("dir_X")));
  Readings& readings = fit.campaign.setups[0].readings;
  for (std::size_t row = 0; row < readings.size(); ++row) {
    readings.value[0][row] = 0.5 + 1e-3 * static_cast<double>(row);
    readings.direction[0].push_back(row % 2 == 0 ? 1 : -1);
    readings.direction[1].push_back(1);
    readings.temperature["column"].push_back(20.0 + 0.01 * static_cast<double>(row));
    readings.temperature["air"].push_back(21.0);
  }
  const std::vector<std::string> after = axes();
  EXPECT_THAT(after, ::testing::Contains("dir_X"));
  EXPECT_THAT(after, ::testing::Contains("T_column"));
  EXPECT_THAT(after, ::testing::Contains("length"));
  EXPECT_THAT(after, ::testing::Not(::testing::Contains("dir_Y")));  // always the same
  EXPECT_THAT(after, ::testing::Not(::testing::Contains("T_air")));
}

/// Every reading of the first setup has twice the stated noise: its residuals are shown in the stated one,
/// the rest as they are weighted.
TEST(ReportResiduals, AreDividedByTheStatedNoiseWhereTheEstimatedOneIsLarger) {
  test::SyntheticFit fit = test::synthetic_fit();
  const Json plain = page_data(Json::parse(report_json(fit.result, fit.campaign)), "residuals");
  EXPECT_EQ(plain.at("swallowed").at("readings"), 0);
  EXPECT_FALSE(plain.at("setups").at(0).at("mean").contains("stated"));
  auto adjustment = std::make_shared<Adjustment>();
  std::size_t doubled = 0;
  for (ResidualRecord& record : fit.result.residuals) {
    adjustment->stated_sigma.push_back(record.setup == 0 ? 0.5 * record.sigma : record.sigma);
    doubled += record.setup == 0 ? 1 : 0;
  }
  fit.result.adjustment = adjustment;
  const Json data = page_data(Json::parse(report_json(fit.result, fit.campaign)), "residuals");
  EXPECT_EQ(data.at("swallowed").at("readings"), doubled);
  EXPECT_EQ(data.at("swallowed").at("groups").at(0).at("factor"), 2.0);
  const Json& records = data.at("records");
  for (std::size_t i = 0; i < records.at("setup").size(); ++i)
    EXPECT_EQ(records.at("factor").at(i).get<double>(), records.at("setup").at(i) == 0 ? 2.0 : 1.0);
  const Json& mean = data.at("setups").at(0).at("mean");
  EXPECT_NEAR(mean.at("stated").at("mean").get<double>(), 2.0 * mean.at("w").at("mean").get<double>(),
              0.01 * std::abs(mean.at("stated").at("mean").get<double>()) + 1e-6);
}

TEST_F(ReportTest, NuisanceParametersAreInTheirEdgeUnit) {
  const Json rows = page_data(*document_, "nuisance").at("rows");
  ASSERT_EQ(rows.size(), 10u);
  EXPECT_EQ(rows.at(0).at("name"), "station P1");
  EXPECT_NEAR(rows.at(0).at("guess").get<double>(), -600.0, 1e-9);
  EXPECT_TRUE(rows.at(0).at("prior_sigma").is_null());
  EXPECT_NEAR(rows.at(9).at("prior_sigma").get<double>(), 0.1, 1e-12);
  EXPECT_EQ(rows.at(9).at("weak_default_prior"), true);
}

TEST_F(ReportTest, PageHasNoUnfilledSlotAndNothingClosesTheScriptEarly) {
  if (!report_available()) GTEST_SKIP() << how_to_get_report();
  const std::string page = report_html(fit_->result, fit_->campaign, {.date = "2024-05-17"});
  EXPECT_EQ(page.find("@VOLCAL_REPORT_"), std::string::npos);
  EXPECT_NE(page.find("<title>VMC 800 &lt;x&gt; 500 &amp; 450"), std::string::npos);
  const std::string opening = "<script type=\"application/json\" id=\"volcal-data\">";
  const std::size_t start = page.find(opening);
  ASSERT_NE(start, std::string::npos);
  const std::size_t from = start + opening.size();
  const std::string data = page.substr(from, page.find("</script", from) - from);
  EXPECT_EQ(Json::parse(data), *document_);
  EXPECT_EQ(data.find('<'), std::string::npos);
}

/// Every section and control, without a browser; names of the user's are no markup.
TEST(ReportDrawing, EverySectionDrawsItself) {
  test::SyntheticFit fit = test::synthetic_fit();
  for (volcal::Setup& setup : fit.campaign.setups) {
    if (setup.options.text("station")) setup.options.set("station", "<i>" + setup.name + "</i> & P");
    setup.name = "<i>" + setup.name + "</i> & 2";
  }
  for (std::size_t k = 0; k < fit.result.setups.size(); ++k)
    fit.result.setups[k].name = fit.campaign.setups[k].name;
  for (ParameterBlock& block : fit.result.layout.blocks) {
    if (block.name == "station P1") block.name = "station <i>P1</i>";
  }
  const test::Drawing drawing = test::draw_report(report_json(fit.result, fit.campaign));
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
  EXPECT_THAT(drawing.output, ::testing::StartsWith("11 sections, "));
}

/// A machine with the name of a slot takes neither the data's place nor the title's.
TEST_F(ReportTest, NamesOfSlotsAreText) {
  if (!report_available()) GTEST_SKIP() << how_to_get_report();
  const std::string opening = "<script type=\"application/json\" id=\"volcal-data\">";
  for (const std::string name : {"@VOLCAL_REPORT_DATA@", "@VOLCAL_REPORT_TITLE@"}) {
    FitResult result = fit_->result;
    result.machine.name = name;
    const std::string page = report_html(result, fit_->campaign);
    EXPECT_NE(page.find("<title>" + name + " \u2013 volcal report</title>"), std::string::npos);
    const std::size_t from = page.find(opening) + opening.size();
    const Json data = Json::parse(page.substr(from, page.find("</script", from) - from));
    EXPECT_EQ(data.at("title"), name);
  }
}

TEST_F(ReportTest, NeedsNoNetwork) {
  if (!report_available()) GTEST_SKIP() << how_to_get_report();
  const std::string page = report_html(fit_->result, fit_->campaign);
  for (const char* loading : {"<script src", "<link rel=\"stylesheet\"", "@import", "url(http"}) {
    EXPECT_EQ(page.find(loading), std::string::npos) << loading;
  }
}

/// The page names no address but namespaces of XML, and holds nothing that could send a plot away.
TEST_F(ReportTest, NamesNoAddress) {
  if (!report_available()) GTEST_SKIP() << how_to_get_report();
  const std::string page = report_html(fit_->result, fit_->campaign);
  for (const std::string scheme : {"http://", "https://", "ws://", "wss://"}) {
    for (std::size_t at = page.find(scheme); at != std::string::npos; at = page.find(scheme, at + 1)) {
      EXPECT_EQ(page.compare(at + scheme.size(), 11, "www.w3.org/"), 0) << page.substr(at, 80);
    }
  }
  for (const char* cloud : {"Plotly Cloud", "plotly-cloud", "cloud.plotly", "cdn.plot.ly"})
    EXPECT_EQ(page.find(cloud), std::string::npos) << cloud;
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST_F(ReportTest, ItsHeadSaysWhatMadeIt) {
  const Provenance provenance{"9.8.7", "2024-05-17T10:00:00Z", "volcal fit c.toml -o r"};
  FitResult result = fit_->result;
  result.provenance = provenance;
  const Json page =
      Json::parse(report_json(result, fit_->campaign, {.date = "2024-05-17", .provenance = provenance}));
  EXPECT_EQ(page.at("version"), "9.8.7");
  EXPECT_EQ(page.at("command"), "volcal fit c.toml -o r");
  const Json facts = page_data(page, "summary").at("facts");
  EXPECT_THAT(facts, ::testing::Contains(Json({"Identified by", "volcal 9.8.7, 2024-05-17T10:00:00Z"})));
  EXPECT_THAT(facts, ::testing::Contains(Json({"Command", "volcal fit c.toml -o r"})));
}

/// Z was parked between the table's positions: nothing of its errors was measured where the table looks.
TEST(FitSummary, AnAxisParkedOffTheGridHasNoValuesButItsUnits) {
  test::SyntheticFit fit = test::synthetic_fit();
  for (FunctionSummary& function : fit.result.functions) {
    if (function.symbol.axis == AxisName::Z) function.measured_min = function.measured_max = -0.12345;
  }
  const std::string text = fit_text(fit.result, fit.campaign);
  EXPECT_THAT(text, ::testing::ContainsRegex("ECZ +urad +- +- +0\\.00 +- .*NOT VISIBLE"));
  EXPECT_THAT(text, ::testing::ContainsRegex("EXZ +um +- +- +0\\.59 +- "));
  EXPECT_THAT(text, ::testing::ContainsRegex("EAY +urad +-?[0-9.]+ +[0-9.]+ +0\\.59 +[0-9.]+ "));
}

/// A tracker whose every channel is suspect: a length, an azimuth, an elevation.
TEST(ReportOfATracker, ReadingsHaveTheUnitOfTheirChannel) {
  test::SyntheticFit fit = test::synthetic_fit();
  volcal::Setup& tracker = fit.campaign.setups[0];
  tracker.instrument = "laser-tracker";
  tracker.readings.value.resize(3, tracker.readings.value[0]);
  const ResidualRecord first = fit.result.residuals.front();
  fit.result.residuals.assign(3, first);
  for (int channel = 0; channel < 3; ++channel) {
    ResidualRecord& record = fit.result.residuals[static_cast<std::size_t>(channel)];
    record.channel = channel;
    record.w = 9.0 - channel;
    record.flagged = true;
  }
  const Json document = Json::parse(report_json(fit.result, fit.campaign));
  const Json rows = page_data(document, "outliers").at("rows");
  const std::string summary = fit_text(fit.result, fit.campaign);
  for (const int channel : {0, 1, 2}) {
    const auto k = static_cast<std::size_t>(channel);
    EXPECT_EQ(rows.at(k).at("unit"), channel == 0 ? "µm" : "µrad");
    EXPECT_EQ(page_data(document, "residuals").at("records").at("angle").at(k), channel == 0 ? 0 : 1);
    EXPECT_THAT(summary, ::testing::ContainsRegex((channel == 0 ? " um +" : " urad +") +
                                                  std::to_string(9 - channel) + "\\.0 "));
  }
}

TEST(ReportSize, DoesNotGrowWithTheNumberOfReadings) {
  const test::SyntheticFit small = test::synthetic_fit(10);
  const test::SyntheticFit large = test::synthetic_fit(200);
  ASSERT_GT(large.result.residuals.size(), 200'000u);
  const std::string small_json = report_json(small.result, small.campaign);
  const std::string large_json = report_json(large.result, large.campaign);
  // Only the list of suspect readings, which has its own bound, is longer.
  EXPECT_LT(static_cast<double>(large_json.size()), 1.25 * static_cast<double>(small_json.size()));
  EXPECT_LT(large_json.size(), 1'500'000u);
}

TEST(ResidualSample, KeepsFlaggedAndWorstAndIsRepeatable) {
  const test::SyntheticFit fit = test::synthetic_fit(10);
  const auto& residuals = fit.result.residuals;
  const auto sample = report::residual_sample(residuals, 2000);
  ASSERT_EQ(sample.size(), 2000u);
  EXPECT_TRUE(std::ranges::is_sorted(sample));
  EXPECT_EQ(sample, report::residual_sample(residuals, 2000));
  const std::set<std::size_t> chosen(sample.begin(), sample.end());
  EXPECT_EQ(chosen.size(), sample.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals[i].flagged || residuals[i].removed) {
      EXPECT_TRUE(chosen.contains(i)) << i;
    }
  }
  EXPECT_EQ(report::residual_sample(residuals, residuals.size()).size(), residuals.size());
}

TEST(ErrorCorrelation, OfTwoScalarsIsTheAbsoluteCorrelation) {
  const FitResult result = test::synthetic_fit().result;
  const report::ErrorCorrelation correlation = report::error_correlation(result);
  ASSERT_EQ(correlation.errors.size(), 20u);  // 17 functions, 3 squareness errors
  const auto& blocks = result.layout.blocks;
  const double expected = std::abs(result.covariance(blocks[0].offset, blocks[1].offset)) /
                          std::sqrt(result.covariance(blocks[0].offset, blocks[0].offset) *
                                    result.covariance(blocks[1].offset, blocks[1].offset));
  EXPECT_NEAR(correlation.value(17, 18), expected, 1e-12);
}

/// Two functions that are straight lines between values at both ends of the travel. With the samples t = 0,
/// .1
/// ... 1 the rows (1 - t, t) have M = R^T R = [3.85 1.65; 1.65 3.85]. Own covariances are unit matrices, and
/// the values at the start alone correlate, by .6: tr(S_fg S_gf) = .36 * 3.85^2 = 5.3361,
/// tr(S_ff^2) = |M|^2 = 35.09; sqrt(5.3361 / 35.09) = .389960.
TEST(ErrorCorrelation, OfTwoFunctionsByHand) {
  FitResult result;
  Axis axis;
  axis.name = AxisName::X;
  axis.travel_max = 1.0;
  result.machine.axes = {axis};
  FunctionSpec line;
  line.degree = 1;
  line.knots = KnotChoice::Explicit;
  line.breakpoints = {0.0, 1.0};
  FunctionGroup group;
  group.axis = AxisName::X;
  group.basis = find_basis("bspline")->make(line, axis);
  group.symbols = {{Component::X, AxisName::X}, {Component::Y, AxisName::X}};
  ASSERT_LT((group.basis->row(0.3) - Eigen::Vector2d(0.7, 0.3)).norm(), 1e-15);
  result.covariance = Eigen::MatrixXd::Identity(4, 4);
  const int f = group.index(0, 0), g = group.index(0, 1);
  result.covariance(f, g) = result.covariance(g, f) = 0.6;
  result.layout.groups = {group};
  result.layout.size = result.layout.function_size = 4;
  const report::ErrorCorrelation correlation = report::error_correlation(result);
  ASSERT_EQ(correlation.errors.size(), 2u);
  EXPECT_NEAR(correlation.value(0, 1), 0.389960, 1e-6);
  EXPECT_EQ(correlation.value(0, 1), correlation.value(1, 0));
  EXPECT_EQ(correlation.value(0, 0), 1.0);
}

}  // namespace
}  // namespace volcal
