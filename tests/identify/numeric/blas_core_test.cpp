#include "volcal/identify/numeric/blas_core.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

/// Kernels of the program at its last start. OpenBLAS says which it takes when it is loaded: "Core:
/// SkylakeX".
std::string core_of_program(const std::string& environment) {
  const auto run = testing::run_with("env " + environment + " OPENBLAS_VERBOSE=2", "--version");
  const std::string mark = "Core: ";
  const auto last = run.errors.rfind(mark);
  EXPECT_NE(last, std::string::npos) << run.errors;
  if (last == std::string::npos) return "";
  const auto begin = last + mark.size();
  return run.errors.substr(begin, run.errors.find_first_of("\n ", begin) - begin);
}

#if defined(__x86_64__)
TEST(BlasCore, OfTheProgramUsesTheVectorsOfTheProcessor) {
  if (blas_core().empty()) GTEST_SKIP() << "another BLAS";
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    GTEST_SKIP() << "a processor without AVX2";
  EXPECT_NE(core_of_program("-u OPENBLAS_CORETYPE"), "Prescott");
}

/// As where OpenBLAS takes an unknown processor for one of 2004, but asked for.
TEST(BlasCore, OfTheProgramIsWhatTheVariableSays) {
  if (blas_core().empty()) GTEST_SKIP() << "another BLAS";
  EXPECT_EQ(core_of_program("OPENBLAS_CORETYPE=Prescott"), "Prescott");
}
#endif

}  // namespace
}  // namespace volcal
