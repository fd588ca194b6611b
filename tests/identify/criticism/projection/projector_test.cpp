// Projection and score test against a brute-force orthogonal basis of dense, whitened, augmented matrices.

#include "volcal/identify/criticism/projection/projector.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>

#include "volcal/identify/criticism/projection/score_statistics.h"

namespace volcal {
namespace {

constexpr Eigen::Index kObservations = 120;
constexpr Eigen::Index kParameters = 7;

Eigen::MatrixXd random_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

NoiseProblem random_problem(std::mt19937_64& random) {
  NoiseProblem problem;
  problem.jacobian = random_matrix(random, kObservations, kParameters);
  problem.residual = random_matrix(random, kObservations, 1);
  const Eigen::MatrixXd root = random_matrix(random, 3, kParameters);
  problem.prior_precision = root.transpose() * root;
  problem.prior_mean = random_matrix(random, kParameters, 1);
  NoiseSequence sequence;
  for (Eigen::Index i = 0; i < kObservations; ++i) {
    sequence.observation.push_back(static_cast<std::size_t>(i));
    sequence.time.push_back(7.0 * static_cast<double>(i));
    sequence.line.push_back(static_cast<std::int32_t>(i / 15));
    problem.data.sigma.push_back(0.8 + 0.1 * static_cast<double>(i % 4));
  }
  problem.data.sequences.push_back(sequence);
  return problem;
}

/// The same by the definition: Sigma from its formula, priors as further observations, an orthogonal basis.
struct BruteForce {
  Eigen::MatrixXd root;      ///< of Sigma
  Eigen::MatrixXd jacobian;  ///< whitened and augmented
  Eigen::VectorXd residual;
  Eigen::MatrixXd prior_root;

  BruteForce(const NoiseProblem& problem, const NoiseParameters& noise) {
    Eigen::MatrixXd sigma(kObservations, kObservations);
    for (Eigen::Index i = 0; i < kObservations; ++i) {
      for (Eigen::Index j = 0; j < kObservations; ++j) {
        const double apart = 7.0 * std::abs(static_cast<double>(i - j));
        sigma(i, j) = noise.drift * noise.drift * std::exp(-apart / noise.tau);
        if (i / 15 == j / 15) sigma(i, j) += noise.line * noise.line;
      }
      sigma(i, i) += std::pow(noise.white * problem.data.sigma[static_cast<std::size_t>(i)], 2);
    }
    root = sigma.llt().matrixL();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(problem.prior_precision);
    prior_root =
        eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
    jacobian = augmented(problem.jacobian, prior_root);
    residual = augmented(problem.residual, prior_root * problem.prior_mean);
  }

  Eigen::MatrixXd augmented(const Eigen::MatrixXd& top, const Eigen::MatrixXd& bottom) const {
    Eigen::MatrixXd all(top.rows() + bottom.rows(), top.cols());
    all << root.triangularView<Eigen::Lower>().solve(top), bottom;
    return all;
  }
  Eigen::MatrixXd projected(const Eigen::MatrixXd& columns) const {
    const Eigen::MatrixXd q =
        jacobian.householderQr().householderQ() * Eigen::MatrixXd::Identity(jacobian.rows(), jacobian.cols());
    return columns - q * (q.transpose() * columns);
  }
};

const NoiseParameters kProjectedNoise{.white = 1.1, .drift = 0.6, .tau = 60.0, .line = 0.4, .per_metre = 0.0};

TEST(Projector, EqualsAnOrthogonalBasis) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    std::mt19937_64 random(seed);
    const NoiseProblem problem = random_problem(random);
    const Eigen::MatrixXd columns = random_matrix(random, kObservations, 3);
    const BruteForce exact(problem, kProjectedNoise);
    const Eigen::MatrixXd remaining = exact.projected(
        exact.augmented(columns, Eigen::MatrixXd::Zero(exact.prior_root.rows(), columns.cols())));
    const Eigen::VectorXd residual = exact.projected(exact.residual);

    const Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 1);
    const ProjectedColumns projected = projector.project(columns);
    EXPECT_LT((projected.gram(0, 3) - remaining.transpose() * remaining).norm(),
              1e-10 * remaining.squaredNorm());
    EXPECT_LT((projected.score - remaining.transpose() * residual).norm(), 1e-9);
    EXPECT_NEAR(projector.residual_squares(), residual.squaredNorm(), 1e-9);

    const ScoreTest test = score_test(projected, 0, 3);
    const Eigen::VectorXd amplitude = remaining.householderQr().solve(residual);
    EXPECT_LT((test.amplitude - amplitude).norm(), 1e-9);
    EXPECT_NEAR(test.lm, (remaining * amplitude).squaredNorm(), 1e-9);
    EXPECT_EQ(test.dof, 3);
  }
}

/// Columns of two groups of three functions each, which depend on 2 of 6 and 3 of 5 positions, datum
/// included.
LocalRows random_local_rows(std::mt19937_64& random, Eigen::MatrixXd& jacobian) {
  using Eigen::Index;
  constexpr Index kFunctions = 3;
  LocalRows local;
  Index column = 0;
  std::vector<Eigen::MatrixXd> dense;
  for (const auto& [positions, support] : {std::pair<Index, Index>{6, 2}, std::pair<Index, Index>{5, 3}}) {
    LocalRows::Group group;
    group.derivatives = random_matrix(random, support * kFunctions, kObservations);
    Eigen::MatrixXd& all = dense.emplace_back(Eigen::MatrixXd::Zero(kObservations, positions * kFunctions));
    std::uniform_int_distribution<Eigen::Index> first(0, positions - support);
    for (Eigen::Index i = 0; i < kObservations; ++i) {
      const Eigen::Index at = first(random) * kFunctions;
      group.first.push_back(local.coefficients + at);
      all.row(i).segment(at, support * kFunctions) = group.derivatives.col(i);
    }
    for (Index function = 0; function < kFunctions; ++function) {
      LocalRows::Combination combination;
      for (Index j = 0; j < positions; ++j)
        combination.coefficients.push_back(static_cast<int>(local.coefficients + j * kFunctions + function));
      combination.basis = random_matrix(random, positions, positions - 1);
      combination.column = column;
      column += combination.basis.cols();
      local.combinations.push_back(std::move(combination));
    }
    local.groups.push_back(std::move(group));
    local.coefficients += positions * kFunctions;
  }
  Eigen::MatrixXd coefficients(kObservations, local.coefficients);
  coefficients << dense[0], dense[1];
  jacobian.resize(kObservations, column);
  for (const LocalRows::Combination& function : local.combinations) {
    jacobian.middleCols(function.column, function.basis.cols()) =
        coefficients(Eigen::all, function.coefficients) * function.basis;
  }
  return local;
}

/// Two sequences in place of one: before observation `half`, and from there.
void cut_in_two(NoiseData& data, Eigen::Index half) {
  NoiseSequence& front = data.sequences.front();
  NoiseSequence back = front;
  front.observation.resize(half), front.time.resize(half), front.line.resize(half);
  back.observation.erase(back.observation.begin(), back.observation.begin() + half);
  back.time.erase(back.time.begin(), back.time.begin() + half);
  back.line.erase(back.line.begin(), back.line.begin() + half);
  data.sequences.push_back(back);
}

/// Columns that are known to be local give what dense ones do, whatever the noise, the parts, the number of
/// candidates and the columns that are not local.
TEST(Projector, LocalColumnsChangeNothing) {
  std::mt19937_64 random(6);
  NoiseProblem problem = random_problem(random);
  const Eigen::MatrixXd others = problem.jacobian;
  Eigen::MatrixXd local_columns;
  const auto local = std::make_shared<LocalRows>(random_local_rows(random, local_columns));
  problem.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.resize(kObservations, local_columns.cols() + others.cols());
    jacobian << local_columns, others;
  });
  const Eigen::Index p = problem.jacobian.cols();
  problem.prior_precision = 0.1 * Eigen::MatrixXd::Identity(p, p);
  problem.prior_mean = random_matrix(random, p, 1);
  const Eigen::Index half = kObservations / 2;
  cut_in_two(problem.data, half);
  problem.data.sigma[11] = std::numeric_limits<double>::infinity();
  NoiseProblem with_local = problem;
  with_local.local = local;
  const NoiseParameters white{.white = 1.1, .drift = 0.0, .tau = 60.0, .line = 0.0, .per_metre = 0.0};
  for (const NoiseParameters& noise : {kProjectedNoise, white}) {
    Projector dense(problem, problem.data, {&noise, 1}, 1);
    Projector fast(with_local, problem.data, {&noise, 1}, 1, {0, half, kObservations});
    for (int accepted = 0; accepted < 2; ++accepted) {
      const Eigen::Index count = kColumnBlock + 5;
      const Eigen::MatrixXd columns = random_matrix(random, kObservations, count);
      const ProjectedColumns expected = dense.project(columns), got = fast.project(columns);
      EXPECT_LT((got.score - expected.score).norm(), 1e-10 * expected.score.norm());
      EXPECT_LT((got.norm - expected.norm).norm(), 1e-12 * expected.norm.norm());
      EXPECT_LT((got.grams[0] - expected.grams[0]).norm(), 1e-10 * expected.grams[0].norm());
      const Eigen::MatrixXd imitation = dense.imitation(columns);
      EXPECT_LT((fast.imitation(columns) - imitation).norm(), 1e-9 * imitation.norm());
      const Eigen::MatrixXd further = random_matrix(random, kObservations, 2);
      dense.accept(further);
      fast.accept(further);
    }
  }
}

/// Parts and groups are a matter of memory.
constexpr Eigen::Index kHalf = kObservations / 2;

/// Cut at kHalf, observation 7 left out.
NoiseProblem problem_in_two_parts(std::mt19937_64& random) {
  NoiseProblem problem = random_problem(random);
  cut_in_two(problem.data, kHalf);
  problem.data.sigma[7] = std::numeric_limits<double>::infinity();
  return problem;
}

TEST(Projector, PartsAndGroupsChangeNothing) {
  std::mt19937_64 random(4);
  const NoiseProblem problem = problem_in_two_parts(random);

  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 5);
  const Projector whole(problem, problem.data, {&kProjectedNoise, 1}, 1);
  const Projector parted(problem, problem.data, {&kProjectedNoise, 1}, 2, {0, kHalf, kObservations});
  const ProjectedColumns expected = whole.project(columns);
  const ProjectedColumns found =
      parted.project({5, {2, 3}, [&](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
                        rows = columns.middleRows(static_cast<Eigen::Index>(part) * kHalf, kHalf);
                      }});
  EXPECT_LT((found.score - expected.score).norm(), 1e-11);
  EXPECT_LT((found.norm - expected.norm).norm(), 1e-11);
  EXPECT_LT((found.gram(0, 2) - expected.gram(0, 2)).norm(), 1e-11);
  EXPECT_LT((found.gram(3, 2) - expected.gram(3, 2)).norm(), 1e-11);
}

/// The model of a problem with further columns, without prior.
NoiseProblem with_columns(const NoiseProblem& problem, const Eigen::MatrixXd& columns) {
  NoiseProblem larger = problem;
  const Eigen::Index before = problem.jacobian.cols(), count = before + columns.cols();
  larger.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.conservativeResize(Eigen::NoChange, count);
    jacobian.rightCols(columns.cols()) = columns;
  });
  larger.prior_precision = Eigen::MatrixXd::Zero(count, count);
  larger.prior_precision.topLeftCorner(before, before) = problem.prior_precision;
  larger.prior_mean = Eigen::VectorXd::Zero(count);
  larger.prior_mean.head(before) = problem.prior_mean;
  return larger;
}

void expect_same_model(const Projector& found, const Projector& expected, std::mt19937_64& random) {
  constexpr double kAlike = 1e-12;
  const Eigen::MatrixXd rows = random_matrix(random, 4, expected.parameters());
  const Eigen::MatrixXd rotated = expected.rotated_rows(rows);
  const Eigen::VectorXd solution = expected.solution();
  EXPECT_LT((found.solution() - solution).norm(), kAlike * solution.norm());
  EXPECT_LT((found.rotated_rows(rows) - rotated).norm(), kAlike * rotated.norm());
  EXPECT_NEAR(found.residual_squares(), expected.residual_squares(), kAlike * expected.residual_squares());
  EXPECT_LT((found.gram() - expected.gram()).norm(), kAlike * expected.gram().norm());
  for (const Eigen::Index last : {1, 2, 3}) {
    EXPECT_LT(((rows * found.last_directions(last)).transpose() - rotated.bottomRows(last)).norm(),
              kAlike * rotated.norm());
  }
}

/// One offset for each setup of a few readings, beside parameters that all of them share.
NoiseProblem problem_of_many_setups(std::mt19937_64& random, Eigen::Index readings) {
  NoiseProblem problem = random_problem(random);
  const NoiseSequence whole = problem.data.sequences.front();
  problem.data.sequences.clear();
  Eigen::MatrixXd offsets = Eigen::MatrixXd::Zero(kObservations, kObservations / readings);
  for (Eigen::Index first = 0; first < kObservations; first += readings) {
    offsets.col(first / readings).segment(first, readings).setOnes();
    NoiseSequence& own = problem.data.sequences.emplace_back();
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(first + readings); ++i) {
      own.observation.push_back(whole.observation[i]);
      own.time.push_back(whole.time[i]);
      own.line.push_back(whole.line[i]);
    }
  }
  return with_columns(problem, offsets);
}

/// Rows of a setup are kept without the parameters of others.
TEST(Projector, ParametersOfOtherSetupsChangeNothing) {
  constexpr Eigen::Index kOfASetup = 5;
  std::mt19937_64 random(9);
  const NoiseProblem problem = problem_of_many_setups(random, kOfASetup);
  std::vector<Eigen::Index> parts;
  for (Eigen::Index first = 0; first <= kObservations; first += kOfASetup) parts.push_back(first);
  Projector whole(problem, problem.data, {&kProjectedNoise, 1}, 1);
  Projector parted(problem, problem.data, {&kProjectedNoise, 1}, 2, parts);
  expect_same_model(parted, whole, random);
  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 3);
  const ProjectedColumns expected = whole.project(columns), found = parted.project(columns);
  EXPECT_LT((found.score - expected.score).norm(), 1e-11);
  EXPECT_LT((found.grams.front() - expected.grams.front()).norm(), 1e-11);
  const Eigen::VectorXd weighed = whole.weighed_residual();
  EXPECT_LT((parted.weighed_residual() - weighed).norm(), 1e-11 * weighed.norm());
  whole.accept(columns);
  parted.accept(columns);
  expect_same_model(parted, whole, random);
}

/// Products with it are scores, also where observations are left out and columns were accepted.
TEST(Projector, WeighedResidualGivesEveryScore) {
  std::mt19937_64 random(7);
  const NoiseProblem problem = problem_in_two_parts(random);
  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 4);
  Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 1, {0, kHalf, kObservations});
  for (const bool accepted : {false, true}) {
    if (accepted) projector.accept(random_matrix(random, kObservations, 2));
    const Eigen::VectorXd weighed = projector.weighed_residual();
    EXPECT_EQ(weighed[7], 0.0);
    EXPECT_LT((columns.transpose() * weighed - projector.project(columns).score).norm(), 1e-10);
  }
}

/// Taken into the model, columns get the amplitudes that the test had estimated, and nothing of them is left.
TEST(Projector, AcceptedColumnsAreExplained) {
  std::mt19937_64 random(5);
  const NoiseProblem problem = random_problem(random);
  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 2);
  Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 1);
  const ScoreTest before = score_test(projector.project(columns), 0, 2);
  const double squares = projector.residual_squares();
  projector.accept(columns);
  EXPECT_LT((projector.solution().tail(2) - before.amplitude).norm(), 1e-10);
  EXPECT_LT((projector.accepted_covariance() - before.covariance).norm(), 1e-10 * before.covariance.norm());
  EXPECT_NEAR(projector.residual_squares(), squares - before.lm, 1e-9);
  const ScoreTest after = score_test(projector.project(columns), 0, 2);
  EXPECT_EQ(after.dof, 0) << "nothing of them is visible beside themselves";
}

/// Accepted one after another, columns give the factor of all, made anew.
TEST(Projector, AcceptedColumnsGiveTheFactorOfAModelWithThem) {
  std::mt19937_64 random(8);
  const NoiseProblem problem = random_problem(random);
  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 3);
  const NoiseProblem larger = with_columns(problem, columns);
  const Projector expected(larger, larger.data, {&kProjectedNoise, 1}, 1);
  Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 1);
  projector.accept(columns.leftCols(1));
  projector.accept(columns.rightCols(2));
  expect_same_model(projector, expected, random);
  EXPECT_TRUE(projector.is_regular());
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(expected.parameters(), expected.parameters());
  const Eigen::MatrixXd rotated = expected.rotated_rows(unit);
  const Eigen::MatrixXd covariance = (rotated.transpose() * rotated).bottomRightCorner(3, 3);
  EXPECT_LT((projector.accepted_covariance() - covariance).norm(), 1e-12 * covariance.norm());
}

/// Where neither readings nor priors determine a parameter, or a column is the model's own, the factor is
/// that of the whole, weakly held.
TEST(Projector, AcceptsColumnsOfAModelThatIsNotDetermined) {
  std::mt19937_64 random(9);
  NoiseProblem problem = random_problem(random);
  problem.prior_precision.setZero();
  Projector own(problem, problem.data, {&kProjectedNoise, 1}, 1);
  EXPECT_TRUE(own.is_regular());
  own.accept(problem.jacobian.col(2));
  EXPECT_TRUE(own.solution().allFinite());
  problem.jacobian.edit([](Eigen::MatrixXd& jacobian) { jacobian.col(3).setZero(); });
  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 2);
  const NoiseProblem larger = with_columns(problem, columns);
  Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 1);
  EXPECT_FALSE(projector.is_regular());
  projector.accept(columns);
  const Projector expected(larger, larger.data, {&kProjectedNoise, 1}, 1);
  EXPECT_LT((projector.solution() - expected.solution()).norm(), 1e-10 * expected.solution().norm());
}

/// Other residuals of the same columns, before and after further ones are accepted.
TEST(Projector, OtherResidualsAreThoseOfAProjectorMadeWithThem) {
  std::mt19937_64 random(10);
  const NoiseProblem problem = problem_in_two_parts(random);
  NoiseProblem other = problem;
  other.residual = random_matrix(random, kObservations, 1);
  const Eigen::MatrixXd columns = random_matrix(random, kObservations, 3);
  const std::vector<Eigen::Index> parts{0, kHalf, kObservations};
  Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 2, parts);
  Projector expected(other, other.data, {&kProjectedNoise, 1}, 1, parts);
  for (const bool accepted : {false, true}) {
    if (accepted) {
      projector.accept(columns);
      expected.accept(columns);
    }
    const Projector found = projector.with_residual(other.residual);
    const ProjectedColumns own = found.project(columns), anew = expected.project(columns);
    EXPECT_LT((found.solution() - expected.solution()).norm(), 1e-12 * expected.solution().norm());
    EXPECT_NEAR(found.residual_squares(), expected.residual_squares(), 1e-12 * expected.residual_squares());
    EXPECT_LT((own.score - anew.score).norm(), 1e-11 * anew.norm.norm());
    const Eigen::VectorXd weighed = expected.weighed_residual();
    EXPECT_LT((found.weighed_residual() - weighed).norm(), 1e-12 * weighed.norm());
    EXPECT_GT((projector.solution() - expected.solution()).norm(), 0.1 * expected.solution().norm());
  }
}

TEST(ScoreTest, AColumnThatTheModelCanImitateIsInvisible) {
  std::mt19937_64 random(6);
  NoiseProblem problem = random_problem(random);
  problem.prior_precision.setZero();
  const Projector projector(problem, problem.data, {&kProjectedNoise, 1}, 1);
  const Eigen::MatrixXd imitated = problem.jacobian * random_matrix(random, kParameters, 1);
  const ScoreTest test = score_test(projector.project(imitated), 0, 1);
  EXPECT_EQ(test.dof, 0);
  EXPECT_LT(test.visible_fraction, 1e-6);
}

}  // namespace
}  // namespace volcal
