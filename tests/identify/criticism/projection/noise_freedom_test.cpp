// Degrees of freedom of a test against the exact F test of a balanced one-way layout: lines of equally many
// readings, an offset for each line, a constant for all. What is constant within a line stands on the scatter
// of the lines' means, L - 1 degrees of freedom; what sums to zero within every line stands on the scatter
// about them, L (n - 1) (Scheffe 1959, The Analysis of Variance, 7.2).

#include "volcal/identify/criticism/projection/noise_freedom.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace volcal {
namespace {

constexpr Eigen::Index kLines = 24;
constexpr Eigen::Index kReadings = 8;  // of a line
constexpr Eigen::Index kAll = kLines * kReadings;
constexpr double kWhiteSigma = 1e-6;

NoiseProblem balanced_layout(double line_offset) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  NoiseProblem problem;
  NoiseSequence sequence;
  problem.jacobian = Eigen::MatrixXd::Ones(kAll, 1);
  problem.residual.resize(kAll);
  double offset = 0.0;
  for (Eigen::Index i = 0; i < kAll; ++i) {
    if (i % kReadings == 0) offset = line_offset * normal(random);
    sequence.observation.push_back(static_cast<std::size_t>(i));
    sequence.line.push_back(static_cast<std::int32_t>(i / kReadings));
    problem.data.sigma.push_back(kWhiteSigma);
    problem.residual[i] = offset + kWhiteSigma * normal(random);
  }
  problem.data.sequences.push_back(sequence);
  return problem;
}

double freedom_of(const Eigen::VectorXd& moved, double line_offset) {
  const NoiseProblem problem = balanced_layout(line_offset);
  const NoiseEstimate estimate = estimate_noise(problem);
  const auto projector_of = [&](const std::vector<NoiseParameters>& noise) {
    return std::make_unique<Projector>(problem, problem.data, noise, 1);
  };
  return noise_freedom(moved, *projector_of(estimate.parameters()), estimate, projector_of).at(0);
}

/// Rises from line to line.
Eigen::VectorXd between_lines() {
  Eigen::VectorXd moved(kAll);
  for (Eigen::Index line = 0; line < kLines; ++line)
    moved.segment(line * kReadings, kReadings).setConstant(1e-6 * static_cast<double>(line));
  return moved;
}

/// Alternates within every line.
Eigen::VectorXd within_lines() {
  return Eigen::VectorXd::NullaryExpr(kAll, [](Eigen::Index i) { return i % 2 == 0 ? 1e-6 : -1e-6; });
}

TEST(NoiseFreedom, BetweenLinesIsThatOfTheirMeans) {
  EXPECT_NEAR(freedom_of(between_lines(), 2e-6), static_cast<double>(kLines - 1), 2.5);
}

TEST(NoiseFreedom, WithinLinesIsThatOfTheScatterAboutTheirMeans) {
  EXPECT_NEAR(freedom_of(within_lines(), 2e-6), static_cast<double>(kLines * (kReadings - 1)), 8.0);
}

TEST(NoiseFreedom, IsUnlimitedWhereNoiseIsWhite) {
  EXPECT_TRUE(std::isinf(freedom_of(between_lines(), 0.0)));
}

TEST(NoiseFreedom, IsTheSameWhateverTheSizeOfTheDisplacement) {
  EXPECT_DOUBLE_EQ(freedom_of(between_lines(), 2e-6), freedom_of(8.0 * between_lines(), 2e-6));
}

}  // namespace
}  // namespace volcal
