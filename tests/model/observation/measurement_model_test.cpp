// Predictions against the kinematic chain, derivatives against differences, on random chains of six axes.

#include "volcal/model/observation/measurement_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/machines.h"

namespace volcal {
namespace {

using testing_support::random_vector;
using testing_support::uniform;

constexpr std::size_t kRows = 20;

Campaign random_campaign(std::mt19937_64& random) {
  Campaign campaign;
  campaign.machine = testing_support::random_machine(random);
  campaign.machine.tools = {{"exact", random_vector(random, 0.2), 0.0},
                            {"uncertain", random_vector(random, 0.2), 1e-5}};
  for (Axis& axis : campaign.machine.axes) {
    if (axis.name == AxisName::Y) axis.expansion = {11e-6, 1e-6, "Y"};
    if (axis.name == AxisName::Z) axis.expansion = {10e-6, 0.0, "Z"};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    Setup setup;
    setup.name = "S" + std::to_string(i);
    setup.instrument = i == 0 ? "laser-tracer" : "laser-tracker";
    setup.tool = i;
    setup.options.set("station", Eigen::Vector3d(random_vector(random, 0.3) + Eigen::Vector3d(4, 4, 4)));
    setup.noise.set("constant", 1e-6);
    setup.readings.value.assign(i == 0 ? 1 : 3, std::vector<double>(kRows, 0.0));
    for (std::size_t row = 0; row < kRows; ++row) {
      for (const Axis& axis : campaign.machine.axes) {
        setup.readings.position[index_of(axis.name)].push_back(0.5 * (axis.travel_min + axis.travel_max) +
                                                               uniform(random, 0.5 * axis.travel()));
        setup.readings.direction[index_of(axis.name)].push_back(row % 2 == 0 ? 1 : -1);
      }
      setup.readings.temperature["Y"].push_back(20.0 + uniform(random, 5.0));
      setup.readings.temperature["Z"].push_back(20.0 + uniform(random, 5.0));
      setup.readings.source_line.push_back(static_cast<std::int64_t>(row) + 2);
    }
    campaign.setups.push_back(setup);
  }
  return campaign;
}

/// Splines on all axes, two bases on X, a reversal, and every rotary location error.
ModelSpec rich_model(const Machine& machine) {
  ModelSpec model;
  for (const Axis& axis : machine.axes) {
    FunctionSpec spline;
    spline.knots = KnotChoice::Explicit;
    spline.breakpoints = {axis.travel_min, 0.5 * (axis.travel_min + axis.travel_max), axis.travel_max};
    for (const Component component : kAllComponents) {
      FunctionSpec function = spline;
      if (axis.name == AxisName::X && is_rotation(component)) function.degree = 2;
      model.functions[{component, axis.name}] = function;
      if (is_rotary(axis.name)) model.locations[{component, axis.name}] = 0.0;
    }
  }
  EffectSpec reversal;
  reversal.kind = "reversal";
  reversal.options.set("symbol", std::string("EAX"));
  model.effects.push_back(reversal);
  return model;
}

/// Errors of some 10 um and 10 urad on top of the guesses.
Eigen::VectorXd random_parameters(const MeasurementModel& model, std::mt19937_64& random) {
  Eigen::VectorXd parameters = model.initial_parameters();
  for (double& parameter : parameters) parameter += uniform(random, 1e-5);
  return parameters;
}

class MeasurementModelOnRandomChains : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  std::mt19937_64 random_{GetParam()};
  Campaign campaign_ = random_campaign(random_);
  MeasurementModel model_{campaign_, rich_model(campaign_.machine)};
  Eigen::VectorXd parameters_ = random_parameters(model_, random_);
};

TEST_P(MeasurementModelOnRandomChains, LengthIsFromStationToTheDisplacedPoint) {
  // Without effects, expansions and tool errors the errors are those of errors_at().
  for (const ParameterBlock& block : model_.layout().blocks) {
    if (block.kind == ParameterKind::Effect) parameters_[block.offset] = 0.0;
  }
  volcal::Setup& setup = campaign_.setups[0];
  for (auto& [channel, values] : setup.readings.temperature) values.assign(kRows, 20.0);
  const Eigen::Vector3d tool = campaign_.machine.tools[setup.tool].offset;
  const ParameterBlock& station = *model_.layout().find_block("station S0");
  const ParameterBlock& dead_path = *model_.layout().find_block("S0: dead path");
  for (std::size_t row = 0; row < kRows; ++row) {
    const AxisPosition position = commanded_position(campaign_.machine, setup.readings, row);
    const ToolTwist twist =
        model_.chain().first_order(position, tool, model_.errors_at(position, parameters_));
    const Eigen::Vector3d point_w = model_.chain().nominal_point_w(position, tool) + twist.displacement_w;
    const double length =
        (point_w - parameters_.segment<3>(station.offset)).norm() - parameters_[dead_path.offset];
    double predicted = 0.0;
    model_.predict(0, row, parameters_, &predicted);
    EXPECT_NEAR(predicted, length, 1e-14);
  }
}

TEST_P(MeasurementModelOnRandomChains, SecondOrderRemainderMakesTheLengthExact) {
  model_.set_second_order_remainder(parameters_);
  RowJacobian exact;
  model_.linearize(0, 3, parameters_, exact);
  model_.clear_second_order_remainder();
  RowJacobian first_order;
  model_.linearize(0, 3, parameters_, first_order);
  EXPECT_NE(exact.predicted[0], first_order.predicted[0]);
  EXPECT_NEAR(exact.predicted[0], first_order.predicted[0], 1e-7);
}

TEST_P(MeasurementModelOnRandomChains, DerivativesEqualDifferences) {
  constexpr double kStep = 1e-5;
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    for (std::size_t row = 0; row < kRows; row += 7) {
      RowJacobian jacobian;
      model_.linearize(setup, row, parameters_, jacobian);
      for (int channel = 0; channel < jacobian.channels; ++channel) {
        const Eigen::VectorXd derivative = dense_row(model_.layout(), jacobian, channel);
        for (int k = 0; k < model_.layout().size; ++k) {
          Eigen::VectorXd moved = parameters_;
          double above[kMaxChannels], below[kMaxChannels];
          moved[k] = parameters_[k] + kStep;
          model_.predict(setup, row, moved, above);
          moved[k] = parameters_[k] - kStep;
          model_.predict(setup, row, moved, below);
          const double difference = (above[channel] - below[channel]) / (2.0 * kStep);
          EXPECT_NEAR(derivative[k], difference, 1e-9 * std::max(1.0, std::abs(difference))) << k;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, MeasurementModelOnRandomChains, ::testing::Range<std::uint64_t>(1, 7));

}  // namespace
}  // namespace volcal
