// Readings that a fit took for outliers, in the linear model.

#include "volcal/identify/criticism/linear_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/hidden_studies.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(LinearModel, TakesUpReadingsAndLeavesThemOutAgain) {
  testing_support::FittedStudy study(testing_support::hiding({}, {3, 3, 3}));
  for (const std::size_t observation : {4U, 9U, 20U}) study.result.residuals[observation].removed = true;
  LinearModel model(study.simulated.campaign, study.result);
  const auto& sigma = model.problem().data.sigma;
  EXPECT_THAT(model.removed(), ElementsAre(4U, 9U, 20U));
  EXPECT_TRUE(std::isinf(sigma[4]) && std::isinf(sigma[9]) && std::isinf(sigma[20]));
  EXPECT_TRUE(std::isfinite(sigma[5]));

  EXPECT_EQ(model.take_up([](std::size_t observation) { return observation != 9U; }), 2U);
  EXPECT_THAT(model.removed(), ElementsAre(9U));
  EXPECT_EQ(sigma[4], model.stated_sigma()[4]);
  EXPECT_EQ(sigma[20], model.stated_sigma()[20]);
  EXPECT_TRUE(std::isinf(sigma[9]));
  EXPECT_EQ(model.take_up([](std::size_t) { return true; }), 1U);
  EXPECT_THAT(model.removed(), IsEmpty());

  model.return_to_fit();
  EXPECT_THAT(model.removed(), ElementsAre(4U, 9U, 20U));
  EXPECT_TRUE(std::isinf(sigma[4]) && std::isinf(sigma[9]) && std::isinf(sigma[20]));
}

}  // namespace
}  // namespace volcal
