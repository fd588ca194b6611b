#include <immintrin.h>

namespace volcal {
namespace {

struct Simd {
  using Vector = __m256d;
  static constexpr int kLanes = 4;
  static constexpr int kColumns = 4;  ///< 3 x 4 sums fill the registers
  static Vector zero() { return _mm256_setzero_pd(); }
  static Vector load(const double* from) { return _mm256_loadu_pd(from); }
  static void store(Vector x, double* to) { _mm256_storeu_pd(to, x); }
  static Vector broadcast(double x) { return _mm256_set1_pd(x); }
  static Vector add(Vector x, Vector y) { return _mm256_add_pd(x, y); }
  static Vector multiply_add(Vector x, Vector y, Vector sum) { return _mm256_fmadd_pd(x, y, sum); }
};

}  // namespace
}  // namespace volcal

#include "volcal/identify/numeric/tile_kernel_impl.h"

namespace volcal {

extern const TileKernel kTileKernelAvx2 = {outer_upper, multiply, add};

}  // namespace volcal
