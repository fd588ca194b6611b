#include "volcal/identify/montecarlo/counter_random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <Random123/uniform.hpp>
#include <cmath>
#include <set>
#include <vector>

namespace volcal {
namespace {

std::vector<double> normals(std::uint64_t seed, std::uint64_t draw, RandomSource source, std::size_t count) {
  std::vector<double> values(count);
  CounterRandom(seed, draw, source).normals(values);
  return values;
}

// Philox4x32-10 of key 0 and counter 0 gives 6627e8d5 e169c58d bc57ac4c 9b00dbd8 (known answers of
// Random123).
TEST(CounterRandom, IsPhilox) {
  double uniform[2];
  CounterRandom(0, 0, RandomSource::Parameters).uniforms(uniform);
  EXPECT_NEAR(uniform[0], std::ldexp(static_cast<double>(0xe169c58d6627e8d5U), -64), 1e-15);
  EXPECT_NEAR(uniform[1], std::ldexp(static_cast<double>(0x9b00dbd8bc57ac4cU), -64), 1e-15);
}

// What Random123 makes of the same counters one at a time.
TEST(CounterRandom, IsRandom123ToTheBit) {
  constexpr std::uint32_t kSeed = 11, kDraw = 23;
  std::vector<double> numbers(2001);
  CounterRandom(kSeed, kDraw, RandomSource::Lines).uniforms(numbers);
  r123::Philox4x32 philox;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto words = philox(
        {{static_cast<std::uint32_t>(i / 2), static_cast<std::uint32_t>(RandomSource::Lines), kDraw, 0}},
        {{kSeed, 0}});
    const std::size_t low = 2 * (i % 2);
    const std::uint64_t whole = static_cast<std::uint64_t>(words[low + 1]) << 32U | words[low];
    EXPECT_EQ(numbers[i], r123::u01<double>(whole)) << i;
  }
}

TEST(CounterRandom, NumberDoesNotDependOnHowManyAreMade) {
  const std::vector<double> few = normals(5, 7, RandomSource::Readings, 5);
  const std::vector<double> many = normals(5, 7, RandomSource::Readings, 1000);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], many[i]);
}

TEST(CounterRandom, SeedsDrawsAndSourcesHaveStreamsOfTheirOwn) {
  std::set<double> first;
  for (const std::uint64_t seed : {1ULL, 2ULL, 1ULL << 32U}) {
    for (const std::uint64_t draw : {0ULL, 1ULL, 1ULL << 32U}) {
      for (const RandomSource source : {RandomSource::Parameters, RandomSource::Readings})
        first.insert(normals(seed, draw, source, 1)[0]);
    }
  }
  EXPECT_EQ(first.size(), 18U);
}

// Moments of 10^6 normal numbers of 1000 draws: mean within 4 / 1000, variance within 4 sqrt(2) / 1000,
// fourth moment 3 within 4 sqrt(96) / 1000; neighbouring draws uncorrelated within 4 / 1000.
TEST(CounterRandom, NormalNumbersAreNormal) {
  constexpr int kDraws = 1000, kCount = 1000;
  double sum = 0.0, squares = 0.0, fourth = 0.0, product = 0.0;
  std::vector<double> before(kCount, 0.0);
  for (int draw = 0; draw < kDraws; ++draw) {
    const std::vector<double> now =
        normals(3, static_cast<std::uint64_t>(draw), RandomSource::Readings, kCount);
    for (std::size_t i = 0; i < now.size(); ++i) {
      sum += now[i];
      squares += now[i] * now[i];
      fourth += std::pow(now[i], 4);
      product += now[i] * before[i];
    }
    before = now;
  }
  constexpr double kNumbers = static_cast<double>(kDraws) * kCount;
  EXPECT_NEAR(sum / kNumbers, 0.0, 4e-3);
  EXPECT_NEAR(squares / kNumbers, 1.0, 5.7e-3);
  EXPECT_NEAR(fourth / kNumbers, 3.0, 0.04);
  EXPECT_NEAR(product / kNumbers, 0.0, 4e-3);
}

}  // namespace
}  // namespace volcal
