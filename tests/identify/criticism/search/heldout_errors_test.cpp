// Errors of prediction against their definition with dense matrices, and against noise that is drawn.

#include "volcal/identify/criticism/search/heldout_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/noise/shared_noise.h"

namespace volcal {
namespace {

constexpr Eigen::Index kOfSetup = 60;
constexpr Eigen::Index kSetups = 2;
constexpr Eigen::Index kHeldoutReadings = kOfSetup * kSetups;
constexpr NoiseParameters kHeldoutNoise{
    .white = 0.9, .drift = 1.3, .tau = 400.0, .line = 0.5, .per_metre = 0.0};

/// A slope that both setups share and an offset of each; lines of eight readings, every fourth held out.
struct Example {
  NoiseProblem problem;
  std::vector<bool> heldout;
  Eigen::MatrixXd sigma = Eigen::MatrixXd::Zero(kHeldoutReadings, kHeldoutReadings);  // by its formula

  Example() {
    problem.jacobian = Eigen::MatrixXd::Zero(kHeldoutReadings, 1 + kSetups);
    problem.residual.setZero(kHeldoutReadings);
    problem.prior_precision = Eigen::Vector3d(2.0, 0.0, 0.0).asDiagonal();
    problem.data.sigma.assign(kHeldoutReadings, 1.0);
    for (Eigen::Index setup = 0; setup < kSetups; ++setup) add_setup(setup);
  }

  void add_setup(Eigen::Index setup) {
    NoiseSequence& sequence = problem.data.sequences.emplace_back();
    for (Eigen::Index i = 0; i < kOfSetup; ++i) {
      const Eigen::Index row = setup * kOfSetup + (i * 7) % kOfSetup;  // not in the order of time
      sequence.observation.push_back(static_cast<std::size_t>(row));
      sequence.time.push_back(4.0 * static_cast<double>(row));
      sequence.line.push_back(static_cast<std::int32_t>(row / 8));
    }
    for (Eigen::Index i = 0; i < kOfSetup; ++i) {
      const Eigen::Index row = setup * kOfSetup + i;
      problem.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
        jacobian(row, 0) = std::sin(0.3 * static_cast<double>(i));
        jacobian(row, 1 + setup) = 1.0;
      });
      heldout.push_back((row / 8) % 4 == 3);
      for (Eigen::Index j = 0; j < kOfSetup; ++j) {
        const Eigen::Index other = setup * kOfSetup + j;
        const double apart = 4.0 * std::abs(static_cast<double>(i - j));
        sigma(row, other) = std::pow(kHeldoutNoise.drift, 2) * std::exp(-apart / kHeldoutNoise.tau);
        if (row / 8 == other / 8) sigma(row, other) += std::pow(kHeldoutNoise.line, 2);
        if (row == other) sigma(row, other) += std::pow(kHeldoutNoise.white, 2);
      }
    }
  }

  std::vector<Eigen::Index> rows(bool held) const {
    std::vector<Eigen::Index> chosen;
    for (std::size_t i = 0; i < heldout.size(); ++i)
      if (heldout[i] == held) chosen.push_back(static_cast<Eigen::Index>(i));
    return chosen;
  }
  Projector projector(const NoiseProblem& of) const {
    return {of, without(of.data, heldout), {&kHeldoutNoise, 1}, 1};
  }
  static RowsOf rows_of(const NoiseProblem& of) {
    return [&of](const std::vector<Eigen::Index>& at) { return of.jacobian(at, Eigen::all).eval(); };
  }
  HeldoutErrors errors(const NoiseProblem& of) const {
    return {of.data,
            heldout,
            {&kHeldoutNoise, 1},
            projector(of),
            rows_of(of),
            [&of](Eigen::Index parameter) { return of.jacobian.col(parameter).eval(); },
            1};
  }
  std::vector<HeldoutBlock> blocks() const { return errors(problem).blocks(); }
};

TEST(SharedNoise, TimesWeightsIsTheProductWithItsCovariance) {
  const Example example;
  const Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(kHeldoutReadings, -1.0, 2.0);
  for (const NoiseSequence& sequence : example.problem.data.sequences) {
    const SharedNoise shared(sequence, kHeldoutNoise);
    const Eigen::VectorXd product = shared.times(weights);
    for (std::size_t i = 0; i < sequence.observation.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(sequence.observation[i]);
      const double own = std::pow(kHeldoutNoise.white, 2) * weights[row];
      EXPECT_NEAR(product[static_cast<Eigen::Index>(i)], example.sigma.row(row).dot(weights) - own, 1e-12);
    }
  }
}

TEST(HeldoutErrors, CovarianceIsThatOfTheDefinition) {
  const Example example;
  const std::vector<Eigen::Index> used = example.rows(false);
  const Eigen::MatrixXd weights =
      example.sigma(used, used).ldlt().solve(example.problem.jacobian(used, Eigen::all));
  const Eigen::MatrixXd information =
      example.problem.jacobian(used, Eigen::all).transpose() * weights + example.problem.prior_precision;
  const Eigen::MatrixXd inverse = information.inverse();
  const std::vector<HeldoutBlock> blocks = example.blocks();
  ASSERT_EQ(blocks.size(), 2U);
  for (const HeldoutBlock& block : blocks) {
    const Eigen::MatrixXd rows = example.problem.jacobian(block.observation, Eigen::all);
    const Eigen::MatrixXd shared = example.sigma(block.observation, used) * weights;
    const Eigen::MatrixXd expected = example.sigma(block.observation, block.observation) +
                                     rows * inverse * rows.transpose() - rows * inverse * shared.transpose() -
                                     shared * inverse * rows.transpose();
    EXPECT_LT((block.lower * block.lower.transpose() - expected).norm(), 1e-10 * expected.norm());
    EXPECT_NEAR(block.expected, expected.trace(), 1e-10 * expected.trace());
    EXPECT_NEAR(block.squares, expected.squaredNorm(), 1e-10 * expected.squaredNorm());
  }
}

/// The example with two further columns.
NoiseProblem with_two_columns(const Example& example) {
  NoiseProblem larger = example.problem;
  const Eigen::Index before = larger.jacobian.cols();
  larger.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.conservativeResize(Eigen::NoChange, before + 2);
    for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
      jacobian(i, before) = std::sin(0.7 * static_cast<double>(i));
      jacobian(i, before + 1) = i % 3 == 0 ? 1.0 : -0.4;
    }
  });
  larger.prior_precision.conservativeResizeLike(Eigen::MatrixXd::Zero(before + 2, before + 2));
  return larger;
}

/// What follows for further columns is what is found of a model that has them.
TEST(HeldoutErrors, AcceptedColumnsGiveThoseOfAModelWithThem) {
  const Example example;
  const NoiseProblem larger = with_two_columns(example);
  const Eigen::MatrixXd columns = larger.jacobian.rightCols(2);
  Projector projector = example.projector(example.problem);
  projector.accept(columns.leftCols(1));
  projector.accept(columns.rightCols(1));
  const Eigen::VectorXd residual = Eigen::VectorXd::LinSpaced(kHeldoutReadings, -2.0, 3.0).array().sin();
  const HeldoutFigures expected = heldout_figures(example.errors(larger).blocks(), residual);
  const HeldoutFigures without = heldout_figures(example.blocks(), residual);
  HeldoutErrors::Accepted accepted{columns, projector.last_directions(2), {}};
  accepted.moved = larger.jacobian * accepted.directions;
  const auto found = example.errors(example.problem).figures_accepting(accepted, residual, 2);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->count, expected.count);
  EXPECT_EQ(found->squares, expected.squares);
  EXPECT_NEAR(found->expected, expected.expected, 1e-12 * expected.expected);
  EXPECT_NEAR(found->spread, expected.spread, 1e-12 * expected.spread);
  EXPECT_NEAR(found->log_likelihood, expected.log_likelihood, 1e-10);
  EXPECT_GT(std::abs(found->expected - without.expected), 1e-3 * expected.expected);
  EXPECT_GT(std::abs(found->log_likelihood - without.log_likelihood), 1e-3);
}

/// Correlated drift: what is expected of the squares is what they are, as often as the spread says.
TEST(HeldoutErrors, SquaresOfDrawnNoiseAreAsExpected) {
  constexpr int kDraws = 400;
  Example example;
  const Eigen::MatrixXd root = example.sigma.llt().matrixL();
  const std::vector<HeldoutBlock> blocks = example.blocks();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double mean = 0.0, squares = 0.0;
  HeldoutFigures figures;
  for (int draw = 0; draw < kDraws; ++draw) {
    NoiseProblem problem = example.problem;
    problem.residual = root * Eigen::VectorXd::NullaryExpr(kHeldoutReadings, [&] { return normal(random); });
    problem.residual += problem.jacobian.col(0) * normal(random) / std::sqrt(2.0);  // drawn from its prior
    const Eigen::VectorXd left = problem.residual - problem.jacobian * example.projector(problem).solution();
    figures = heldout_figures(blocks, left);
    mean += figures.squares / kDraws;
    squares += figures.squares * figures.squares / kDraws;
  }
  const double deviation = std::sqrt(squares - mean * mean);
  EXPECT_NEAR(mean, figures.expected, 4.0 * deviation / std::sqrt(double{kDraws}));
  EXPECT_NEAR(deviation, figures.spread, 0.2 * figures.spread);
  // As if the held-out readings had correlated drift of their own: half as much again.
  const double apart = figures.count * (std::pow(kHeldoutNoise.white, 2) + std::pow(kHeldoutNoise.drift, 2));
  EXPECT_LT(figures.expected, 0.8 * apart);
}

}  // namespace
}  // namespace volcal
