// Predictions against the kinematic chain, derivatives against differences, on random chains of six axes.

#include "volcal/model/observation/measurement_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/campaigns.h"

namespace volcal {
namespace {

using testing_support::random_parameters;

constexpr std::size_t kReadings = 20;

class MeasurementModelOnRandomChains : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  std::mt19937_64 random_{GetParam()};
  Campaign campaign_ = testing_support::random_campaign(random_, kReadings);
  MeasurementModel model_{campaign_, testing_support::rich_model(campaign_.machine)};
  Eigen::VectorXd parameters_ = random_parameters(model_, random_);
};

TEST_P(MeasurementModelOnRandomChains, LengthIsFromStationToTheDisplacedPoint) {
  // Without effects, expansions and tool errors the errors are those of errors_at().
  for (const ParameterBlock& block : model_.layout().blocks) {
    if (block.kind == ParameterKind::Effect) parameters_[block.offset] = 0.0;
  }
  volcal::Setup& setup = campaign_.setups[0];
  for (auto& [channel, values] : setup.readings.temperature) values.assign(kReadings, 20.0);
  const Eigen::Vector3d tool = campaign_.machine.tools[setup.tool].offset;
  const ParameterBlock& station = *model_.layout().find_block("station S0");
  const ParameterBlock& dead_path = *model_.layout().find_block("S0: dead path");
  for (std::size_t row = 0; row < kReadings; ++row) {
    const AxisPosition position = setup.readings.commanded_position(row);
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
  RowJacobian first_order;
  model_.linearize(0, 3, parameters_, first_order);
  model_.set_second_order_remainder(parameters_);
  RowJacobian exact;
  model_.linearize(0, 3, parameters_, exact);
  EXPECT_NE(exact.predicted[0], first_order.predicted[0]);
  EXPECT_NEAR(exact.predicted[0], first_order.predicted[0], 1e-7);
}

TEST_P(MeasurementModelOnRandomChains, DerivativesEqualDifferences) {
  constexpr double kStep = 1e-5;
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    for (std::size_t row = 0; row < kReadings; row += 7) {
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

void expect_same_row(const MeasurementModel& a, const RowJacobian& row_a, const RowJacobian& row_b) {
  ASSERT_EQ(row_a.channels, row_b.channels);
  for (int channel = 0; channel < row_a.channels; ++channel) {
    EXPECT_EQ(row_a.predicted[channel], row_b.predicted[channel]);
    EXPECT_TRUE(dense_row(a.layout(), row_a, channel) == dense_row(a.layout(), row_b, channel));
  }
}

TEST_P(MeasurementModelOnRandomChains, TabulatedFunctionsChangeNothing) {
  const TabulatedFunctions tabulated = model_.tabulate(parameters_);
  RowJacobian plain, with_table;
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    for (std::size_t row = 0; row < kReadings; ++row) {
      model_.linearize(setup, row, parameters_, plain);
      model_.linearize(setup, row, parameters_, with_table, &tabulated);
      expect_same_row(model_, plain, with_table);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, MeasurementModelOnRandomChains, ::testing::Range<std::uint64_t>(1, 7));

}  // namespace
}  // namespace volcal
