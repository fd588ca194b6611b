#include "volcal/model/observation/row_jacobian.h"

namespace volcal {

std::vector<int> touched_parameters(const ParameterLayout& layout, const RowJacobian& row) {
  std::vector<int> touched = row.tail_index;
  for (std::size_t g = 0; g < layout.groups.size(); ++g) {
    const FunctionGroup& group = layout.groups[g];
    const int size = group.basis->support() * group.count();
    for (int k = 0; k < size; ++k) touched.push_back(group.index(row.start[g], 0) + k);
  }
  return touched;
}

Eigen::VectorXd dense_row(const ParameterLayout& layout, const RowJacobian& row, int channel) {
  Eigen::VectorXd dense = Eigen::VectorXd::Zero(layout.size);
  const double* basis = row.basis_value.data();
  const double* weight = row.weight[channel].data();
  for (std::size_t g = 0; g < layout.groups.size(); ++g) {
    const FunctionGroup& group = layout.groups[g];
    for (int j = 0; j < group.basis->support(); ++j) {
      for (int slot = 0; slot < group.count(); ++slot) {
        dense[group.index(row.start[g] + j, slot)] = basis[j] * weight[slot];
      }
    }
    basis += group.basis->support();
    weight += group.count();
  }
  for (std::size_t t = 0; t < row.tail_index.size(); ++t)
    dense[row.tail_index[t]] += row.tail_value[channel][t];
  return dense;
}

}  // namespace volcal
