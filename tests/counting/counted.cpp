/// Suites that end in every way there is, for counting_test.py; no suite of the project.

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace {

TEST(Passes, Once) { EXPECT_EQ(1 + 1, 2); }
TEST(Passes, Twice) { EXPECT_EQ(2 + 2, 4); }

TEST(Fails, Passes) { SUCCEED(); }
TEST(Fails, Fails) { EXPECT_EQ(1 + 1, 3); }
TEST(Fails, IsSkipped) { GTEST_SKIP() << "for a reason"; }

TEST(Crashes, Passes) { SUCCEED(); }
TEST(Crashes, Fails) { FAIL(); }
TEST(Crashes, Here) { std::raise(SIGKILL); }
TEST(Crashes, IsNeverRun) { SUCCEED(); }

TEST(EndsEarly, WithSuccess) { std::exit(0); }
TEST(EndsEarly, IsNeverRun) { SUCCEED(); }

class Sharded : public ::testing::TestWithParam<int> {};
TEST_P(Sharded, Passes) { EXPECT_GE(GetParam(), 0); }
INSTANTIATE_TEST_SUITE_P(Numbers, Sharded, ::testing::Range(0, 5));

template <typename Number>
class OfType : public ::testing::Test {};
using Numbers = ::testing::Types<int, double>;
TYPED_TEST_SUITE(OfType, Numbers);
TYPED_TEST(OfType, Passes) { EXPECT_EQ(TypeParam(1) + TypeParam(1), TypeParam(2)); }

}  // namespace
