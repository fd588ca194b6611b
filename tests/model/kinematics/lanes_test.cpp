// Vector loops give the same bits as the plain processor that every program can run on: the same sources once
// more, for no instruction set but the baseline.

#include "volcal/model/kinematics/lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "volcal/model/kinematics/vector_loops.h"

#define add_number baseline_add_number
#define add_entries baseline_add_entries
#define add_scaled baseline_add_scaled
#define add_product baseline_add_product
#define dot baseline_dot
#define sum baseline_sum
#define add_cross baseline_add_cross
#define rotate baseline_rotate
#define turn baseline_turn
#define find_unit_vectors baseline_find_unit_vectors
#undef VOLCAL_VECTOR_LOOPS
#define VOLCAL_VECTOR_LOOPS
#include "model/kinematics/lanes.cpp"  // NOLINT(bugprone-suspicious-include): compiled a second time on purpose
#undef add_number
#undef add_entries
#undef add_scaled
#undef add_product
#undef dot
#undef sum
#undef add_cross
#undef rotate
#undef turn
#undef find_unit_vectors

namespace volcal {
namespace {

class VectorLoops : public ::testing::Test {
 protected:
  Lanes drawn() {
    std::normal_distribution<double> normal;
    Lanes lanes;
    for (double& value : lanes.value) value = normal(random_) * std::pow(10.0, 3.0 * normal(random_));
    return lanes;
  }
  std::vector<Lanes> drawn(int count) {
    std::vector<Lanes> all(static_cast<std::size_t>(count));
    for (Lanes& lanes : all) lanes = drawn();
    return all;
  }
  static void expect_same_bits(const std::vector<Lanes>& a, const std::vector<Lanes>& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(Lanes)), 0);
  }

  std::mt19937_64 random_{3};
};

TEST_F(VectorLoops, SumsAndProducts) {
  const Lanes a = drawn(), b = drawn(), start = drawn();
  std::vector<double> table(100);
  std::vector<std::int32_t> place(kLanes);
  for (double& entry : table) entry = drawn()[0];
  for (std::int32_t& entry : place) entry = std::uniform_int_distribution<std::int32_t>(0, 99)(random_);
  std::vector<Lanes> by_vector(4, start), plain(4, start);
  add_number(0.1, by_vector[0]);
  baseline_add_number(0.1, plain[0]);
  add_entries(table.data(), place.data(), by_vector[1]);
  baseline_add_entries(table.data(), place.data(), plain[1]);
  add_scaled(a, 0.3, by_vector[2]);
  baseline_add_scaled(a, 0.3, plain[2]);
  add_product(a, b, by_vector[3]);
  baseline_add_product(a, b, plain[3]);
  expect_same_bits(by_vector, plain);
  EXPECT_EQ(dot(a, b), baseline_dot(a, b));
  EXPECT_EQ(sum(a), baseline_sum(a));
}

TEST_F(VectorLoops, CrossProductsAndRotations) {
  const std::vector<Lanes> a = drawn(3), b = drawn(3), rotation = drawn(9), start = drawn(3);
  std::vector<Lanes> by_vector = start, plain = start;
  add_cross(a.data(), b.data(), by_vector.data());
  baseline_add_cross(a.data(), b.data(), plain.data());
  expect_same_bits(by_vector, plain);
  for (const bool transposed : {false, true}) {
    rotate(rotation.data(), a.data(), transposed, by_vector.data());
    baseline_rotate(rotation.data(), a.data(), transposed, plain.data());
    expect_same_bits(by_vector, plain);
  }
}

TEST_F(VectorLoops, UnitVectorsAndTurns) {
  const Lanes angle = drawn(), v = drawn(), w = drawn();
  std::vector<Lanes> by_vector = {angle, angle, v, w}, plain = by_vector;
  find_unit_vectors(angle, by_vector[0], by_vector[1]);
  baseline_find_unit_vectors(angle, plain[0], plain[1]);
  turn(by_vector[0], by_vector[1], by_vector[2], by_vector[3]);
  baseline_turn(plain[0], plain[1], plain[2], plain[3]);
  expect_same_bits(by_vector, plain);
}

// Against the library's functions in long double: rounding of a turn, and of the angle's own size.
TEST(UnitVectors, AreSineAndCosine) {
  std::mt19937_64 random(5);
  constexpr double kRounding = 5e-16;
  for (const double largest : {1e-9, 0.5, 4.0, 100.0, 6e5}) {
    std::uniform_real_distribution<double> uniform(-largest, largest);
    for (int block = 0; block < 50; ++block) {
      Lanes angle, cosine, sine;
      for (double& value : angle.value) value = uniform(random);
      angle[0] = 0.0;
      angle[1] = std::numbers::pi;
      angle[2] = -0.5 * std::numbers::pi;
      angle[3] = 0.25 * std::numbers::pi;
      find_unit_vectors(angle, cosine, sine);
      for (int i = 0; i < kLanes; ++i) {
        const long double exact = angle[i];
        const double tolerance = kRounding * (1.0 + std::abs(angle[i]));
        EXPECT_NEAR(cosine[i], static_cast<double>(std::cos(exact)), tolerance) << angle[i];
        EXPECT_NEAR(sine[i], static_cast<double>(std::sin(exact)), tolerance) << angle[i];
      }
      EXPECT_EQ(cosine[0], 1.0);
      EXPECT_EQ(sine[0], 0.0);
    }
  }
}

TEST(Turns, TurnAVectorAgainstTheClock) {
  Lanes cosine, sine, a, b;
  cosine.fill(0.6);
  sine.fill(0.8);
  a.fill(2.0);
  b.fill(1.0);
  turn(cosine, sine, a, b);
  EXPECT_DOUBLE_EQ(a[0], 0.4);
  EXPECT_DOUBLE_EQ(b[kLanes - 1], 2.2);
}

}  // namespace
}  // namespace volcal
