// The compressed sums against the sum over single rows, on random chains of six axes with every kind of
// parameter.

#include "volcal/identify/solve/normals/normal_equations.h"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/campaigns.h"

namespace volcal {
namespace {

constexpr double kNormalsRounding = 1e-12;

NormalEquations sum_of_rows(const MeasurementModel& model, const ReadingIndex& index,
                            const std::vector<double>& weight, const ceres::LossFunction* loss,
                            const Eigen::VectorXd& parameters, const std::vector<bool>& include) {
  const int size = model.layout().size;
  NormalEquations sums{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  RowJacobian row;
  for (std::size_t setup = 0; setup < include.size(); ++setup) {
    if (!include[setup]) continue;
    const Readings& readings = model.campaign().setups[setup].readings;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      model.linearize(setup, i, parameters, row);
      for (int channel = 0; channel < row.channels; ++channel) {
        const auto c = static_cast<std::size_t>(channel);
        const double w = weight[index.first_observation(setup, i) + c];
        if (w == 0.0) continue;
        const double error = row.predicted[channel] - readings.value[c][i];
        double rho[3] = {w * error * error, 1.0, 0.0};
        if (loss != nullptr) loss->Evaluate(w * error * error, rho);
        const Eigen::VectorXd derivatives = dense_row(model.layout(), row, channel);
        sums.matrix += w * rho[1] * derivatives * derivatives.transpose();
        sums.gradient += w * rho[1] * error * derivatives;
        sums.cost += 0.5 * rho[0];
        sums.squares += w * error * error;
        ++sums.observations;
      }
    }
  }
  return sums;
}

/// Relative to the diagonal, as sums of squares round.
double difference(const NormalEquations& a, const NormalEquations& b) {
  const Eigen::VectorXd scale = b.matrix.diagonal().cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd matrix = (a.matrix - b.matrix).cwiseQuotient(scale * scale.transpose());
  const Eigen::VectorXd gradient = (a.gradient - b.gradient).cwiseQuotient(scale) / std::sqrt(2.0 * b.cost);
  return std::max(matrix.cwiseAbs().maxCoeff(), gradient.cwiseAbs().maxCoeff());
}

class NormalEquationsOnRandomChains : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  void expect_agreement(const ceres::LossFunction* loss, const std::vector<bool>& include) {
    const MeasurementModel model(campaign_, testing_support::rich_model(campaign_.machine));
    const ReadingIndex index(model);
    const Eigen::VectorXd parameters = testing_support::random_parameters(model, random_);
    std::vector<double> weight(index.observations());
    for (std::size_t i = 0; i < weight.size(); ++i) {
      weight[i] = i % 11 == 0 ? 0.0 : 1e6 * (1.5 + testing_support::uniform(random_, 1.0));
    }
    const NormalEquations expected = sum_of_rows(model, index, weight, loss, parameters, include);
    const NormalEquations sums = NormalAccumulator(index, weight, loss, 2).accumulate(parameters, &include);
    EXPECT_LT(difference(sums, expected), kNormalsRounding);
    EXPECT_NEAR(sums.cost / expected.cost, 1.0, kNormalsRounding);
    EXPECT_NEAR(sums.squares / expected.squares, 1.0, kNormalsRounding);
    EXPECT_EQ(sums.observations, expected.observations);
    EXPECT_TRUE(sums.matrix == sums.matrix.transpose());
    expect_the_same_without_matrix(index, weight, loss, parameters, include, expected);
  }

  static void expect_the_same_without_matrix(const ReadingIndex& index, const std::vector<double>& weight,
                                             const ceres::LossFunction* loss,
                                             const Eigen::VectorXd& parameters,
                                             const std::vector<bool>& include,
                                             const NormalEquations& expected) {
    NormalEquations sums =
        NormalAccumulator(index, weight, loss, 2).accumulate(parameters, &include, Sums::AllButMatrix);
    sums.matrix = expected.matrix;
    EXPECT_LT(difference(sums, expected), kNormalsRounding);
    EXPECT_NEAR(sums.cost / expected.cost, 1.0, kNormalsRounding);
    EXPECT_EQ(sums.observations, expected.observations);
  }

  std::mt19937_64 random_{GetParam()};
  Campaign campaign_ = testing_support::random_campaign(random_, 300);
};

TEST_P(NormalEquationsOnRandomChains, EqualTheSumOfRows) { expect_agreement(nullptr, {true, true}); }

TEST_P(NormalEquationsOnRandomChains, EqualTheSumOfRowsInOneCell) {
  for (volcal::Setup& setup : campaign_.setups) {
    for (const Axis& axis : campaign_.machine.axes) {
      for (double& position : setup.readings.position[index_of(axis.name)]) {
        position = axis.travel_min + 0.49 * (position - axis.travel_min);
      }
    }
  }
  expect_agreement(nullptr, {true, true});
}

TEST_P(NormalEquationsOnRandomChains, EqualTheSumOfRowsWherePositionsRecur) {
  constexpr double kIntervals = 3.0;
  for (volcal::Setup& setup : campaign_.setups) {
    for (const Axis& axis : campaign_.machine.axes) {
      for (double& position : setup.readings.position[index_of(axis.name)]) {
        const double share = (position - axis.travel_min) / axis.travel();
        position = axis.travel_min + axis.travel() * std::round(kIntervals * share) / kIntervals;
      }
    }
  }
  const MeasurementModel model(campaign_, testing_support::rich_model(campaign_.machine));
  EXPECT_TRUE(PairSums::pay(BlockModel(model)));
  expect_agreement(nullptr, {true, true});
  expect_agreement(nullptr, {false, true});
}

TEST_P(NormalEquationsOnRandomChains, EqualTheSumOfOneSetupsRows) {
  expect_agreement(nullptr, {false, true});
}

TEST_P(NormalEquationsOnRandomChains, EqualTheSumOfRobustRows) {
  const ceres::CauchyLoss loss(1.0);
  expect_agreement(&loss, {true, true});
}

INSTANTIATE_TEST_SUITE_P(Seeds, NormalEquationsOnRandomChains, ::testing::Range<std::uint64_t>(1, 5));

}  // namespace
}  // namespace volcal
