#include "volcal/identify/noise/noise_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include "tests/support/noise_campaigns.h"
#include "tests/support/random_matrix.h"
#include "volcal/identify/numeric/tile_array.h"

namespace volcal {
namespace {

constexpr double kMissing = std::numeric_limits<double>::infinity();

enum class Lines { None, Following, Resumed };

struct Sample {
  NoiseData data;
  std::vector<NoiseParameters> noise;
};

/// Irregular times (some equal), two instruments, every fifth reading or so missing.
Sample random_sample(std::mt19937_64& generator, Lines lines, bool timed, bool missing) {
  std::uniform_real_distribution<double> uniform;
  Sample sample;
  std::size_t i = 0;
  for (int s = 0; s < 4; ++s) {
    NoiseSequence sequence;
    sequence.group = static_cast<std::size_t>(s % 2);
    double time = 1000.0 * uniform(generator);
    std::int32_t line = 7;
    const int readings = 15 + static_cast<int>(30.0 * uniform(generator));
    for (int k = 0; k < readings; ++k, ++i) {
      time += uniform(generator) < 0.1 ? 0.0 : std::pow(10.0, 3.0 * uniform(generator) - 1.0);
      if (uniform(generator) < 0.25)
        line = lines == Lines::Resumed ? static_cast<int>(5 * uniform(generator)) : line + 1;
      sequence.observation.push_back(i);
      if (timed) sequence.time.push_back(time);
      if (lines != Lines::None) sequence.line.push_back(line);
      sample.data.sigma.push_back(missing && uniform(generator) < 0.2 ? kMissing : 0.2 + uniform(generator));
      sample.data.length.push_back(3.0 * uniform(generator));
    }
    sample.data.sequences.push_back(sequence);
  }
  for (int g = 0; g < 2; ++g) {
    sample.noise.push_back({0.5 + uniform(generator), 2.0 * uniform(generator),
                            1.0 + 50.0 * uniform(generator), 2.0 * uniform(generator), uniform(generator)});
  }
  return sample;
}

struct Dense {
  std::vector<Eigen::Index> kept;
  Eigen::MatrixXd covariance;
};

Dense dense(const Sample& sample) {
  Dense result;
  for (std::size_t i = 0; i < sample.data.sigma.size(); ++i) {
    if (std::isfinite(sample.data.sigma[i])) result.kept.push_back(static_cast<Eigen::Index>(i));
  }
  result.covariance = test::dense_covariance(sample.data, sample.noise)(result.kept, result.kept);
  return result;
}

/// Innovations in time order are the rows of L^-1 v with the Cholesky factor of Sigma.
TEST(Whitener, EqualsDenseCholesky) {
  std::mt19937_64 generator(1);
  for (int k = 0; k < 40; ++k) {
    const Lines lines = k % 3 == 0 ? Lines::None : k % 3 == 1 ? Lines::Following : Lines::Resumed;
    const Sample sample = random_sample(generator, lines, true, k % 2 == 0);
    const auto n = static_cast<Eigen::Index>(sample.data.sigma.size());
    const Eigen::MatrixXd columns = test::random_matrix(generator, n, 3);
    const Whitener whitener(sample.data, sample.noise);
    Eigen::MatrixXd whitened;
    whitener.whiten(columns, whitened, 1);

    const auto [kept, covariance] = dense(sample);
    const Eigen::MatrixXd factor = covariance.llt().matrixL();
    const Eigen::MatrixXd expected =
        factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd(columns(kept, Eigen::all)));
    EXPECT_LT((whitened(kept, Eigen::all) - expected).cwiseAbs().maxCoeff(), 1e-10) << k;
    EXPECT_NEAR(whitener.log_determinant(), 2.0 * factor.diagonal().array().log().sum(),
                1e-10 * static_cast<double>(n));
    EXPECT_EQ(whitener.observations(), kept.size());
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool present = std::isfinite(sample.data.sigma[static_cast<std::size_t>(i)]);
      EXPECT_EQ(whitened.row(i).isZero(0.0), !present);
    }
    const Eigen::VectorXd single = whitener.whiten(Eigen::VectorXd(columns.col(1)));
    EXPECT_EQ(single, whitened.col(1));
  }
}

TEST(Whitener, WeighsNoMoreColumnsThanABlockHolds) {
  std::mt19937_64 generator(5);
  const Sample sample = random_sample(generator, Lines::Following, true, true);
  const auto n = static_cast<Eigen::Index>(sample.data.sigma.size());
  const Whitener whitener(sample.data, sample.noise);
  const Eigen::MatrixXd columns = test::random_matrix(generator, n, kColumnBlock + 1);
  Eigen::MatrixXd whitened = whitener.whiten_part(0, columns), weighed;
  EXPECT_THROW(whitener.weigh_part(0, columns, whitened, weighed), std::exception);
}

/// The filter and its adjoint give Sigma^-1 v, of a column and of a part's columns observation by
/// observation.
TEST(Whitener, WeighsAsTheInverseOfSigma) {
  std::mt19937_64 generator(5);
  for (int k = 0; k < 40; ++k) {
    const Lines lines = k % 3 == 0 ? Lines::None : k % 3 == 1 ? Lines::Following : Lines::Resumed;
    const Sample sample = random_sample(generator, lines, k % 4 != 0, k % 2 == 0);
    const auto n = static_cast<Eigen::Index>(sample.data.sigma.size());
    const Eigen::MatrixXd columns = test::random_matrix(generator, n, 3);
    const Whitener whitener(sample.data, sample.noise);
    const auto [kept, covariance] = dense(sample);
    const Eigen::MatrixXd expected = covariance.llt().solve(Eigen::MatrixXd(columns(kept, Eigen::all)));
    const double largest = expected.cwiseAbs().maxCoeff();
    EXPECT_LT((whitener.weigh(columns.col(1))(kept) - expected.col(1)).cwiseAbs().maxCoeff(), 1e-10 * largest)
        << k;

    Eigen::MatrixXd whitened(static_cast<Eigen::Index>(kept.size()), 3), weighed;
    whitener.weigh_part(0, columns, whitened, weighed);
    EXPECT_LT((whitened - whitener.whiten_part(0, columns)).cwiseAbs().maxCoeff(), 1e-13);
    ASSERT_EQ(weighed.rows(), whole_lines(3));
    EXPECT_TRUE(weighed.bottomRows(whole_lines(3) - 3).isZero(0.0));
    const std::vector<std::size_t> order = whitener.order_of_part(0, n);
    ASSERT_EQ(order.size(), kept.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto place = std::ranges::find(kept, static_cast<Eigen::Index>(order[i])) - kept.begin();
      EXPECT_LT((weighed.col(static_cast<Eigen::Index>(i)).head(3) - expected.row(place).transpose())
                    .cwiseAbs()
                    .maxCoeff(),
                1e-10 * largest)
          << k;
    }
  }
}

/// Any order of the readings, and lines without times, where the filter goes line by line.
TEST(Whitener, AnyOrderAndUntimedLines) {
  std::mt19937_64 generator(2);
  for (int k = 0; k < 20; ++k) {
    Sample sample = random_sample(generator, Lines::Resumed, k % 2 == 0, true);
    for (NoiseSequence& sequence : sample.data.sequences) {
      std::vector<std::size_t> order(sequence.observation.size());
      std::iota(order.begin(), order.end(), 0);
      std::shuffle(order.begin(), order.end(), generator);
      const NoiseSequence sorted = sequence;
      for (std::size_t i = 0; i < order.size(); ++i) {
        sequence.observation[i] = sorted.observation[order[i]];
        if (!sorted.time.empty()) sequence.time[i] = sorted.time[order[i]];
        sequence.line[i] = sorted.line[order[i]];
      }
    }
    const auto n = static_cast<Eigen::Index>(sample.data.sigma.size());
    const Eigen::MatrixXd columns = test::random_matrix(generator, n, 4);
    const Whitener whitener(sample.data, sample.noise);
    const auto [kept, covariance] = dense(sample);
    const Eigen::MatrixXd part = columns(kept, Eigen::all);
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const Eigen::MatrixXd expected = part.transpose() * factor.solve(part);
    Eigen::MatrixXd whitened;
    whitener.whiten(columns, whitened, 1);
    EXPECT_LT((whitened.transpose() * whitened - expected).norm() / expected.norm(), 1e-11);
    EXPECT_LT((whitener.gram(columns.transpose(), 1) - expected).norm() / expected.norm(), 1e-11);
  }
}

/// A part has the same rows, those that are there, sequence by sequence in the order of the filter.
TEST(Whitener, PartsHoldTheRowsThatAreThere) {
  std::mt19937_64 generator(4);
  const Sample sample = random_sample(generator, Lines::Following, true, true);
  const auto n = static_cast<Eigen::Index>(sample.data.sigma.size());
  const Eigen::MatrixXd columns = test::random_matrix(generator, n, 70);
  const Whitener whitener(sample.data, sample.noise);
  Eigen::MatrixXd all;
  whitener.whiten(columns, all, 1);
  const Eigen::MatrixXd part = whitener.whiten_part(0, columns);
  // Sequences follow each other and are in time order.
  const auto present = [&](Eigen::Index first) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = first; i < n; ++i) {
      if (std::isfinite(sample.data.sigma[static_cast<std::size_t>(i)])) rows.push_back(i);
    }
    return rows;
  };
  ASSERT_EQ(part.rows(), static_cast<Eigen::Index>(whitener.observations()));
  EXPECT_LT((part - all(present(0), Eigen::all)).cwiseAbs().maxCoeff(), 1e-13);
  const std::size_t first = sample.data.sequences[2].observation.front();
  const auto last_two = static_cast<Eigen::Index>(first);
  const Eigen::MatrixXd rest = whitener.whiten_part(first, columns.bottomRows(n - last_two));
  ASSERT_EQ(rest.rows(), static_cast<Eigen::Index>(present(last_two).size()));
  EXPECT_LT((rest - all(present(last_two), Eigen::all)).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_THROW(whitener.whiten_part(0, columns.topRows(n / 2)), std::invalid_argument);
}

TEST(Whitener, BlocksThreadsAndPlaceChangeNothing) {
  std::mt19937_64 generator(3);
  const Sample sample = random_sample(generator, Lines::Following, true, true);
  const auto n = static_cast<Eigen::Index>(sample.data.sigma.size());
  const Eigen::MatrixXd columns = test::random_matrix(generator, n, 150);
  Whitener whitener(sample.data, std::vector<NoiseParameters>(2));
  whitener.set_parameters(sample.noise);
  Eigen::MatrixXd one, several, in_place = columns;
  whitener.whiten(columns, one, 1);
  whitener.whiten(columns, several, 3);
  whitener.whiten(in_place, in_place, 2);
  EXPECT_EQ(one, several);
  EXPECT_EQ(one, in_place);
  EXPECT_EQ(whitener.gram(columns.transpose(), 1), whitener.gram(columns.transpose(), 3));
  const Eigen::MatrixXd square = one.transpose() * one;
  EXPECT_LT((whitener.gram(columns.transpose(), 1) - square).norm() / square.norm(), 1e-12);
}

/// By hand: two readings of variance 1 with a common offset of variance 3, Sigma = [4 3; 3 4]:
/// L = [2 0; 1.5 sqrt(1.75)], |Sigma| = 7.
TEST(Whitener, TwoReadingsByHand) {
  const NoiseData data{{{{0, 1}, {}, {4, 4}, 0}}, {1.0, 1.0}, {}};
  const std::vector<NoiseParameters> noise{{1.0, 0.0, 600.0, std::sqrt(3.0), 0.0}};
  const Whitener whitener(data, noise);
  const Eigen::VectorXd white = whitener.whiten(Eigen::VectorXd(Eigen::Vector2d(2.0, 5.0)));
  EXPECT_NEAR(white(0), 1.0, 1e-15);
  EXPECT_NEAR(white(1), 3.5 / std::sqrt(1.75), 1e-14);
  EXPECT_NEAR(whitener.log_determinant(), std::log(7.0), 1e-14);
}

TEST(Whitener, RefusesWhatIsNoNoise) {
  const NoiseData good{{{{0, 1}, {0.0, 1.0}, {}, 0}}, {1.0, 1.0}, {}};
  const std::vector<NoiseParameters> one(1);
  EXPECT_NO_THROW(Whitener(good, one));
  EXPECT_THROW(Whitener(good, {}), std::invalid_argument);
  NoiseData bad = good;
  bad.sigma[1] = 0.0;
  EXPECT_THROW(Whitener(bad, one), std::invalid_argument);
  bad = good;
  bad.sequences[0].observation = {0, 0};
  EXPECT_THROW(Whitener(bad, one), std::invalid_argument);
  bad = good;
  bad.sequences[0].time = {1.0};
  EXPECT_THROW(Whitener(bad, one), std::invalid_argument);
  bad = good;
  bad.length = {1.0};
  EXPECT_THROW(Whitener(bad, one), std::invalid_argument);
  EXPECT_THROW(Whitener(good, std::vector<NoiseParameters>{{1.0, 1.0, 0.0, 0.0, 0.0}}),
               std::invalid_argument);
  EXPECT_THROW(Whitener(good, std::vector<NoiseParameters>{{-1.0, 0.0, 1.0, 0.0, 0.0}}),
               std::invalid_argument);
  EXPECT_THROW(Whitener(good, std::vector<NoiseParameters>{{0.0, 0.0, 1.0, 0.0, 0.0}}),
               std::invalid_argument);
  Eigen::MatrixXd out;
  EXPECT_THROW(Whitener(good, one).whiten(Eigen::MatrixXd::Zero(3, 1), out, 1), std::invalid_argument);
}

/// Many noise models side by side give what each gives by dense algebra.
TEST(Whitener, MisfitsOfManyModels) {
  std::mt19937_64 generator(21);
  std::uniform_real_distribution<double> uniform;
  for (const Lines lines : {Lines::None, Lines::Following}) {
    for (const bool timed : {true, false}) {
      Sample sample = random_sample(generator, lines, timed, true);
      for (NoiseSequence& sequence : sample.data.sequences) sequence.group = 0;
      const Eigen::VectorXd column =
          test::random_matrix(generator, static_cast<Eigen::Index>(sample.data.sigma.size()), 1);
      std::vector<NoiseParameters> noises;
      for (int k = 0; k < 19; ++k) {
        noises.push_back({0.5 + uniform(generator), k % 4 == 0 ? 0.0 : uniform(generator),
                          1.0 + 50.0 * uniform(generator), k % 5 == 0 ? 0.0 : uniform(generator),
                          uniform(generator)});
        if (k % 3 == 0) noises.back().tau = noises.front().tau;
      }
      const Whitener whitener(sample.data, {noises.data(), 1});
      ASSERT_FALSE(whitener.has_open_lines());
      const std::vector<double> found = whitener.misfits(noises, column, 1);
      EXPECT_EQ(found, whitener.misfits(noises, column, 3));
      for (std::size_t k = 0; k < noises.size(); ++k) {
        sample.noise.assign(1, noises[k]);
        const auto [kept, covariance] = dense(sample);
        const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
        const Eigen::VectorXd used = column(kept);
        const double expected = 2.0 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum() +
                                used.dot(factor.solve(used));
        EXPECT_NEAR(found[k], expected, 1e-9 * std::abs(expected)) << k;
      }
    }
  }
}

TEST(Whitener, MisfitsTakeOneLineAtATime) {
  std::mt19937_64 generator(22);
  Sample sample = random_sample(generator, Lines::Resumed, true, false);
  const Eigen::VectorXd column = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(sample.data.sigma.size()));
  const Whitener two_groups(sample.data, sample.noise);
  EXPECT_TRUE(two_groups.has_open_lines());
  EXPECT_THROW(two_groups.misfits(sample.noise, column, 1), std::invalid_argument);
}

}  // namespace
}  // namespace volcal
