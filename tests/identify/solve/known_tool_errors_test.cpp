// What a model says of tools' offsets, in evaluations and fits. On a machine without rotary axes a point is
// off by what the offset is wrong by, wherever it stands.

#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"

namespace volcal {
namespace {

constexpr double kNoiseOfPoints = 2e-6;  // m
const Eigen::Vector3d kError(10e-6, -20e-6, 5e-6);

/// Points along X that are off by nothing with the first tool and by `error` with the second.
Campaign campaign_with(const Eigen::Vector3d& error) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w b X Y Z t");
  campaign.machine.tools = {{"first", {0.0, 0.0, -0.2}, 0.0}, {"second", {0.1, 0.0, -0.2}, 0.0}};
  for (const std::size_t tool : {0U, 1U}) {
    Setup& setup = campaign.setups.emplace_back();
    setup.name = campaign.machine.tools[tool].name;
    setup.instrument = "volumetric-points";
    setup.tool = tool;
    setup.options.set("alignment", std::string("none"));
    setup.noise.set("constant", kNoiseOfPoints);
    setup.readings.value.resize(3);
    const Axis& travel = campaign.machine.axis(AxisName::X);
    for (int row = 0; row < 4; ++row) {
      for (const AxisName axis : kAllAxes)
        setup.readings.position[index_of(axis)].push_back(
            axis == AxisName::X ? travel.travel_min + travel.travel() * row / 3.0 : 0.0);
      for (std::size_t k = 0; k < 3; ++k)
        setup.readings.value[k].push_back(tool == 1 ? error[static_cast<Eigen::Index>(k)] : 0.0);
      setup.readings.source_line.push_back(row + 2);
    }
  }
  return campaign;
}

ModelSpec model_with(const Eigen::Vector3d& error) {
  ModelSpec model = nominal_model();
  for (const char* symbol : {"EC0Y", "EB0Z", "EA0Z"})
    model.locations_off.push_back(*LocationSymbol::parse(symbol));
  model.tool_errors["second"] = error;
  return model;
}

double largest_residual(const std::vector<ResidualRecord>& residuals) {
  double largest = 0.0;
  for (const ResidualRecord& record : residuals) largest = std::max(largest, std::abs(record.residual()));
  return largest;
}

Eigen::Vector3d error_of_second(const ParameterLayout& layout, const Eigen::VectorXd& parameters) {
  return parameters.segment<3>(layout.find_block("tool second")->offset);
}

TEST(KnownToolErrors, OfAnExactToolAreHeld) {
  const Campaign campaign = campaign_with(kError);
  EXPECT_NEAR(largest_residual(evaluate_model(campaign, nominal_model()).residuals), 20e-6, 1e-12);
  const Evaluation known = evaluate_model(campaign, model_with(kError));
  EXPECT_LT(largest_residual(known.residuals), 1e-12);
  EXPECT_EQ(error_of_second(known.layout, known.parameters), kError);
}

/// Four readings of 2 um and a statement of 2 um: a fifth of the statement, four fifths of the readings.
TEST(KnownToolErrors, OfAnUncertainToolAreWhereItsPriorStands) {
  Campaign campaign = campaign_with({20e-6, 0.0, 0.0});
  campaign.machine.tools[1].offset_sigma = kNoiseOfPoints;
  const Evaluation known = evaluate_model(campaign, model_with({10e-6, 0.0, 0.0}));
  const Eigen::Vector3d wanted(18e-6, 0.0, 0.0);
  EXPECT_LT((error_of_second(known.layout, known.parameters) - wanted).norm(), 1e-10);
}

ModelSpec model_of_fit() {
  ModelSpec model = model_with(kError);
  FunctionSpec line;
  line.basis = "legendre";
  line.degree = 3;
  model.functions[*ErrorSymbol::parse("EYX")] = line;
  return model;
}

FitOptions plain_fit() {
  FitOptions options;
  options.noise = NoisePolicy::White;
  options.variance_components = false;
  return options;
}

TEST(KnownToolErrors, OfAnExactToolStayInAFit) {
  const FitResult result = fit(campaign_with(kError), model_of_fit(), plain_fit());
  EXPECT_EQ(error_of_second(result.layout, result.parameters), kError);
  const int place = result.layout.find_block("tool second")->offset;
  EXPECT_TRUE(result.covariance.middleRows(place, 3).isZero(0.0));
  EXPECT_LT(largest_residual(result.residuals), 1e-9);
  EXPECT_EQ(model_of_result(result).tool_errors.at("second"), kError);
}

TEST(KnownToolErrors, OfAToolWithoutReadingsStayInAFit) {
  Campaign campaign = campaign_with(kError);
  campaign.setups.pop_back();
  campaign.machine.tools[1].offset_sigma = kNoiseOfPoints;
  const FitResult result = fit(campaign, model_of_fit(), plain_fit());
  const Eigen::Vector3d error = ErrorField(result, campaign.machine.tools[1]).at(AxisPosition{}).head<3>();
  EXPECT_LT((error - kError).norm(), 1e-9);
}

/// Readings and the machine file's statement alone: four fifths of what they are off by.
TEST(KnownToolErrors, OfAnUncertainToolAreEstimatedAnewByAFit) {
  Campaign campaign = campaign_with({20e-6, 0.0, 0.0});
  campaign.machine.tools[1].offset_sigma = kNoiseOfPoints;
  const FitResult result = fit(campaign, model_of_fit(), plain_fit());
  EXPECT_NEAR(error_of_second(result.layout, result.parameters).x(), 16e-6, 1e-10);
  EXPECT_EQ(model_of_result(result).tool_errors.at("second"),
            error_of_second(result.layout, result.parameters));
}

TEST(KnownToolErrors, ActOnTheirToolAlone) {
  const Machine machine = campaign_with(kError).machine;
  const FitResult stated = stated_result(machine, model_with(kError));
  EXPECT_TRUE(states_errors(model_with(kError)));
  for (const Tool& tool : machine.tools) {
    const Eigen::Vector3d error = ErrorField(stated, tool).at(AxisPosition{}).head<3>();
    EXPECT_EQ(error, tool.name == "second" ? kError : Eigen::Vector3d::Zero()) << tool.name;
  }
}

}  // namespace
}  // namespace volcal
