// Work that is stopped between its items, from within and over threads.

#include "volcal/identify/numeric/interruption.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

struct StoppedWork : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void wait_between() { std::this_thread::sleep_for(Interruption::kBetween / 4); }

class InterruptionOf : public ::testing::TestWithParam<int> {};

TEST_P(InterruptionOf, StopsBetweenItemsOfNestedWork) {
  std::atomic<int> done{0};
  int asked = 0;
  const Interruption guard([&] {
    if (++asked == 3) throw StoppedWork("third time");
  });
  const auto outer = [&](std::size_t) {
    run_parallel(50, 2, [&](std::size_t) {
      wait_between();
      ++done;
    });
  };
  EXPECT_THROW(run_parallel(50, GetParam(), outer), StoppedWork);
  EXPECT_EQ(asked, 3);
  EXPECT_LT(done, 1000) << "of 2500";
  EXPECT_GT(done, 2);
  EXPECT_THROW(Interruption::check(), StoppedWork) << "what has been stopped stays so";
}

INSTANTIATE_TEST_SUITE_P(Threads, InterruptionOf, ::testing::Values(1, 2, 4));

TEST(Interruption, ChangesNothingWhereNobodyStops) {
  std::atomic<std::size_t> sum{0};
  int asked = 0;
  {
    const Interruption guard([&] { ++asked; });
    run_parallel(100, 3, [&](std::size_t item) {
      wait_between();  // so that the thread of the guard takes some of the items
      sum += item;
    });
    EXPECT_GE(asked, 1);
    const Interruption inner([] { throw StoppedWork("inner"); });
    EXPECT_THROW(run_parallel(1, 1, [&](std::size_t) { sum += 1; }), StoppedWork);
  }
  EXPECT_EQ(sum, 4950U);
  const int before = asked;
  std::this_thread::sleep_for(2 * Interruption::kBetween);
  run_parallel(10, 2, [&](std::size_t item) { sum += item; });
  EXPECT_EQ(asked, before) << "behind the guard nobody asks";
}

TEST(Interruption, AnotherThreadsWorkGoesOn) {
  const Interruption guard([] { throw StoppedWork("here"); });
  std::size_t sum = 0;
  std::thread([&] { run_parallel(10, 1, [&](std::size_t item) { sum += item; }); }).join();
  EXPECT_EQ(sum, 45U);
}

}  // namespace
}  // namespace volcal
