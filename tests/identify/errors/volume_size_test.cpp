#include "volcal/identify/errors/volume/volume_size.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/random_matrix.h"
#include "tests/support/random_results.h"
#include "volcal/identify/errors/volume/error_budget.h"

namespace volcal {
namespace {

using testing_support::machine_of;

constexpr int kFewCells = 4;

/// `d`: a deviation of the parameters, which the budget of a result that has it is asked about.
void expect_size_of_budget(const FitResult& result, const VolumeSize& size, const Eigen::VectorXd& d) {
  FitResult shifted = result;
  shifted.parameters += d;
  const BudgetLine wanted = error_budget(shifted, shifted.machine.tools[0], {}, kFewCells).total;
  const VolumeSize::Sizes sizes = size.sizes((size.rows() * d).transpose());
  EXPECT_NEAR(sizes.rms[0], wanted.rms, 1e-12);
  EXPECT_NEAR(sizes.largest[0], wanted.max, 1e-12);
}

/// `root`: of the covariance.
void expect_sizes_of_budgets(FitResult result, const Eigen::MatrixXd& root) {
  result.covariance = root * root.transpose();
  const VolumeSize size(result, result.machine.tools[0], {}, kFewCells);
  const BudgetLine total = error_budget(result, result.machine.tools[0], {}, kFewCells).total;
  EXPECT_NEAR(size.rms(), total.rms, 1e-12);
  EXPECT_NEAR(size.largest(), total.max, 1e-12);
  EXPECT_NEAR(size.u(), total.u_rms, 1e-9 * total.u_rms);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < 5; ++draw) {
    const Eigen::VectorXd n = Eigen::VectorXd::NullaryExpr(root.cols(), [&] { return normal(random); });
    expect_size_of_budget(result, size, root * n);
  }
  const Eigen::VectorXd little = 1e-5 * root.col(0);  // what is left of second order is below 1e-10 of u
  const VolumeSize::Sizes sizes = size.sizes((size.rows() * little).transpose());
  EXPECT_NEAR(sizes.rms[0] - size.rms(), size.rms_row().dot(little), 1e-8 * total.u_rms);
  EXPECT_NEAR(sizes.largest[0] - size.largest(), size.largest_row().dot(little), 1e-8 * total.u_rms);
}

TEST(VolumeSize, IsThatOfTheBudgetWhateverTheParameters) {
  std::mt19937_64 random(3);
  for (const char* structure : {"wX'bYZt", "wbXYZt", "wY'bXZt"}) {
    const FitResult result = testing_support::random_result(machine_of(structure), random);
    const Eigen::Index size = result.layout.size;
    expect_sizes_of_budgets(result, 1e-6 * test::random_matrix(random, size, size));
  }
}

TEST(VolumeSize, IsOverTheTravelOfRotaryAxesWithErrors) {
  std::mt19937_64 random(4);
  const FitResult result = testing_support::random_result(machine_of("wC'A'bXYZt"), random);
  const Eigen::Index size = result.layout.size;
  expect_sizes_of_budgets(result, 1e-7 * test::random_matrix(random, size, size));
}

TEST(VolumeSize, KnowsBothDirectionsOfApproach) {
  Machine machine = machine_of("wX'bYZt");
  machine.tools = {{"side", {0.1, 0.05, -0.2}, 0.0}};
  const auto bend = [](double q) { return 5e-6 * q * q; };
  const FitResult result = testing::result_with(machine,
                                                {.functions = {{"EXX", bend}, {"EBY", bend}},
                                                 .locations = {{"EC0Y", 1e-6}},
                                                 .reversals = {{"EXX", 4e-6}, {"EBY", 3e-6}}},
                                                5);
  std::mt19937_64 random(7);
  expect_sizes_of_budgets(result, 1e-6 * test::random_matrix(random, result.layout.size, 3));
}

/// Without errors there is no slope, and sizes of draws are those of their own errors.
TEST(VolumeSize, IsThatOfTheBudgetWhereNoErrorWasFound) {
  Machine machine = machine_of("wX'bYZt");
  machine.tools = {{"side", {0.1, 0.05, -0.2}, 0.0}};
  const auto none = [](double) { return 0.0; };
  FitResult result = testing::result_with(machine, {.functions = {{"EXX", none}, {"EBY", none}}}, 5);
  result.covariance.diagonal().setConstant(1e-12);
  const VolumeSize size(result, machine.tools[0], {}, kFewCells);
  EXPECT_EQ(size.rms(), 0.0);
  EXPECT_EQ(size.largest(), 0.0);
  EXPECT_TRUE(size.rms_row().isZero(0.0));
  EXPECT_GT(size.u(), 0.0);
  std::mt19937_64 random(9);
  expect_size_of_budget(result, size, 1e-6 * test::random_matrix(random, result.layout.size, 1));
}

/// Where errors are known well few poses can have the largest.
TEST(VolumeSize, NeedsFewQuantitiesWhereErrorsAreKnownWell) {
  std::mt19937_64 random(3);
  FitResult result = testing_support::random_result(machine_of("wX'bYZt"), random);
  const Eigen::Index before = VolumeSize(result, result.machine.tools[0], {}, kFewCells).rows().rows();
  result.covariance *= 1e-6;
  const Eigen::Index after = VolumeSize(result, result.machine.tools[0], {}, kFewCells).rows().rows();
  EXPECT_LT(after, before);
  EXPECT_LE(after, result.layout.size + 9);
}

}  // namespace
}  // namespace volcal
