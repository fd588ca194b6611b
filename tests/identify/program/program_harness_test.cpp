// What the fuzzer asserts, on its samples and on damaged ones.

#include "tests/support/program_harness.h"

#include <gtest/gtest.h>

#include <random>

namespace volcal {
namespace {

TEST(ProgramHarness, AcceptsItsSamples) {
  using testing::refusal;
  using testing::rewrite_and_check;
  EXPECT_EQ(refusal([] { rewrite_and_check(testing::sample_program(), 2); }), "");
  EXPECT_EQ(refusal([] { rewrite_and_check(testing::sample_local_program(), 0); }), "");
}

/// Characters replaced, removed and doubled: accepted and right, or refused with a remedy.
TEST(ProgramHarness, SurvivesDamage) {
  std::mt19937_64 random(17);
  const std::string letters = "GXYZIJKRPQLHFMNST0123456789.-+ ()/%;#[]\nABCUVWDEO";
  int accepted = 0;
  constexpr int kRounds = 3000;
  for (int i = 0; i < kRounds; ++i) {
    std::string text = i % 2 == 0 ? testing::sample_program() : testing::sample_local_program();
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int k = 0; k < changes; ++k) {
      const std::size_t at = random() % text.size();
      const char letter = letters[random() % letters.size()];
      if (random() % 3 == 0) {
        text.erase(at, 1);
      } else if (random() % 2 == 0) {
        text.insert(at, 1, letter);
      } else {
        text[at] = letter;
      }
    }
    if (testing::accepts_program(text, static_cast<unsigned>(random() % 8))) ++accepted;
  }
  EXPECT_GT(accepted, kRounds / 50);
  EXPECT_LT(accepted, kRounds);
}

}  // namespace
}  // namespace volcal
