#include "volcal/identify/solve/priors/surface_prior.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

#include "tests/support/random_matrix.h"

namespace volcal {
namespace {

TEST(SurfacePriors, ChoosesFromProductsOfLengths) {
  const SurfacePriors priors(TensorBasis({{0.0, 1.0, 4}, {0.0, 1.0, 3}}));
  ASSERT_EQ(priors.shapes().size(), 9u);
  EXPECT_EQ(priors.lengths(0), (std::vector<double>{0.15, 0.15}));
  EXPECT_EQ(priors.lengths(5), (std::vector<double>{0.35, 0.8}));
  EXPECT_EQ(priors.middle(), 4u);
  EXPECT_EQ(priors.neighbours(0), (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(priors.neighbours(4), (std::vector<std::size_t>{3, 5, 1, 7}));
}

/// The covariance of function values, from that of the coefficients.
TEST(SurfacePriors, AFunctionHasUnitVarianceAndTheCorrelationOfMatern) {
  const TensorBasis basis({{0.0, 10.0, 24}});
  const SurfacePriors priors(basis);
  for (std::size_t shape = 2; shape < priors.shapes().size(); ++shape) {
    const Eigen::MatrixXd covariance = priors.shapes()[shape]->precision.inverse();
    const Eigen::MatrixXd samples = basis.samples(0);
    const Eigen::MatrixXd of_values = samples * covariance * samples.transpose();
    EXPECT_NEAR(of_values.diagonal().mean(), 1.0, 1e-9);
    const double length = priors.lengths(shape).front();
    const Eigen::Index middle = samples.rows() / 2, apart = samples.rows() / 4;
    const double s = std::sqrt(5.0) * 0.25 / length;
    const double expected = (1.0 + s + s * s / 3.0) * std::exp(-s);
    // The splines smooth it by a piece, a twenty-fourth of the range.
    EXPECT_NEAR(of_values(middle, middle + apart) / of_values(middle, middle), expected, 0.02) << length;
  }
}

TEST(SurfacePriors, DeterminantsAreThoseOfTheirPrecisions) {
  const SurfacePriors priors(TensorBasis({{0.0, 1.0, 3}, {0.0, 1.0, 2}}));
  for (const auto& shape : priors.shapes()) {
    const Eigen::LLT<Eigen::MatrixXd> factor(shape->precision);
    const Eigen::MatrixXd lower = factor.matrixL();
    EXPECT_NEAR(shape->log_determinant, 2.0 * lower.diagonal().array().log().sum(), 1e-6);
    EXPECT_EQ(shape->rank, 30);
  }
}

/// Readings of f(x, y) beside a model that holds any cubic spline of x: what depends on x alone is imitated,
/// what changes with y is not.
class ImitatedByTheModel : public ::testing::Test {
 protected:
  ImitatedByTheModel() {
    const TensorBasis along_x({{0.0, 1.0, 4}});
    Eigen::MatrixXd own(kSideOfGrid * kSideOfGrid, basis_.size()),
        model(kSideOfGrid * kSideOfGrid, along_x.size());
    for (int i = 0; i < kSideOfGrid; ++i) {
      for (int j = 0; j < kSideOfGrid; ++j) {
        const std::array place = {(i + 0.5) / kSideOfGrid, (j + 0.5) / kSideOfGrid};
        own.row(i * kSideOfGrid + j) = basis_.row(place).transpose();
        model.row(i * kSideOfGrid + j) = along_x.row(std::span(place).first(1)).transpose();
      }
    }
    own_ = 1e12 * own.transpose() * own;
    coupling_ = 1e12 * model.transpose() * own;
    rest_ = 1e12 * model.transpose() * model + 1e6 * Eigen::MatrixXd::Identity(model.cols(), model.cols());
    const SurfacePriors priors(basis_);
    imitated_ = imitated_coefficients(own_, coupling_, rest_,
                                      priors.shapes()[priors.middle()]->precision.inverse() * 25e-12);
  }

  static constexpr int kSideOfGrid = 17;
  TensorBasis basis_{{{0.0, 1.0, 4}, {0.0, 1.0, 3}}};
  Eigen::MatrixXd own_, coupling_, rest_, imitated_;
};

TEST_F(ImitatedByTheModel, IsWhatDependsOnXAlone) {
  ASSERT_EQ(imitated_.cols(), basis_.size(0));
  const Eigen::Index along_y = basis_.size(1);
  for (Eigen::Index k = 0; k < imitated_.cols(); ++k) {
    const Eigen::MatrixXd grid =
        Eigen::Map<const Eigen::MatrixXd>(imitated_.col(k).data(), along_y, basis_.size(0));
    const Eigen::RowVectorXd mean = grid.colwise().mean();
    EXPECT_LT((grid.rowwise() - mean).norm(), 0.1 * grid.norm());  // imitated to 99 %
  }
}

TEST_F(ImitatedByTheModel, IsHeldAtZeroAndNothingElseIs) {
  const SurfacePriors plain(basis_), held = plain.without(imitated_);
  const PriorShape &before = *plain.shapes()[4], &after = *held.shapes()[4];
  EXPECT_EQ(after.rank, before.rank - static_cast<int>(imitated_.cols()));
  const Eigen::VectorXd of_x = imitated_ * Eigen::VectorXd::Ones(imitated_.cols());
  EXPECT_GT(of_x.dot(after.precision * of_x), 1e3 * of_x.dot(before.precision * of_x));
  // What is orthogonal in the prior's metric costs what it did.
  Eigen::VectorXd other = Eigen::VectorXd::LinSpaced(basis_.size(), -1.0, 2.0).array().cube();
  const Eigen::MatrixXd pull = before.precision * imitated_;
  other -= imitated_ * (imitated_.transpose() * pull).ldlt().solve(pull.transpose() * other);
  EXPECT_NEAR(other.dot(after.precision * other) / other.dot(before.precision * other), 1.0, 1e-4);
}

/// The determinant of the density that remains, in an orthonormal basis of the part that is not held.
TEST_F(ImitatedByTheModel, DeterminantIsThatOfWhatRemains) {
  const SurfacePriors plain(basis_), held = plain.without(imitated_);
  const auto restricted = [&](std::size_t shape) {
    const Eigen::MatrixXd& precision = plain.shapes()[shape]->precision;
    const Eigen::MatrixXd constraint = precision * imitated_;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(constraint);
    const Eigen::MatrixXd all = qr.householderQ();
    const Eigen::MatrixXd free = all.rightCols(all.cols() - imitated_.cols());
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(free.transpose() * precision * free).eigenvalues();
    // Volume of the free directions seen along the imitated ones is the same for all shapes: log|P| -
    // log|U^T P U| = log|F^T P F| + log|F^T Q|^2 with Q orthonormal to U.
    const Eigen::HouseholderQR<Eigen::MatrixXd> of_imitated(imitated_);
    const Eigen::MatrixXd whole = of_imitated.householderQ();
    const Eigen::MatrixXd across = whole.rightCols(whole.cols() - imitated_.cols());
    return values.array().log().sum() - 2.0 * std::log(std::abs((free.transpose() * across).determinant()));
  };
  const double constant = held.shapes()[0]->log_determinant - restricted(0);
  for (const std::size_t shape : {1, 4, 8})
    EXPECT_NEAR(held.shapes()[shape]->log_determinant - restricted(shape), constant,
                1e-3 * std::abs(constant) + 1e-3);
}

}  // namespace
}  // namespace volcal
