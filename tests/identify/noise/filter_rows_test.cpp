// Steps of the noise filter against those of no instruction set but the baseline.

#include "volcal/identify/noise/filter_rows.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

#include "volcal/model/kinematics/vector_loops.h"

// The same source once more.
#define filter_row baseline_filter_row
#define filter_row_adjoint baseline_filter_row_adjoint
#define scale_row baseline_scale_row
#define add_row baseline_add_row
#undef VOLCAL_VECTOR_LOOPS
#define VOLCAL_VECTOR_LOOPS
#include "identify/noise/filter_rows.cpp"  // NOLINT(bugprone-suspicious-include): compiled a second time
#undef filter_row
#undef filter_row_adjoint
#undef scale_row
#undef add_row

namespace volcal {
namespace {

constexpr FilterStep kStep{.decay = 0.83, .scale = 1.71, .drift_gain = 0.37, .offset_gain = 0.21};
constexpr Eigen::Index kWidths[] = {1, 3, 8, 29, 64};

/// Columns: values, correlated drift, offset.
using State = Eigen::Matrix<double, Eigen::Dynamic, 3>;

State random_state(Eigen::Index width) {
  std::mt19937_64 random(static_cast<std::uint64_t>(width));
  std::normal_distribution<double> normal;
  return State::NullaryExpr(width, 3, [&] { return normal(random); });
}

/// Both change a copy of the same state; equal to the bit, and not what it was.
template <class Step, class Baseline>
void expect_same_bits(const Step& step, const Baseline& baseline) {
  for (const Eigen::Index width : kWidths) {
    const State before = random_state(width);
    State chosen = before, plain = before;
    step(width, chosen.col(0).data(), chosen.col(1).data(), chosen.col(2).data());
    baseline(width, plain.col(0).data(), plain.col(1).data(), plain.col(2).data());
    EXPECT_EQ(chosen, plain) << width;
    EXPECT_NE(chosen, before) << width;
  }
}

using Rows = double*;

TEST(FilterRows, StepsAreTheSameBitsOnEveryInstructionSet) {
  expect_same_bits([](Eigen::Index n, Rows v, Rows w, Rows) { filter_row(kStep, n, v, w); },
                   [](Eigen::Index n, Rows v, Rows w, Rows) { baseline_filter_row(kStep, n, v, w); });
  expect_same_bits([](Eigen::Index n, Rows v, Rows w, Rows o) { filter_row(kStep, n, v, w, o); },
                   [](Eigen::Index n, Rows v, Rows w, Rows o) { baseline_filter_row(kStep, n, v, w, o); });
}

TEST(FilterRows, AdjointStepsAreTheSameBitsOnEveryInstructionSet) {
  expect_same_bits([](Eigen::Index n, Rows v, Rows w, Rows) { filter_row_adjoint(kStep, n, v, w); },
                   [](Eigen::Index n, Rows v, Rows w, Rows) { baseline_filter_row_adjoint(kStep, n, v, w); });
  expect_same_bits(
      [](Eigen::Index n, Rows v, Rows w, Rows o) { filter_row_adjoint(kStep, n, v, w, o); },
      [](Eigen::Index n, Rows v, Rows w, Rows o) { baseline_filter_row_adjoint(kStep, n, v, w, o); });
}

TEST(FilterRows, SumsAreTheSameBitsOnEveryInstructionSet) {
  expect_same_bits([](Eigen::Index n, Rows v, Rows, Rows) { scale_row(0.7, n, v); },
                   [](Eigen::Index n, Rows v, Rows, Rows) { baseline_scale_row(0.7, n, v); });
  expect_same_bits([](Eigen::Index n, Rows v, Rows w, Rows) { add_row(0.7, n, v, w); },
                   [](Eigen::Index n, Rows v, Rows w, Rows) { baseline_add_row(0.7, n, v, w); });
}

}  // namespace
}  // namespace volcal
