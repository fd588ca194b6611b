#include "volcal/identify/numeric/blas_core.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/program.h"

namespace volcal {
namespace {

TEST(BlasCore, IsNotAskedForWhereTheVariableIsSet) {
  ASSERT_EQ(::setenv("OPENBLAS_CORETYPE", "Haswell", 0), 0);
  EXPECT_EQ(better_blas_core(), std::nullopt);
}

/// OpenBLAS says which kernels it takes when it is loaded (OPENBLAS_VERBOSE=2): "Core: SkylakeX".
TEST(BlasCore, OfTheProgramUsesTheVectorsOfTheProcessor) {
  if (blas_core().empty()) GTEST_SKIP() << "another BLAS";
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    GTEST_SKIP() << "a processor without AVX2";
  const auto run = testing::run_with("env -u OPENBLAS_CORETYPE OPENBLAS_VERBOSE=2", "--version");
  const auto last = run.errors.rfind("Core: ");
  ASSERT_NE(last, std::string::npos) << run.errors;
  EXPECT_NE(run.errors.substr(last, 14), "Core: Prescott");
#endif
}

}  // namespace
}  // namespace volcal
