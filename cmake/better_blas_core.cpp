/// Prints what OPENBLAS_CORETYPE should be on this machine, or nothing.

#include <cstdio>

#include "volcal/identify/numeric/blas_core.h"

// NOLINTNEXTLINE(readability-identifier-naming): the name is the library's
extern "C" double ddot_(const int* n, const double* x, const int* step_x, const double* y, const int* step_y);

int main() {
  const int one = 1;
  const double x = 1.0;
  if (ddot_(&one, &x, &one, &x, &one) != 1.0) return 1;  // so that the library is linked
  std::fputs(volcal::better_blas_core().value_or("").c_str(), stdout);
  return 0;
}
