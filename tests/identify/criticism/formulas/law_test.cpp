// Units of laws by hand.

#include "volcal/identify/criticism/formulas/law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace volcal {
namespace {

/// A law of functions that are picked by their expression with parameters P and Q.
class WrittenLaw {
 public:
  WrittenLaw& times(const std::string& variable, const std::string& text,
                    const std::vector<double>& shape = {}) {
    const double zero = variable.starts_with("T_") ? 20.0 : 0.0;
    const DriverRange& range =
        ranges_.emplace_back(DriverRange{*Variable::parse_written(variable), -100.0, 900.0});
    for (ElementaryFunction& each : elementary_functions(range, zero)) {
      if (each.text({"P", "Q"}) != text) continue;
      law_.factors.push_back({&functions_.emplace_back(std::move(each)), &range});
      law_.shape.insert(law_.shape.end(), shape.begin(), shape.end());
      return *this;
    }
    ADD_FAILURE() << text << " is no function of " << variable;
    return *this;
  }
  const Law& law() const { return law_; }

 private:
  std::deque<DriverRange> ranges_;
  std::deque<ElementaryFunction> functions_;
  Law law_;
};

TEST(LawUnits, ArePowersOfThoseOfTheVariables) {
  WrittenLaw ram;  // EAY += a y (z - p)^2: urad = [a] mm mm^2
  ram.times("y", "y").times("z", "(z - P)^2", {120.34});
  EXPECT_EQ(ram.law().amplitude_unit("urad"), "urad/mm3");
  EXPECT_EQ(ram.law().shape_text(), "p = 120.3 mm");

  WrittenLaw warm;  // EXX += a x (T_column - 20): um = [a] mm K
  warm.times("x", "x").times("T_column", "(T_column - 20)");
  EXPECT_EQ(warm.law().amplitude_unit("um"), "um/mm/K");
  EXPECT_EQ(warm.law().shape_text(), "");

  WrittenLaw turned;  // an angle and a kink
  turned.times("c", "c^3").times("z", "max(0, z - P)", {250.0});
  EXPECT_EQ(turned.law().amplitude_unit("urad"), "urad/deg3/mm");

  WrittenLaw fast;  // a feed in mm/min and a time in s: um = [a] (mm/min) s^2
  fast.times("feed", "feed").times("t", "t^2");
  EXPECT_EQ(fast.law().amplitude_unit("um"), "um min/mm/s2");

  WrittenLaw with_feed;  // mm mm/min
  with_feed.times("x", "x").times("feed", "feed");
  EXPECT_EQ(with_feed.law().amplitude_unit("um"), "um min/mm2");
}

/// Steps, saturations, waves, approaches and directions are numbers.
TEST(LawUnits, OfWhatIsANumberAreThoseOfTheTarget) {
  WrittenLaw saturated;
  saturated.times("T_air", "tanh((T_air - P) / Q)", {21.5, 0.75});
  EXPECT_EQ(saturated.law().amplitude_unit("um"), "um");
  EXPECT_EQ(saturated.law().shape_text(), "p = 21.5 degC, q = 0.75 K");

  WrittenLaw heated;
  heated.times("z", "z").times("t", "(1 - exp(-t / P))", {1800.0});
  EXPECT_EQ(heated.law().amplitude_unit("um"), "um/mm");
  EXPECT_EQ(heated.law().shape_text(), "p = 1800 s");

  WrittenLaw wave;  // the second of two parameters is named after the first
  wave.times("x", "(x > P)", {300.0}).times("feed", "(feed > P)", {2000.0});
  EXPECT_EQ(wave.law().amplitude_unit("um"), "um");
  EXPECT_EQ(wave.law().shape_text(), "p = 300 mm, q = 2000 mm/min");
}

TEST(LawUnits, OfPeriodsAndPlacesInTheirOrder) {
  WrittenLaw wave;
  wave.times("T_air", "sin(2 * pi * (T_air - Q) / P)", {4.0, 21.0});
  EXPECT_EQ(wave.law().shape_text(), "p = 4 K, q = 21 degC");
}

}  // namespace
}  // namespace volcal
