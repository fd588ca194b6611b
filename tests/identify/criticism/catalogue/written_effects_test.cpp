// Several expressions of the user with their parameters.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

TEST(WrittenEffects, AParameterGoesToTheExpressionsThatUseIt) {
  const auto effects =
      written_effects("--try", {"EXX: sin(x / p)", "EXX: dir_x", "EYY: cos(y / p) * q"}, {"p=30", "q=2+-1"});
  ASSERT_EQ(effects.size(), 3U);
  EXPECT_EQ(effects[0].spec.options.number("p"), 30.0);
  EXPECT_FALSE(effects[1].spec.options.number("p"));
  EXPECT_EQ(effects[2].spec.options.number("p"), 30.0);
  EXPECT_EQ(effects[2].spec.options.number("q_sigma"), 1.0);
}

TEST(WrittenEffects, AParameterThatNoneUsesIsRefused) {
  try {
    written_effects("--try", {"EXX: sin(x / p)", "EXX: dir_x"}, {"p=30", "q=2"});
    ADD_FAILURE() << "q is used by none";
  } catch (const InputError& error) {
    EXPECT_THAT(error.problem(), HasSubstr("no expression of --try uses q"));
  }
  EXPECT_THROW(written_effects("--try", {"EXX: dir_x"}, {"p=30"}), InputError);
  EXPECT_THROW(written_effects("--try", {"EXX: sin(x / p", "EXX: p * x"}, {"p=30"}), InputError);
}

}  // namespace
}  // namespace volcal
