/// Effects on the pages that show errors of the rigid body.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/io/report/page_data.h"
#include "tests/io/report/synthetic_fit.h"
#include "volcal/identify/report/report.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using test::page_data;

/// One amplitude of 8 of its units.
void add_effect(FitResult& result, const EffectSpec& effect, const std::string& label,
                const std::string& unit, double si_per_unit) {
  ParameterBlock block;
  block.kind = ParameterKind::Effect;
  block.name = label;
  block.labels = {""};
  block.units = {unit};
  block.si_per_unit = {si_per_unit};
  block.offset = result.layout.size++;
  block.guess = block.prior_mean = block.prior_sigma = Eigen::VectorXd::Zero(1);
  result.layout.blocks.push_back(block);
  result.identified.effects.push_back(effect);
  result.parameters.conservativeResize(result.layout.size);
  result.parameters[block.offset] = 8.0 * si_per_unit;
  result.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(result.layout.size, result.layout.size));
}

/// EAX has no function, but a reversal of 8 urad: half of it either way.
TEST(ReportOfAReversal, AnErrorWithoutAFunctionIsNotLeftOut) {
  test::SyntheticFit fit = test::synthetic_fit();
  add_effect(fit.result, effect_spec("reversal", {{"symbol", std::string("EAX")}}), "reversal EAX", "urad",
             1e-6);
  const Json function =
      page_data(Json::parse(report_json(fit.result, fit.campaign)), "functions").at("functions").at(3);
  ASSERT_EQ(function.at("symbol"), "EAX");
  EXPECT_EQ(function.at("state"), "identified");
  EXPECT_TRUE(function.at("knots").empty());
  ASSERT_EQ(function.at("curves").size(), 2u);
  EXPECT_EQ(function.at("curves").at(0).at("direction"), -1);
  EXPECT_EQ(function.at("curves").at(0).at("value").at(40), -4.0);
  EXPECT_EQ(function.at("curves").at(1).at("value").at(0), 4.0);
}

/// A growth by time of 2e-9 m/s, u 0.36 um/h.
TEST(ReportOfAnEffect, ItsUncertaintyIsInTheUnitOfItsAmplitude) {
  test::SyntheticFit fit = test::synthetic_fit();
  const double um_per_h = 1e-6 / 3600.0;
  add_effect(fit.result,
             effect_spec("custom", {{"target", std::string("EXX")}, {"expression", std::string("t")}}),
             "EXX by t", "um/h", um_per_h);
  fit.result.rank.errors.push_back({.symbol = MachineError("EXX by t"),
                                    .visible_fraction = 0.5,
                                    .u_rms = 0.36 * um_per_h,
                                    .effective_parameters = 1.0});
  const Json errors =
      page_data(Json::parse(report_json(fit.result, fit.campaign)), "observability").at("errors");
  const Json& row = errors.back();
  EXPECT_EQ(row.at("symbol"), "EXX by t");
  EXPECT_EQ(row.at("axis"), "");
  EXPECT_EQ(row.at("unit"), "µm/h");
  EXPECT_EQ(row.at("u_rms"), 0.36);
  EXPECT_EQ(errors.front().at("axis"), "X");
  EXPECT_EQ(errors.front().at("unit"), "µm");
}

}  // namespace
}  // namespace volcal
