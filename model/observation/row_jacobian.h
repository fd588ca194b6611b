#pragma once
/// Derivatives of one reading, in the sparse form in which they arise.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/instruments/instrument.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

/// Derivatives of one row (all channels of one reading). Function part: coefficient j of slot s in group g
/// has derivative basis_value[g][j - start] * weight[channel][g-th group's first weight + s]. The tail holds
/// the other parameters: first those that every row of the campaign has (locations, expansions, effects, in
/// the order of their parameters; their number is MeasurementModel::shared_tail_size()), then the row's own.
struct RowJacobian {
  int channels = 0;
  double predicted[kMaxChannels];
  std::vector<JointLever> levers;                ///< per joint, workpiece to tool
  std::vector<int> start;                        ///< per group: first active basis function
  std::vector<double> basis_value;               ///< concatenated supports of the groups
  std::vector<double> weight[kMaxChannels];      ///< concatenated slots of the groups
  std::vector<int> tail_index;                   ///< parameters outside the functions
  std::vector<double> tail_value[kMaxChannels];  ///< their derivatives
};

/// Calls f(parameter, derivative) for every parameter that a row depends on.
template <class F>
void for_each_derivative(const ParameterLayout& layout, const RowJacobian& row, int channel, F f) {
  const double* basis = row.basis_value.data();
  const double* weight = row.weight[channel].data();
  for (std::size_t g = 0; g < layout.groups.size(); ++g) {
    const FunctionGroup& group = layout.groups[g];
    for (int j = 0; j < group.basis->support(); ++j) {
      for (int slot = 0; slot < group.count(); ++slot) {
        f(group.index(row.start[g] + j, slot), basis[j] * weight[slot]);
      }
    }
    basis += group.basis->support();
    weight += group.count();
  }
  for (std::size_t t = 0; t < row.tail_index.size(); ++t) f(row.tail_index[t], row.tail_value[channel][t]);
}

/// Raw parameters that a row depends on, and its derivatives as a dense vector over all parameters.
std::vector<int> touched_parameters(const ParameterLayout& layout, const RowJacobian& row);
Eigen::VectorXd dense_row(const ParameterLayout& layout, const RowJacobian& row, int channel);

}  // namespace volcal
