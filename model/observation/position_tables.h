#pragma once
/// Basis values at the different positions of a campaign's readings. They depend on positions only, and most
/// campaigns visit each position of an axis many times: grids, lines, several set-ups.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

/// Values of a group's functions, one per slot, from the values of its active basis functions.
void function_values(const FunctionGroup& group, int start, const double* basis,
                     const Eigen::VectorXd& parameters, double* values);

/// The values of all functions at the tabulated positions for one parameter vector: [group][position, slot].
using TabulatedFunctions = std::vector<std::vector<double>>;

class PositionTables {
 public:
  /// Beyond `model.measured` functions have the value at the last position that was measured.
  PositionTables(const Campaign& campaign, const ParameterLayout& layout, const ModelSpec& model);

  TabulatedFunctions tabulate(const ParameterLayout& layout, const Eigen::VectorXd& parameters) const;

  /// Which of its axis' positions every reading of a setup has; empty for an axis without functions.
  const std::vector<std::uint32_t>& entries(std::size_t setup, std::size_t axis) const {
    return entry_[setup][axis];
  }
  /// Different positions of a group's axis, over all setups.
  std::size_t positions(std::size_t group) const { return tables_[group].start.size(); }
  /// First active function of a group at a position, and the values of its active functions.
  int start(std::size_t group, std::size_t entry) const { return tables_[group].start[entry]; }
  const double* values(std::size_t group, int support, std::size_t entry) const {
    return tables_[group].values.data() + static_cast<std::size_t>(support) * entry;
  }
  /// Writes the `support` values of a group's active functions; returns the first active function.
  int basis_values(std::size_t group, int support, std::size_t entry, double* values) const {
    const double* from = this->values(group, support, entry);
    if (support == 4) {
      std::copy_n(from, 4, values);
    } else {
      std::copy_n(from, support, values);
    }
    return start(group, entry);
  }

 private:
  struct Table {
    std::vector<int> start;      ///< first active function, per position
    std::vector<double> values;  ///< support() values per position
  };
  std::vector<Table> tables_;                                              ///< per function group
  std::vector<std::array<std::vector<std::uint32_t>, kAxisCount>> entry_;  ///< per setup: of every reading
};

}  // namespace volcal
