// The kernel for any processor, and the choice between kernels.

#include "volcal/identify/numeric/tile_kernel.h"

namespace volcal {
namespace {

struct Simd {
  using Vector = double __attribute__((vector_size(2 * sizeof(double))));
  static constexpr int kLanes = 2;
  static constexpr int kColumns = 4;
  static Vector zero() { return Vector{}; }
  static Vector load(const double* from) { return Vector{from[0], from[1]}; }
  static void store(Vector x, double* to) {
    to[0] = x[0];
    to[1] = x[1];
  }
  static Vector broadcast(double x) { return Vector{x, x}; }
  static Vector add(Vector x, Vector y) { return x + y; }
  static Vector multiply_add(Vector x, Vector y, Vector sum) { return x * y + sum; }
};

}  // namespace
}  // namespace volcal

#include "volcal/identify/numeric/tile_kernel_impl.h"

namespace volcal {

#if defined(__x86_64__)
extern const TileKernel kTileKernelAvx2;
extern const TileKernel kTileKernelAvx512;
#endif

const TileKernel* tile_kernel_for(InstructionSet set) {
  static const TileKernel plain = {outer_upper, multiply, add};
#if defined(__x86_64__)
  if (set == InstructionSet::Avx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") ? &kTileKernelAvx512
                                                                                   : nullptr;
  }
  if (set == InstructionSet::Avx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &kTileKernelAvx2 : nullptr;
  }
#endif
  return set == InstructionSet::Plain ? &plain : nullptr;
}

const TileKernel& tile_kernel() {
  static const TileKernel* const fastest = [] {
    const TileKernel* kernel = tile_kernel_for(InstructionSet::Avx512);
    if (kernel == nullptr) kernel = tile_kernel_for(InstructionSet::Avx2);
    if (kernel == nullptr) kernel = tile_kernel_for(InstructionSet::Plain);
    return kernel;
  }();
  return *fastest;
}

}  // namespace volcal
