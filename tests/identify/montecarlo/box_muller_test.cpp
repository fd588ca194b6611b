// Against the library's functions in long double.

#include "volcal/identify/montecarlo/box_muller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "volcal/model/kinematics/vector_loops.h"

// The same source once more, for no instruction set but the baseline.
#define box_muller baseline_box_muller
#undef VOLCAL_VECTOR_LOOPS
#define VOLCAL_VECTOR_LOOPS
#include "identify/montecarlo/box_muller.cpp"  // NOLINT(bugprone-suspicious-include): compiled a second time
#undef box_muller

namespace volcal {
namespace {

constexpr double kOfRadius = 1e-15;  // of the radius

void expect_normals(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> cosine = first, sine = second;
  box_muller(first.size(), cosine.data(), sine.data());
  for (std::size_t i = 0; i < first.size(); ++i) {
    const long double radius = std::sqrt(-2.0L * std::log(static_cast<long double>(first[i])));
    const long double angle = 2.0L * std::numbers::pi_v<long double> * second[i];
    const auto tolerance = static_cast<double>(kOfRadius * radius);
    EXPECT_NEAR(cosine[i], static_cast<double>(radius * std::cos(angle)), tolerance) << first[i] << second[i];
    EXPECT_NEAR(sine[i], static_cast<double>(radius * std::sin(angle)), tolerance) << first[i] << second[i];
  }
}

/// In (0, 1].
std::vector<double> uniform_numbers(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> numbers(10'001);
  for (double& u : numbers) u = 1.0 - uniform(random);
  return numbers;
}

TEST(BoxMuller, IsExactToRoundingForRandomNumbers) { expect_normals(uniform_numbers(1), uniform_numbers(2)); }

TEST(BoxMuller, GivesTheSameBitsOnEveryInstructionSet) {
  std::vector<double> first = uniform_numbers(3), second = uniform_numbers(4);
  std::vector<double> plain_first = first, plain_second = second;
  box_muller(first.size(), first.data(), second.data());
  baseline_box_muller(first.size(), plain_first.data(), plain_second.data());
  EXPECT_EQ(std::memcmp(first.data(), plain_first.data(), first.size() * sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(second.data(), plain_second.data(), second.size() * sizeof(double)), 0);
}

TEST(BoxMuller, IsExactAtTheEdges) {
  const double least = std::ldexp(1.0, -65), half = std::sqrt(0.5);
  expect_normals({1.0, least, 0.5, half, std::nextafter(half, 0.0), std::nextafter(1.0, 0.0), 0.25, 0.1},
                 {1.0, least, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75});
}

}  // namespace
}  // namespace volcal
