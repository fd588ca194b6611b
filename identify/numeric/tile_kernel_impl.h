// Body of the tile kernels for one instruction set. Included by one source file per set, which defines
// `Simd`: the vector type and its operations. Everything has internal linkage: the linker must not merge code
// of different instruction sets.

#include "volcal/identify/numeric/tile_kernel.h"

namespace volcal {
namespace {

/// Distances between neighbouring observations of two factors, and columns of their product.
struct Strides {
  std::ptrdiff_t a, b, out;
};

/// out(i, j) (+)= sum over k of a(i, k) b(j, k), kVectors vectors of rows by kColumns columns.
template <int kVectors, int kColumns, bool kAdd>
void multiply_block(const double* a, const double* b, const Strides& stride, int observations, double* out) {
  Simd::Vector sum[kColumns][kVectors];
  for (int c = 0; c < kColumns; ++c) {
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) {
      sum[c][v] = kAdd ? Simd::load(out + c * stride.out + v * Simd::kLanes) : Simd::zero();
    }
  }
  for (int k = 0; k < observations; ++k, a += stride.a, b += stride.b) {
    Simd::Vector rows[kVectors];
    for (std::ptrdiff_t v = 0; v < kVectors; ++v) rows[v] = Simd::load(a + v * Simd::kLanes);
    for (int c = 0; c < kColumns; ++c) {
      const Simd::Vector column = Simd::broadcast(b[c]);
      for (std::ptrdiff_t v = 0; v < kVectors; ++v)
        sum[c][v] = Simd::multiply_add(rows[v], column, sum[c][v]);
    }
  }
  for (int c = 0; c < kColumns; ++c) {
    for (std::ptrdiff_t v = 0; v < kVectors; ++v)
      Simd::store(sum[c][v], out + c * stride.out + v * Simd::kLanes);
  }
}

/// All `vectors` vectors of rows by kColumns columns.
template <int kColumns, bool kAdd>
void multiply_columns(const double* a, const double* b, const Strides& stride, int vectors, int observations,
                      double* out) {
  constexpr int kStep = 3;
  int v = 0;
  for (; v + kStep <= vectors; v += kStep) {
    const int row = v * Simd::kLanes;
    multiply_block<kStep, kColumns, kAdd>(a + row, b, stride, observations, out + row);
  }
  const int row = v * Simd::kLanes;
  if (vectors - v == 2) multiply_block<2, kColumns, kAdd>(a + row, b, stride, observations, out + row);
  if (vectors - v == 1) multiply_block<1, kColumns, kAdd>(a + row, b, stride, observations, out + row);
}

inline int vectors_for(int size) { return (size + Simd::kLanes - 1) / Simd::kLanes; }

template <bool kAdd>
void outer_upper(const double* a, std::ptrdiff_t stride, int size, int observations, double* product) {
  for (int column = 0; column < size; column += Simd::kColumns) {
    const int rows = column + Simd::kColumns < size ? column + Simd::kColumns : size;
    multiply_columns<Simd::kColumns, kAdd>(a, a + column, {stride, stride, stride}, vectors_for(rows),
                                           observations, product + column * stride);
  }
}

inline void outer_upper(const double* a, std::ptrdiff_t stride, int size, int observations, bool add,
                        double* product) {
  if (add) {
    outer_upper<true>(a, stride, size, observations, product);
  } else {
    outer_upper<false>(a, stride, size, observations, product);
  }
}

template <bool kAdd>
void multiply(const TileRows& a, const TileRows& b, int observations, double* product,
              std::ptrdiff_t stride) {
  constexpr int kColumns = 4;
  for (int column = 0; column < b.size; column += kColumns) {
    multiply_columns<kColumns, kAdd>(a.data, b.data + column, {a.stride, b.stride, stride},
                                     vectors_for(a.size), observations, product + column * stride);
  }
}

inline void multiply(const TileRows& a, const TileRows& b, int observations, bool add, double* product,
                     std::ptrdiff_t stride) {
  if (add) {
    multiply<true>(a, b, observations, product, stride);
  } else {
    multiply<false>(a, b, observations, product, stride);
  }
}

inline void add(const double* from, std::ptrdiff_t from_stride, int rows, int columns, bool upper, double* to,
                std::ptrdiff_t to_stride) {
  for (int c = 0; c < columns; ++c, from += from_stride, to += to_stride) {
    const int count = upper ? c + 1 : rows;
    int i = 0;
    for (; i + Simd::kLanes <= count; i += Simd::kLanes) {
      Simd::store(Simd::add(Simd::load(to + i), Simd::load(from + i)), to + i);
    }
    for (; i < count; ++i) to[i] += from[i];
  }
}

}  // namespace
}  // namespace volcal
