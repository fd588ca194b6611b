#pragma once
/// Numbers of up to kLanes readings side by side, for loops that the compiler turns into vector instructions.
/// Sums and products of lanes are the same to the bit for every instruction set: nothing is reordered and
/// nothing contracted.

#include <cstdint>

namespace volcal {

inline constexpr int kLanes = 64;

struct alignas(64) Lanes {
  double value[kLanes];

  double& operator[](int lane) { return value[lane]; }
  double operator[](int lane) const { return value[lane]; }
  void fill(double number) {
    for (double& v : value) v = number;
  }
};

/// to += number
void add_number(double number, Lanes& to);
/// to += table[place]
void add_entries(const double* table, const std::int32_t* place, Lanes& to);
/// to += factor * lanes
void add_scaled(const Lanes& lanes, double factor, Lanes& to);
/// to += a * b
void add_product(const Lanes& a, const Lanes& b, Lanes& to);
/// Sums over the lanes, always in the same order: of a * b, of one.
double dot(const Lanes& a, const Lanes& b);
double sum(const Lanes& lanes);
/// to += a x b
void add_cross(const Lanes* a, const Lanes* b, Lanes* to);
/// Of angles in rad.
void find_unit_vectors(const Lanes& angle, Lanes& cosine, Lanes& sine);
/// (a, b) = (c a - s b, s a + c b)
void turn(const Lanes& cosine, const Lanes& sine, Lanes& a, Lanes& b);
/// to = R v, R row by row; with `transposed` R^T v.
void rotate(const Lanes* rotation, const Lanes* v, bool transposed, Lanes* to);

}  // namespace volcal
