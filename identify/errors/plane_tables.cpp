#include "volcal/identify/errors/plane_tables.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/model/kinematics/vector_loops.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace volcal {
namespace {

constexpr std::size_t kPattern = 24;  // numbers: whole vectors of three, whole registers
constexpr std::size_t kBeyondCaches = std::size_t{1} << 22;  // numbers
constexpr std::size_t kLineOfCache = 64;                     // bytes
constexpr std::size_t kTogether = 8;  // nodes of the first axis: rows of the other two stay in the caches

static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));

/// One vector, over and over, from any of its components on.
struct RepeatedVector {
  explicit RepeatedVector(const Eigen::Vector3d& vector) {
    for (std::size_t i = 0; i < kPattern + 3; ++i) value[i] = vector[static_cast<Eigen::Index>(i % 3)];
  }
  double value[kPattern + 3];
};

VOLCAL_VECTOR_LOOPS void add_three(const double* __restrict a, const double* __restrict b,
                                   const double* __restrict repeated, std::size_t count,
                                   double* __restrict sum) {
  std::size_t i = 0;
  for (; i + kPattern <= count; i += kPattern) {
    for (std::size_t k = 0; k < kPattern; ++k) sum[i + k] = a[i + k] + b[i + k] + repeated[k];
  }
  for (std::size_t k = 0; i < count; ++i, ++k) sum[i] = a[i] + b[i] + repeated[k];
}

#if defined(__SSE2__)
/// The same past the caches: lines that are written whole need not be read. `sum` at the start of a line.
VOLCAL_VECTOR_LOOPS std::size_t stream_three(const double* __restrict a, const double* __restrict b,
                                             const double* __restrict repeated, std::size_t count,
                                             double* __restrict sum) {
  std::size_t i = 0;
  for (; i + kPattern <= count; i += kPattern) {
    double part[kPattern];
    for (std::size_t k = 0; k < kPattern; ++k) part[k] = a[i + k] + b[i + k] + repeated[k];
    for (std::size_t k = 0; k < kPattern; k += 2) _mm_stream_pd(sum + i + k, _mm_loadu_pd(part + k));
  }
  return i;
}

void add_three_past_caches(const double* a, const double* b, const RepeatedVector& constant,
                           std::size_t count, double* sum) {
  const std::size_t into_line = reinterpret_cast<std::uintptr_t>(sum) % kLineOfCache;
  const std::size_t before = std::min(count, (kLineOfCache - into_line) % kLineOfCache / sizeof(double));
  add_three(a, b, constant.value, before, sum);
  const double* const repeated = constant.value + before % 3;
  const std::size_t done =
      before + stream_three(a + before, b + before, repeated, count - before, sum + before);
  add_three(a + done, b + done, repeated, count - done, sum + done);
}
#else
void add_three_past_caches(const double* a, const double* b, const RepeatedVector& constant,
                           std::size_t count, double* sum) {
  add_three(a, b, constant.value, count, sum);
}
#endif

void sum_row(const PlaneTables& tables, std::size_t i, std::size_t j, bool past_caches,
             std::span<Eigen::Vector3d> field) {
  const std::size_t second = tables.nodes[1], third = tables.nodes[2];
  const RepeatedVector constant(tables.first_second[i * second + j]);
  const double* const of_first = tables.first_third[i * third].data();
  const double* const of_second = tables.second_third[j * third].data();
  double* const sums = field[(i * second + j) * third].data();
  if (past_caches) {
    add_three_past_caches(of_first, of_second, constant, 3 * third, sums);
  } else {
    add_three(of_first, of_second, constant.value, 3 * third, sums);
  }
}

}  // namespace

PlaneTables plane_of(const PlaneTables& tables, std::size_t first) {
  const std::size_t second = tables.nodes[1], third = tables.nodes[2];
  PlaneTables plane({1, second, third});
  std::copy_n(&tables.first_second[first * second], second, plane.first_second.begin());
  std::copy_n(&tables.first_third[first * third], third, plane.first_third.begin());
  plane.second_third = tables.second_third;
  return plane;
}

void sum_planes(const PlaneTables& tables, int threads, std::span<Eigen::Vector3d> field) {
  if (field.size() != tables.size()) throw std::invalid_argument("as many vectors as nodes are needed");
  if (field.empty()) return;
  const std::size_t first = tables.nodes[0];
  const bool past_caches = 3 * tables.size() > kBeyondCaches;
  run_parallel((first + kTogether - 1) / kTogether, past_caches ? threads : 1, [&](std::size_t part) {
    const std::size_t end = std::min(first, (part + 1) * kTogether);
    for (std::size_t j = 0; j < tables.nodes[1]; ++j) {
      for (std::size_t i = part * kTogether; i < end; ++i) sum_row(tables, i, j, past_caches, field);
    }
#if defined(__SSE2__)
    if (past_caches) _mm_sfence();
#endif
  });
}

std::vector<Eigen::Vector3d> sum_planes(const PlaneTables& tables) {
  std::vector<Eigen::Vector3d> field(tables.size());
  sum_planes(tables, 1, field);
  return field;
}

}  // namespace volcal
