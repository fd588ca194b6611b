#pragma once
/// Basis values at the positions that a campaign's readings share. They depend on positions only, and most
/// campaigns visit each position of an axis many times: grids, lines, several set-ups. An axis with more
/// positions than kMaxTabulated has no table, and its values are computed at every reading.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

/// Values of a group's functions, one per slot, from the values of its active basis functions.
void function_values(const FunctionGroup& group, int start, const double* basis,
                     const Eigen::VectorXd& parameters, double* values);

/// The values of all functions at the tabulated positions for one parameter vector: [group][position, slot].
using TabulatedFunctions = std::vector<std::vector<double>>;

class PositionTables {
 public:
  static constexpr std::size_t kMaxTabulated = 4096;

  PositionTables(const Campaign& campaign, const ParameterLayout& layout);

  TabulatedFunctions tabulate(const ParameterLayout& layout, const Eigen::VectorXd& parameters) const;

  /// Whether there is a table for this axis, and which of its positions a reading has.
  bool has_table(std::size_t setup, std::size_t axis) const { return !entry_[setup][axis].empty(); }
  std::size_t entry(std::size_t setup, std::size_t axis, std::size_t row) const {
    return entry_[setup][axis][row];
  }
  /// Writes the `support` values of a group's active functions; returns the first active function.
  int basis_values(std::size_t group, int support, std::size_t entry, double* values) const {
    const Table& table = tables_[group];
    const double* from = table.values.data() + static_cast<std::size_t>(support) * entry;
    if (support == 4) {
      std::copy_n(from, 4, values);
    } else {
      std::copy_n(from, support, values);
    }
    return table.start[entry];
  }

 private:
  struct Table {
    std::vector<int> start;      ///< first active function, per position
    std::vector<double> values;  ///< support() values per position
  };
  std::vector<Table> tables_;                                              ///< per function group
  std::vector<std::array<std::vector<std::uint16_t>, kAxisCount>> entry_;  ///< per setup: of every reading
};

}  // namespace volcal
