#pragma once
/// Vector fields on a grid of three axes that are sums of terms of two axes each, as first-order errors of
/// linear axes are (error_grid.h): three tables of node pairs hold all of it.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace volcal {

/// Field at nodes i, j, k = first_second[i, j] + first_third[i, k] + second_third[j, k]; the second index of
/// a pair is the faster one.
struct PlaneTables {
  std::array<std::size_t, 3> nodes{};  ///< of the axes, slowest first
  std::vector<Eigen::Vector3d> first_second, first_third, second_third;

  explicit PlaneTables(const std::array<std::size_t, 3>& node_counts)
      : nodes(node_counts),
        first_second(nodes[0] * nodes[1]),
        first_third(nodes[0] * nodes[2]),
        second_third(nodes[1] * nodes[2]) {}

  std::size_t size() const { return nodes[0] * nodes[1] * nodes[2]; }
};

/// Samples field(i, j, k) on three planes through the middle of the grid. Exact but for rounding where the
/// field has no term of three axes.
template <class Field>
PlaneTables sample_planes(const std::array<std::size_t, 3>& nodes, const Field& field) {
  PlaneTables tables(nodes);
  if (tables.size() == 0) return tables;
  const std::size_t a = nodes[0] / 2, b = nodes[1] / 2, c = nodes[2] / 2;
  for (std::size_t i = 0; i < nodes[0]; ++i) {
    for (std::size_t j = 0; j < nodes[1]; ++j) tables.first_second[i * nodes[1] + j] = field(i, j, c);
    for (std::size_t k = 0; k < nodes[2]; ++k)
      tables.first_third[i * nodes[2] + k] = field(i, b, k) - tables.first_second[i * nodes[1] + b];
  }
  for (std::size_t j = 0; j < nodes[1]; ++j) {
    for (std::size_t k = 0; k < nodes[2]; ++k) {
      tables.second_third[j * nodes[2] + k] =
          field(a, j, k) - tables.first_second[a * nodes[1] + j] - tables.first_third[a * nodes[2] + k];
    }
  }
  return tables;
}

/// The field at node `first` of the first axis alone.
PlaneTables plane_of(const PlaneTables& tables, std::size_t first);

/// Writes the field at every node, the third axis fastest; `field` has tables.size() entries.
void sum_planes(const PlaneTables& tables, int threads, std::span<Eigen::Vector3d> field);
std::vector<Eigen::Vector3d> sum_planes(const PlaneTables& tables);

}  // namespace volcal
