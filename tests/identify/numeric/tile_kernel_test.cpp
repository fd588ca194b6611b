// Tile kernels of every instruction set that this processor runs, against Eigen's products.

#include "volcal/identify/numeric/tile_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

#include "tests/support/random_matrix.h"

namespace volcal {

void PrintTo(InstructionSet set, std::ostream* out) {
  *out << (set == InstructionSet::Plain ? "Plain" : set == InstructionSet::Avx2 ? "Avx2" : "Avx512");
}

namespace {

using Eigen::MatrixXd;

constexpr double kTileRounding = 1e-14;

class TileKernelOn : public ::testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    kernel_ = tile_kernel_for(GetParam());
    if (kernel_ == nullptr) GTEST_SKIP() << "this processor does not run it";
  }

  static int padded(int size) { return (size + kTileAlignment - 1) / kTileAlignment * kTileAlignment; }

  MatrixXd random(Eigen::Index rows, Eigen::Index columns) {
    return test::random_matrix(generator_, rows, columns);
  }

  const TileKernel* kernel_ = nullptr;

 private:
  std::mt19937_64 generator_{1};
};

TEST_P(TileKernelOn, FormsAndAddsOuterProducts) {
  for (const int size : {1, 7, 8, 9, 25, 76, 90}) {
    for (const int observations : {1, 2, 48}) {
      const int stride = padded(size);
      const MatrixXd rows = random(stride, observations);
      const MatrixXd before = random(stride, stride);
      for (const bool add : {false, true}) {
        MatrixXd product = before;
        kernel_->outer_upper(rows.data(), stride, size, observations, add, product.data());
        const MatrixXd expected = (add ? 1.0 : 0.0) * before + rows * rows.transpose();
        const MatrixXd wrong = (product - expected).topLeftCorner(size, size).triangularView<Eigen::Upper>();
        EXPECT_LT(wrong.cwiseAbs().maxCoeff(), kTileRounding * observations) << size << " x " << observations;
      }
    }
  }
}

TEST_P(TileKernelOn, Multiplies) {
  for (const int size : {3, 8, 76, 90}) {
    for (const int columns : {1, 4, 5, 11}) {
      const int stride = padded(size + columns);
      const int observations = 7;
      // Elements past the last row of b are read, not used.
      const MatrixXd a = random(stride, observations + 1);
      const double* b = a.data() + size;
      const int product_stride = stride + 16;
      const MatrixXd before = random(product_stride, padded(columns));
      const MatrixXd used = a.leftCols(observations).topRows(size + columns);
      for (const bool add : {false, true}) {
        MatrixXd product = before;
        kernel_->multiply({a.data(), stride, size + columns}, {b, stride, columns}, observations, add,
                          product.data(), product_stride);
        const MatrixXd expected = (add ? 1.0 : 0.0) * before.topLeftCorner(size + columns, columns) +
                                  used * used.bottomRows(columns).transpose();
        EXPECT_LT((product.topLeftCorner(size + columns, columns) - expected).cwiseAbs().maxCoeff(),
                  kTileRounding * observations)
            << size << " x " << columns;
        EXPECT_TRUE(product.bottomRows(16) == before.bottomRows(16)) << "written beyond the rows";
      }
    }
  }
}

TEST_P(TileKernelOn, AddsBlocksAndLeavesTheRestAlone) {
  for (const int rows : {0, 1, 5, 8, 24, 27}) {
    const MatrixXd from = random(32, 32);
    const MatrixXd before = random(40, 40);
    for (const bool upper : {false, true}) {
      MatrixXd to = before;
      kernel_->add(from.data(), 32, rows, rows, upper, &to(1, 2), 40);
      MatrixXd expected = before;
      for (int c = 0; c < rows; ++c) {
        for (int r = 0; r < (upper ? c + 1 : rows); ++r) expected(1 + r, 2 + c) += from(r, c);
      }
      EXPECT_TRUE(to == expected) << rows << (upper ? " upper" : "");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sets, TileKernelOn,
                         ::testing::Values(InstructionSet::Plain, InstructionSet::Avx2,
                                           InstructionSet::Avx512),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace volcal
