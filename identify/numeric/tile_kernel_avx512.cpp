#include <immintrin.h>

namespace volcal {
namespace {

struct Simd {
  using Vector = __m512d;
  static constexpr int kLanes = 8;
  static constexpr int kColumns = 8;  ///< 3 x 8 sums fill the registers
  static Vector zero() { return _mm512_setzero_pd(); }
  static Vector load(const double* from) { return _mm512_loadu_pd(from); }
  static void store(Vector x, double* to) { _mm512_storeu_pd(to, x); }
  static Vector broadcast(double x) { return _mm512_set1_pd(x); }
  static Vector add(Vector x, Vector y) { return _mm512_add_pd(x, y); }
  static Vector multiply_add(Vector x, Vector y, Vector sum) { return _mm512_fmadd_pd(x, y, sum); }
};

}  // namespace
}  // namespace volcal

#include "volcal/identify/numeric/tile_kernel_impl.h"

namespace volcal {

extern const TileKernel kTileKernelAvx512 = {outer_upper, multiply, add};

}  // namespace volcal
