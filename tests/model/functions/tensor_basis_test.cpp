#include "volcal/model/functions/tensor_basis.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <vector>

namespace volcal {
namespace {

const std::vector<TensorBasis::Side> kSides = {{-100.0, 300.0, 4}, {5.0, 25.0, 3}};

/// Places that fill the ranges, none of them a knot.
std::vector<std::array<double, 2>> inner_places() {
  std::vector<std::array<double, 2>> places;
  for (int i = 0; i < 13; ++i) {
    for (int j = 0; j < 11; ++j) places.push_back({-97.0 + 30.7 * i, 5.3 + 1.83 * j});
  }
  return places;
}

TEST(TensorBasis, HasOneCoefficientPerPairOfSplines) {
  const TensorBasis basis(kSides);
  EXPECT_EQ(basis.size(0), 7);
  EXPECT_EQ(basis.size(1), 6);
  EXPECT_EQ(basis.size(), 42);
}

TEST(TensorBasis, SumsToOneWithinItsRange) {
  const TensorBasis basis(kSides);
  for (const auto& place : inner_places()) EXPECT_NEAR(basis.row(place).sum(), 1.0, 1e-14);
}

/// Coefficients at the Greville abscissae are those of the straight function (de Boor 1978, ch. XI).
TEST(TensorBasis, NodesAreTheCoefficientsOfAStraightFunction) {
  const TensorBasis basis(kSides);
  const Eigen::VectorXd first = basis.nodes(0), second = basis.nodes(1);
  Eigen::VectorXd coefficients(basis.size());
  for (Eigen::Index i = 0; i < first.size(); ++i) {
    for (Eigen::Index j = 0; j < second.size(); ++j)
      coefficients[i * second.size() + j] = (-100.0 + 400.0 * first[i]) * (5.0 + 20.0 * second[j]);
  }
  for (const auto& place : inner_places())
    EXPECT_NEAR(basis.row(place).dot(coefficients), place[0] * place[1], 1e-10);
}

/// Beyond the first range by half a piece and by two of its four pieces: half of it, nothing.
TEST(TensorBasis, FadesOutBeyondItsRangeAndIsHeldWhereAskedFor) {
  const TensorBasis basis(kSides);
  const std::array<double, 2> end = {300.0, 12.0}, near = {350.0, 12.0}, far = {500.0, 12.0};
  EXPECT_FALSE(basis.is_beyond(end));
  EXPECT_TRUE(basis.is_beyond(near));
  EXPECT_TRUE(basis.held_row(near).isApprox(basis.row(end), 1e-14));
  EXPECT_TRUE(basis.row(near).isApprox(0.5 * basis.row(end), 1e-14));
  EXPECT_TRUE(basis.row(far).isZero(0.0));
  EXPECT_TRUE(basis.held_row(far).isApprox(basis.row(end), 1e-14));
}

/// Over equally spaced samples, four per piece: the mean of (i / n)^2 for i = 0 to n is (2 n + 1) / (6 n),
/// with n = 16 along the first variable and 12 along the second.
TEST(TensorBasis, RootMeanSquareIsThatOfItsSamples) {
  const TensorBasis basis(kSides);
  const auto product = [&](bool first, bool second) {
    const Eigen::VectorXd u = basis.nodes(0), v = basis.nodes(1);
    Eigen::VectorXd coefficients(basis.size());
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      for (Eigen::Index j = 0; j < v.size(); ++j)
        coefficients[i * v.size() + j] = (first ? u[i] : 1.0) * (second ? v[j] : 1.0);
    }
    return basis.root_mean_square(coefficients);
  };
  const double of_first = std::sqrt(33.0 / 96.0), of_second = std::sqrt(25.0 / 72.0);
  EXPECT_NEAR(product(false, false), 1.0, 1e-14);
  EXPECT_NEAR(product(true, false), of_first, 1e-14);
  EXPECT_NEAR(product(false, true), of_second, 1e-14);
  EXPECT_NEAR(product(true, true), of_first * of_second, 1e-14);
}

TEST(TensorBasis, HoldsProductsOfCubicsAndNoFourthPower) {
  const TensorBasis basis(kSides);
  const auto places = inner_places();
  const auto miss = [&](int power) {
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(places.size()), basis.size());
    Eigen::VectorXd values(rows.rows());
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double x = places[k][0] / 300.0, y = places[k][1] / 25.0;
      rows.row(static_cast<Eigen::Index>(k)) = basis.row(places[k]).transpose();
      values[static_cast<Eigen::Index>(k)] = std::pow(x, power) * (y * y - y);
    }
    return (rows * rows.colPivHouseholderQr().solve(values) - values).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(miss(3), 1e-12);
  EXPECT_GT(miss(4), 1e-5);
}

TEST(TensorBasis, FadesBeyondItsRangeOverOnePiece) {
  const TensorBasis basis(kSides);
  const Eigen::VectorXd edge = basis.row(std::array{300.0, 11.0});
  EXPECT_TRUE(basis.row(std::array{350.0, 11.0}).isApprox(0.5 * edge, 1e-12));
  EXPECT_TRUE(basis.row(std::array{400.0, 11.0}).isZero(0.0));
  EXPECT_TRUE(basis.row(std::array{-250.0, 11.0}).isZero(0.0));
  EXPECT_NEAR(basis.row(std::array{300.0, 25.0 + 20.0 / 6.0}).sum(), 0.5, 1e-12);
}

TEST(TensorBasis, SamplesAreTheFunctionsOfOneVariable) {
  const TensorBasis basis(kSides);
  const Eigen::MatrixXd samples = basis.samples(1);
  EXPECT_EQ(samples.cols(), 6);
  EXPECT_NEAR(samples(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(samples(samples.rows() - 1, 5), 1.0, 1e-14);
  EXPECT_TRUE(samples.rowwise().sum().isOnes(1e-14));
}

}  // namespace
}  // namespace volcal
