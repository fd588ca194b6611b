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
  for_each_derivative(layout, row, channel,
                      [&](int parameter, double derivative) { dense[parameter] += derivative; });
  return dense;
}

}  // namespace volcal
