#pragma once
/// Statistical tests have a short form for every run and the long one for the night.

#include <gtest/gtest.h>

#include <cstdlib>

namespace volcal::testing {

/// VOLCAL_LONG_TESTS=1 scripts/test
inline bool long_tests() { return std::getenv("VOLCAL_LONG_TESTS") != nullptr; }

template <typename T>
T short_or_long(T in_every_run, T for_the_night) {
  return long_tests() ? for_the_night : in_every_run;
}

}  // namespace volcal::testing

/// At the beginning of a test that costs much and whose claim another test of every run makes, too: name it.
#define VOLCAL_FOR_THE_NIGHT(in_every_run) \
  if (!volcal::testing::long_tests())      \
  GTEST_SKIP() << "VOLCAL_LONG_TESTS=1 runs it; in every run: " << (in_every_run)
