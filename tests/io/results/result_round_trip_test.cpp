#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "tests/support/broken_campaigns.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/io/results/result_json.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kSmall = std::string(VOLCAL_SOURCE_DIR) + "/tests/data/small/";

Campaign small_campaign() { return read_campaign(kSmall + "campaign.toml"); }

/// A fit of the small campaign: too few readings for 21 errors, and so every part of a result occurs.
const FitResult& small_result() {
  static const FitResult result = [] {
    static const Campaign campaign = small_campaign();
    return fit(campaign, read_model(kSmall + "model.toml", campaign.machine));
  }();
  return result;
}

void expect_same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const bool both_nan = std::isnan(a.data()[i]) && std::isnan(b.data()[i]);
    ASSERT_TRUE(both_nan || a.data()[i] == b.data()[i]) << "entry " << i;
  }
}

void expect_same_function(const FunctionSpec& a, const FunctionSpec& b) {
  EXPECT_EQ(a.basis, b.basis);
  EXPECT_EQ(a.degree, b.degree);
  EXPECT_EQ(a.knots, b.knots);
  EXPECT_EQ(a.intervals, b.intervals);
  EXPECT_EQ(a.breakpoints, b.breakpoints);
  EXPECT_EQ(a.coefficients, b.coefficients);
}

/// What a version without codes wrote.
std::string without_codes(const FitResult& result) {
  auto json = nlohmann::ordered_json::parse(result_json(result));
  json.erase("findings");
  json["rank"].erase("invisible_findings");
  json["rank"].erase("held_by_prior_findings");
  for (auto& error : json["rank"]["errors"]) error.erase("finding");
  return json.dump(1);
}

TEST(ResultJson, ReadsSentencesWithoutCodesAsTheyAre) {
  const FitResult& written = small_result();
  ASSERT_FALSE(written.findings.empty());
  ASSERT_FALSE(written.rank.invisible.empty());
  const FitResult read = result_from_json(without_codes(written), "result.json");
  for (const Finding& finding : read.findings) EXPECT_EQ(finding.code, FindingCode::Verbatim);
  EXPECT_EQ(sentences(read.findings), sentences(written.findings));
  EXPECT_EQ(sentences(read.rank.invisible), sentences(written.rank.invisible));
  EXPECT_EQ(sentences(read.rank.held_by_prior), sentences(written.rank.held_by_prior));
  ASSERT_EQ(read.rank.errors.size(), written.rank.errors.size());
  for (std::size_t i = 0; i < read.rank.errors.size(); ++i) {
    const Explanation now = explanation(read.rank.errors[i].cause);
    const Explanation before = explanation(written.rank.errors[i].cause);
    EXPECT_EQ(now.reason, before.reason);
    EXPECT_EQ(now.remedy, before.remedy);
  }
  const FitResult again = result_from_json(result_json(read), "result.json");
  EXPECT_EQ(again.findings, read.findings);
  EXPECT_EQ(again.rank.invisible, read.rank.invisible);
}

TEST(ResultJson, RefusesFindingsThatAreNotThoseOfTheMessages) {
  auto json = nlohmann::ordered_json::parse(result_json(small_result()));
  json["findings"].erase(0);
  EXPECT_THROW(result_from_json(json.dump(), "result.json"), InputError);
}

TEST(ResultJson, ReturnsEveryBit) {
  const FitResult& written = small_result();
  const FitResult read = result_from_json(result_json(written), "result.json");
  expect_same_bits(read.parameters, written.parameters);
  expect_same_bits(read.covariance, written.covariance.selfadjointView<Eigen::Lower>());
  EXPECT_EQ(read.status, written.status);
  EXPECT_EQ(read.findings, written.findings);
  EXPECT_EQ(read.rank.invisible, written.rank.invisible);
  EXPECT_EQ(read.rank.held_by_prior, written.rank.held_by_prior);
  ASSERT_EQ(read.rank.errors.size(), written.rank.errors.size());
  for (std::size_t i = 0; i < read.rank.errors.size(); ++i)
    EXPECT_EQ(read.rank.errors[i].cause, written.rank.errors[i].cause);
  EXPECT_EQ(read.sigma0, written.sigma0);
  EXPECT_EQ(read.dof, written.dof);
  EXPECT_EQ(read.layout.size, written.layout.size);
  EXPECT_EQ(read.layout.symbols(), written.layout.symbols());
  ASSERT_EQ(read.layout.blocks.size(), written.layout.blocks.size());
  for (std::size_t i = 0; i < read.layout.blocks.size(); ++i) {
    EXPECT_EQ(read.layout.blocks[i].name, written.layout.blocks[i].name);
    expect_same_bits(read.layout.blocks[i].guess, written.layout.blocks[i].guess);
    expect_same_bits(read.layout.blocks[i].prior_sigma, written.layout.blocks[i].prior_sigma);
    EXPECT_EQ(read.layout.blocks[i].location, written.layout.blocks[i].location);
  }
  ASSERT_EQ(read.functions.size(), written.functions.size());
  for (std::size_t i = 0; i < read.functions.size(); ++i) {
    EXPECT_EQ(read.functions[i].prior, written.functions[i].prior);
    EXPECT_EQ(read.functions[i].correlation_length, written.functions[i].correlation_length);
    EXPECT_EQ(read.functions[i].measured_max, written.functions[i].measured_max);
  }
  EXPECT_EQ(result_json(read), result_json(written));
}

TEST(ResultJson, ReturnsWhatMadeIt) {
  FitResult written = small_result();
  written.provenance = {"1.2.3", "2026-01-31T14:05:09Z", "volcal fit 'my campaign.toml' -o result"};
  const FitResult read = result_from_json(result_json(written), "result.json");
  EXPECT_EQ(read.provenance.version, written.provenance.version);
  EXPECT_EQ(read.provenance.date, written.provenance.date);
  EXPECT_EQ(read.provenance.command, written.provenance.command);
  auto older = nlohmann::json::parse(result_json(written));
  older.erase("provenance");
  EXPECT_TRUE(result_from_json(older.dump(), "result.json").provenance.empty());
}

TEST(ResultJson, ReturnsTheSameErrorFunctions) {
  const FitResult& written = small_result();
  const FitResult read = result_from_json(result_json(written), "result.json");
  for (const ErrorSymbol symbol : written.layout.symbols()) {
    expect_same_bits(read.layout.coefficients(symbol, read.parameters),
                     written.layout.coefficients(symbol, written.parameters));
    expect_same_function(read.identified.function(symbol), written.identified.function(symbol));
  }
}

TEST(ResultJson, ReturnsTheNoise) {
  FitResult written = small_result();
  const double none = std::numeric_limits<double>::quiet_NaN();
  written.noise = {.estimated = true,
                   .more_than_white = true,
                   .groups = {"laser-tracer", "angle"},
                   .rows = {{0, "wander", "m or rad", 0.4e-6, 0.3e-6, 0.5e-6, 31.5, ""},
                            {1, "white", "1", 1.25, none, none, none, "stated: too few redundant readings"}},
                   .chi2 = 812.5,
                   .dof = 800.25};
  const FitResult read = result_from_json(result_json(written), "result.json");
  EXPECT_TRUE(read.noise.estimated);
  EXPECT_TRUE(read.noise.more_than_white);
  EXPECT_EQ(read.noise.groups, written.noise.groups);
  EXPECT_EQ(read.noise.chi2, 812.5);
  EXPECT_EQ(read.noise.dof, 800.25);
  ASSERT_EQ(read.noise.rows.size(), 2U);
  EXPECT_EQ(read.noise.rows[0].value, 0.4e-6);
  EXPECT_EQ(read.noise.rows[0].likelihood_ratio, 31.5);
  EXPECT_EQ(read.noise.rows[1].instrument, 1U);
  EXPECT_EQ(read.noise.rows[1].remark, "stated: too few redundant readings");
  EXPECT_TRUE(std::isnan(read.noise.rows[1].low));
}

/// What is stated has no covariance, and no zeros in proportion to the square of its parameters.
TEST(ResultJson, KeepsThatStatedErrorsHaveNoCovariance) {
  FitResult stated = small_result();
  stated.covariance.resize(0, 0);
  EXPECT_THROW(result_from_json(result_json(stated), "result.json"), InputError)
      << "of readings it must have one";
  stated.setups.clear();
  EXPECT_EQ(nlohmann::json::parse(result_json(stated)).at("covariance").size(), 0u);
  const FitResult read = result_from_json(result_json(stated), "result.json");
  EXPECT_EQ(read.covariance.size(), 0);
  expect_same_bits(read.parameters, stated.parameters);
  EXPECT_EQ(parameter_variance(read, 0), 0.0);
}

TEST(ResultJson, KeepsWhereRotaryAxesStood) {
  FitResult result = small_result();
  result.standing = {{AxisName::C, 1.25}};
  EXPECT_EQ(result_from_json(result_json(result), "result.json").standing, result.standing);
  auto json = nlohmann::json::parse(result_json(result));
  json["standing"]["X"] = 0.0;
  EXPECT_THROW(result_from_json(json.dump(), "result.json"), InputError);
}

TEST(ResultJson, KeepsNumbersThatAreNotFinite) {
  FitResult result = small_result();
  result.chi2 = std::numeric_limits<double>::infinity();
  result.final_cost = -std::numeric_limits<double>::infinity();
  result.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  const FitResult read = result_from_json(result_json(result), "result.json");
  EXPECT_EQ(read.chi2, result.chi2);
  EXPECT_EQ(read.final_cost, result.final_cost);
  EXPECT_TRUE(std::isnan(read.covariance(0, 0)));
}

TEST(ResultJson, RefusesDamagedFilesWithTheLine) {
  const std::string good = result_json(small_result());
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      result_from_json(text, "result.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("{\n\"format\": \n"), StartsWith("result.json:3: the file is not complete JSON"));
  EXPECT_THAT(refusal(good.substr(0, good.size() / 2)), HasSubstr("not complete JSON"));
  EXPECT_THAT(refusal("{}"), HasSubstr("format"));
  std::string other = good;
  other.replace(other.find("volcal-result-1"), 15, "volcal-result-0");
  EXPECT_THAT(refusal(other), HasSubstr("run the fit again"));
}

TEST(MachineToml, IsReadAgain) {
  Machine machine = read_machine(kSmall + "machine.toml");
  machine.name = "a \"quoted\" name \\ of one line";
  machine.axes[1].travel_max = 0.1 + 0.2;
  machine.axes[1].expansion = ScaleExpansion{11.7e-6, 0.3e-6, "Y scale"};
  machine.tools[0].name = "tool, long";
  machine.tools[0].offset = Eigen::Vector3d(1.0 / 3.0, -2.0 / 7.0, 1e-17);
  const Machine read = parse_machine(machine_toml(machine), "machine.toml");
  EXPECT_EQ(read.name, machine.name);
  ASSERT_EQ(read.axes.size(), machine.axes.size());
  for (std::size_t i = 0; i < read.axes.size(); ++i) {
    EXPECT_EQ(read.axes[i].name, machine.axes[i].name);
    EXPECT_DOUBLE_EQ(read.axes[i].travel_min, machine.axes[i].travel_min);
    EXPECT_DOUBLE_EQ(read.axes[i].travel_max, machine.axes[i].travel_max);
    EXPECT_TRUE(read.axes[i].reference_point.isApprox(machine.axes[i].reference_point, 1e-15));
  }
  EXPECT_EQ(read.axes[1].expansion->channel, "Y scale");
  EXPECT_DOUBLE_EQ(read.axes[1].expansion->per_kelvin, 11.7e-6);
  ASSERT_EQ(read.tools.size(), 3U);
  const auto tool = read.tool_index("tool, long");
  ASSERT_TRUE(tool.has_value());
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(read.tools[*tool].offset[i], machine.tools[0].offset[i]);
}

TEST(IdentifiedToml, IsAModelThatCanBeLoadedAgain) {
  const FitResult& result = small_result();
  const ModelSpec read = parse_model(model_toml(result.identified, "machine.toml", "a comment"),
                                     "identified.toml", result.machine);
  for (const auto& [symbol, function] : result.identified.functions) {
    const FunctionSpec& again = read.function(symbol);
    EXPECT_EQ(again.basis, function.basis) << symbol.name();
    ASSERT_EQ(again.coefficients.size(), function.coefficients.size()) << symbol.name();
    for (std::size_t i = 0; i < again.coefficients.size(); ++i) {
      EXPECT_DOUBLE_EQ(again.coefficients[i], function.coefficients[i]) << symbol.name();
    }
    ASSERT_EQ(again.breakpoints.size(), function.breakpoints.size()) << symbol.name();
    for (std::size_t i = 0; i < again.breakpoints.size(); ++i) {
      EXPECT_DOUBLE_EQ(again.breakpoints[i], function.breakpoints[i]) << symbol.name();
    }
  }
  ASSERT_EQ(read.locations.size(), result.identified.locations.size());
  for (const auto& [symbol, value] : result.identified.locations) {
    EXPECT_DOUBLE_EQ(read.locations.at(symbol), value);
  }
  ASSERT_EQ(read.effects.size(), result.identified.effects.size());
  for (std::size_t i = 0; i < read.effects.size(); ++i) {
    EXPECT_EQ(read.effects[i].options.text("symbol"), result.identified.effects[i].options.text("symbol"));
    const auto again = read.effects[i].options.number("amplitude");
    const auto amplitude = result.identified.effects[i].options.number("amplitude");
    ASSERT_EQ(again.has_value(), amplitude.has_value());
    if (again) {
      EXPECT_DOUBLE_EQ(*again, *amplitude);
    }
  }
}

TEST(EdgeNumber, HasTheFewestDigitsThatReturnTheValue) {
  EXPECT_EQ(edge_number(0.25, 1e-3), "250");
  EXPECT_EQ(edge_number(-0.1234, 1e-3), "-123.4");
  EXPECT_EQ(edge_number(0.0, 1e-6), "0");
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 10000; ++i) {
    const double value = uniform(random);
    EXPECT_DOUBLE_EQ(std::strtod(edge_number(value, 1e-6).c_str(), nullptr) * 1e-6, value);
  }
}

TEST(ResultFolder, HoldsTheFilesWithTheirColumns) {
  const testing::ScratchFolder scratch;
  const Campaign campaign = small_campaign();
  const fs::path target = scratch.path() / "result";
  write_result_folder(small_result(), campaign, target.string(), {{"report.html", "<html></html>"}});
  const auto first_line = [&](const char* name) {
    std::istringstream text(testing::slurp(target / name));
    std::string line;
    std::getline(text, line);
    return line;
  };
  EXPECT_EQ(first_line("error_tables.csv"),
            "symbol,axis,position,position_unit,direction,value,unit,u,U95,extrapolated");
  EXPECT_THAT(first_line("volumetric_grid.csv"),
              StartsWith("x_mm,y_mm,z_mm,tool,ex_um,ey_um,ez_um,ea_urad,eb_urad,ec_urad,u_ex_um"));
  EXPECT_THAT(
      first_line("residuals.csv"),
      StartsWith("setup,row,reading,predicted,residual_um,sigma_um,standardized,redundancy,w,flagged"));
  EXPECT_EQ(testing::slurp(target / "report.html"), "<html></html>");
  const std::string residuals = testing::slurp(target / "residuals.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(residuals.begin(), residuals.end(), '\n')),
            1 + small_result().residuals.size());
  EXPECT_TRUE(nlohmann::json::parse(testing::slurp(target / "result.json")).contains("rank"));
}

TEST(ResultFolder, CanBeUsedWithoutTheCampaign) {
  const testing::ScratchFolder scratch;
  const fs::path target = scratch.path() / "result";
  write_result_folder(small_result(), small_campaign(), target.string());
  EXPECT_TRUE(is_result(target.string()));
  EXPECT_FALSE(is_result(kSmall));
  expect_same_bits(read_result(target.string()).parameters, small_result().parameters);
  const ModelFile model = read_model_with_machine((target / "identified.toml").string());
  EXPECT_EQ(machine_difference(model.machine, small_result().machine), "");
  EXPECT_EQ(read_model((target / "identified.toml").string(), small_campaign().machine).functions.size(),
            small_result().identified.functions.size());
  EXPECT_THROW(read_result(kSmall), InputError);
}

}  // namespace
}  // namespace volcal
