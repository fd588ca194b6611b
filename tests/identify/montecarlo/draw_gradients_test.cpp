// Gradients of several draws side by side against sums over single rows of the Jacobian.

#include "volcal/identify/montecarlo/draw_gradients.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/support/campaigns.h"
#include "tests/support/effect_campaign.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kGradientRounding = 1e-11;
constexpr int kDrawsOfABlock = DrawGradients::kDraws;

std::vector<double> sigmas(std::size_t count) {
  std::vector<double> sigma(count);
  for (std::size_t i = 0; i < count; ++i) sigma[i] = 1e-6 * (1.0 + 0.1 * static_cast<double>(i % 7));
  return sigma;
}

/// Independent readings.
NoiseData noise_of(const std::vector<double>& sigma) {
  NoiseData data;
  data.sigma = sigma;
  data.sequences.resize(1);
  for (std::size_t i = 0; i < sigma.size(); ++i) data.sequences[0].observation.push_back(i);
  return data;
}

std::size_t observations_of(const MeasurementModel& model) {
  std::size_t count = 0;
  for (std::size_t setup = 0; setup < model.campaign().setups.size(); ++setup)
    count += model.campaign().setups[setup].readings.size() *
             static_cast<std::size_t>(model.bound(setup).channels());
  return count;
}

/// J^T Sigma^-1 (f - y), and |J|^T Sigma^-1 |f - y|, by which it rounds.
struct RowSums {
  Eigen::VectorXd gradient;
  Eigen::VectorXd sizes;
};

RowSums sums_of_rows(const MeasurementModel& model, const std::vector<double>& sigma,
                     const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings) {
  RowSums sums{Eigen::VectorXd::Zero(model.layout().size), Eigen::VectorXd::Zero(model.layout().size)};
  RowJacobian row;
  std::size_t observation = 0;
  for (std::size_t setup = 0; setup < model.campaign().setups.size(); ++setup) {
    for (std::size_t i = 0; i < model.campaign().setups[setup].readings.size(); ++i) {
      model.linearize(setup, i, parameters, row);
      for (int channel = 0; channel < row.channels; ++channel, ++observation) {
        const double error = (row.predicted[channel] - readings[static_cast<Eigen::Index>(observation)]) /
                             (sigma[observation] * sigma[observation]);
        const Eigen::VectorXd derivatives = dense_row(model.layout(), row, channel);
        sums.gradient += error * derivatives;
        sums.sizes += std::abs(error) * derivatives.cwiseAbs();
      }
    }
  }
  return sums;
}

/// Parameters and readings of some draws.
struct Draws {
  Eigen::MatrixXd parameters;
  Eigen::MatrixXd readings;
};

Draws draws_of(const MeasurementModel& model, std::mt19937_64& random, int count) {
  const auto observations = static_cast<Eigen::Index>(observations_of(model));
  Draws draws{Eigen::MatrixXd(model.layout().size, count), Eigen::MatrixXd(observations, count)};
  for (int k = 0; k < count; ++k) draws.parameters.col(k) = testing_support::random_parameters(model, random);
  for (double& reading : draws.readings.reshaped()) reading = testing_support::uniform(random, 1.0);
  return draws;
}

/// Gradients with independent noise.
class Gradients {
 public:
  explicit Gradients(const MeasurementModel& model)
      : sigma(sigmas(observations_of(model))),
        whitener_(noise_of(sigma), std::vector<NoiseParameters>(1)),
        blocks_(model),
        gradients_(blocks_, whitener_),
        work_(gradients_) {}

  Eigen::MatrixXd at(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& readings) {
    return gradients_.at(parameters, readings, work_);
  }

  const std::vector<double> sigma;

 private:
  Whitener whitener_;
  BlockModel blocks_;
  DrawGradients gradients_;
  DrawGradients::Workspace work_;
};

void expect_sums_of_rows(const MeasurementModel& model, std::mt19937_64& random, int count) {
  Gradients gradients(model);
  const Draws draws = draws_of(model, random, count);
  const Eigen::MatrixXd found = gradients.at(draws.parameters, draws.readings);
  ASSERT_EQ(found.cols(), count);
  for (int k = 0; k < count; ++k) {
    const RowSums expected =
        sums_of_rows(model, gradients.sigma, draws.parameters.col(k), draws.readings.col(k));
    EXPECT_GT(expected.gradient.norm(), 0.0);
    for (Eigen::Index i = 0; i < found.rows(); ++i)
      EXPECT_NEAR(found(i, k), expected.gradient[i], kGradientRounding * expected.sizes[i]) << i;
  }
}

class DrawGradientsOnRandomChains : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  std::mt19937_64 random_{GetParam()};
  Campaign campaign_ = testing_support::random_campaign(random_, 150);
};

TEST_P(DrawGradientsOnRandomChains, EqualSumsOfRows) {
  const MeasurementModel model(campaign_, testing_support::rich_model(campaign_.machine));
  for (const int count : {1, 5, kDrawsOfABlock}) expect_sums_of_rows(model, random_, count);
}

TEST_P(DrawGradientsOnRandomChains, EqualSumsOfRowsWithoutEffects) {
  ModelSpec spec = testing_support::rich_model(campaign_.machine);
  spec.effects.clear();
  const MeasurementModel model(campaign_, spec);
  expect_sums_of_rows(model, random_, kDrawsOfABlock);
}

/// No joint turns and there are no effects: displacements and rotations follow from the arms.
TEST_P(DrawGradientsOnRandomChains, EqualSumsOfRowsOfThreeAxes) {
  Machine& machine = campaign_.machine;
  machine.structure = Structure::parse("w Y' b Z X t");
  std::erase_if(machine.axes, [](const Axis& axis) { return is_rotary(axis.name); });
  ModelSpec spec = testing_support::rich_model(machine);
  spec.effects.clear();
  const MeasurementModel model(campaign_, spec);
  expect_sums_of_rows(model, random_, kDrawsOfABlock);
}

TEST_P(DrawGradientsOnRandomChains, EqualSumsOfRowsWithTheSecondOrderRemainder) {
  MeasurementModel model(campaign_, testing_support::rich_model(campaign_.machine));
  model.set_second_order_remainder(testing_support::random_parameters(model, random_));
  expect_sums_of_rows(model, random_, kDrawsOfABlock);
}

TEST_P(DrawGradientsOnRandomChains, DoNotDependOnTheirNeighbours) {
  const MeasurementModel model(campaign_, testing_support::rich_model(campaign_.machine));
  Gradients gradients(model);
  const Draws draws = draws_of(model, random_, kDrawsOfABlock);
  const Eigen::MatrixXd together = gradients.at(draws.parameters, draws.readings);
  for (int k = 0; k < kDrawsOfABlock; ++k) {
    const Eigen::MatrixXd alone = gradients.at(draws.parameters.col(k), draws.readings.col(k));
    EXPECT_TRUE(alone.col(0) == together.col(k)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, DrawGradientsOnRandomChains, ::testing::Range<std::uint64_t>(1, 4));

// Every instrument, two tools, and every effect on motions, tool, station and reading.
TEST(DrawGradients, EqualSumsOfRowsWithEveryEffect) {
  std::mt19937_64 random(7);
  const Campaign campaign = testing_support::effect_campaign();
  int compared = 0, refused = 0;
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& spec : kind->examples(campaign)) {
      ModelSpec model_spec;
      model_spec.default_function.basis = "legendre";
      model_spec.effects = {spec};
      const MeasurementModel model(campaign, model_spec);
      if (!StateMap::is_exact_for(model)) {
        const bool has_free_shape = !model.binding().effects[0].free_shape.empty();
        EXPECT_TRUE(has_free_shape || model.binding().effect_tilts_floor) << spec.kind;
        ++refused;
        continue;
      }
      SCOPED_TRACE(spec.kind);
      expect_sums_of_rows(model, random, 3);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace volcal
