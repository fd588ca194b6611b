#include "volcal/model/kinematics/lanes.h"

#include <numbers>

#include "volcal/model/kinematics/unit_vector.h"
#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {

VOLCAL_VECTOR_LOOPS void add_number(double number, Lanes& to) {
  for (double& v : to.value) v += number;
}

VOLCAL_VECTOR_LOOPS void add_entries(const double* __restrict table, const std::int32_t* __restrict place,
                                     Lanes& __restrict to) {
  for (int i = 0; i < kLanes; ++i) to.value[i] += table[place[i]];
}

VOLCAL_VECTOR_LOOPS void add_scaled(const Lanes& lanes, double factor, Lanes& to) {
  for (int i = 0; i < kLanes; ++i) to.value[i] += factor * lanes.value[i];
}

VOLCAL_VECTOR_LOOPS void add_product(const Lanes& a, const Lanes& b, Lanes& to) {
  for (int i = 0; i < kLanes; ++i) to.value[i] += a.value[i] * b.value[i];
}

VOLCAL_VECTOR_LOOPS double dot(const Lanes& a, const Lanes& b) {
  constexpr int kParts = 16;
  double part[kParts] = {};
  for (int i = 0; i < kLanes; i += kParts) {
    for (int j = 0; j < kParts; ++j) part[j] += a.value[i + j] * b.value[i + j];
  }
  for (int half = kParts / 2; half > 0; half /= 2) {
    for (int j = 0; j < half; ++j) part[j] += part[j + half];
  }
  return part[0];
}

double sum(const Lanes& lanes) {
  Lanes ones;
  ones.fill(1.0);
  return dot(lanes, ones);
}

VOLCAL_VECTOR_LOOPS void add_cross(const Lanes* __restrict a, const Lanes* __restrict b,
                                   Lanes* __restrict to) {
  for (int i = 0; i < kLanes; ++i) {
    const double ax = a[0].value[i], ay = a[1].value[i], az = a[2].value[i];
    const double bx = b[0].value[i], by = b[1].value[i], bz = b[2].value[i];
    to[0].value[i] += ay * bz - az * by;
    to[1].value[i] += az * bx - ax * bz;
    to[2].value[i] += ax * by - ay * bx;
  }
}

VOLCAL_VECTOR_LOOPS void find_unit_vectors(const Lanes& __restrict angle, Lanes& __restrict cosine,
                                           Lanes& __restrict sine) {
  for (int i = 0; i < kLanes; ++i) {
    const UnitVector unit = unit_vector(angle.value[i] / (2.0 * std::numbers::pi));
    cosine.value[i] = unit.cosine;
    sine.value[i] = unit.sine;
  }
}

VOLCAL_VECTOR_LOOPS void turn(const Lanes& __restrict cosine, const Lanes& __restrict sine,
                              Lanes& __restrict a, Lanes& __restrict b) {
  for (int i = 0; i < kLanes; ++i) {
    const double before = a.value[i];
    a.value[i] = cosine.value[i] * before - sine.value[i] * b.value[i];
    b.value[i] = sine.value[i] * before + cosine.value[i] * b.value[i];
  }
}

VOLCAL_VECTOR_LOOPS void rotate(const Lanes* __restrict rotation, const Lanes* __restrict v, bool transposed,
                                Lanes* __restrict to) {
  const std::ptrdiff_t down = transposed ? 1 : 3, across = transposed ? 3 : 1;
  for (int row = 0; row < 3; ++row) {
    const Lanes* const r = rotation + down * row;
    for (int i = 0; i < kLanes; ++i) {
      to[row].value[i] = r[0].value[i] * v[0].value[i] + r[across].value[i] * v[1].value[i] +
                         r[2 * across].value[i] * v[2].value[i];
    }
  }
}

}  // namespace volcal
