// Cosines and sines of many angles against the C library's.

#include "volcal/model/effects/sines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace volcal {
namespace {

constexpr double kWithin = 4e-16;

void expect_those_of_the_library(const std::vector<double>& angles) {
  std::vector<double> cosine(angles.size()), sine(angles.size());
  write_cosines_and_sines(angles.data(), angles.size(), cosine.data(), sine.data());
  double worst = 0.0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    worst = std::max(worst, std::abs(cosine[i] - std::cos(angles[i])));
    worst = std::max(worst, std::abs(sine[i] - std::sin(angles[i])));
  }
  EXPECT_LT(worst, kWithin);
}

TEST(CosinesAndSines, AreThoseOfTheLibrary) {
  std::mt19937_64 random(3);
  for (const double largest : {0.7, 10.0, 2000.0, 9e5}) {
    std::uniform_real_distribution<double> uniform(-largest, largest);
    std::vector<double> angles(20001);
    for (double& angle : angles) angle = uniform(random);
    expect_those_of_the_library(angles);
  }
}

/// Where an angle is next to a multiple of pi/2, of which little is left.
TEST(CosinesAndSines, AreThoseOfTheLibraryAboutMultiplesOfAQuarterTurn) {
  std::vector<double> angles{0.0, -0.0};
  for (int quarters = -300000; quarters <= 300000; quarters += 7) {
    const double angle = quarters * (0.5 * std::numbers::pi);
    angles.insert(angles.end(), {angle, std::nextafter(angle, 1e9), std::nextafter(angle, -1e9),
                                 angle + 0.25 * std::numbers::pi});
  }
  expect_those_of_the_library(angles);
}

/// Beyond what three parts of pi/2 can take, the library answers.
TEST(CosinesAndSines, OfLargeAnglesAreTheLibrarysOwn) {
  const std::vector<double> angles{0.3, 1.5e6, -7e15, std::numeric_limits<double>::infinity()};
  std::vector<double> cosine(angles.size()), sine(angles.size());
  write_cosines_and_sines(angles.data(), angles.size(), cosine.data(), sine.data());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cosine[i], std::cos(angles[i]));
    EXPECT_EQ(sine[i], std::sin(angles[i]));
  }
  EXPECT_TRUE(std::isnan(sine[3]));
}

}  // namespace
}  // namespace volcal
