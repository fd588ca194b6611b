#pragma once
/// Small dense products on plain arrays, compiled for several instruction sets and chosen at run time: knot
/// cells hold a few dozen observations, too few for BLAS to be quick. The sums of one product are formed in
/// the order of the observations. This header must stay free of inline code, which the linker could merge
/// across instruction sets.

#include <cstddef>

namespace volcal {

/// Strides of all arrays are multiples of this, so that kernels read and write whole vectors.
inline constexpr int kTileAlignment = 8;

/// Element i of observation k stands at data[k * stride + i].
struct TileRows {
  const double* data;
  std::ptrdiff_t stride;
  int size;
};

/// Element i of observation k stands at a[k * stride + i]; products are column-major. Elements beyond
/// `size`, up to the next multiple of kTileAlignment, are read and written too.
struct TileKernel {
  /// product(i, j) = sum over k of a(i, k) a(j, k) for i <= j < size, added to what is there when `add`;
  /// `product` has the stride of `a`. Some elements below the diagonal are changed as well.
  void (*outer_upper)(const double* a, std::ptrdiff_t stride, int size, int observations, bool add,
                      double* product);
  /// product(i, j) = sum over k of a(i, k) b(j, k), added to what is there when `add`; column j of the
  /// product stands at product + j * stride.
  void (*multiply)(const TileRows& a, const TileRows& b, int observations, bool add, double* product,
                   std::ptrdiff_t stride);
  /// to(i, j) += from(i, j), i < rows, j < columns; i <= j only when `upper`.
  void (*add)(const double* from, std::ptrdiff_t from_stride, int rows, int columns, bool upper, double* to,
              std::ptrdiff_t to_stride);
};

enum class InstructionSet { Plain, Avx2, Avx512 };
/// Null when this processor does not run it.
const TileKernel* tile_kernel_for(InstructionSet set);
/// The fastest kernel that this processor runs.
const TileKernel& tile_kernel();

}  // namespace volcal
