#pragma once
/// Basis values at the positions that a campaign's readings share. They depend on positions only, and most
/// campaigns visit each position of an axis many times: grids, lines, several set-ups. An axis with more
/// positions than kMaxTabulated has no table, and its values are computed at every reading.

#include <cstdint>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

class PositionTables {
 public:
  static constexpr std::size_t kMaxTabulated = 4096;

  PositionTables(const Campaign& campaign, const ParameterLayout& layout);

  /// Writes the values of group `group`'s active functions at a reading; returns the first active function.
  int evaluate(const FunctionGroup& group, std::size_t group_index, const Setup& setup,
               std::size_t setup_index, std::size_t row, double* values) const {
    const std::size_t axis = index_of(group.axis);
    const int support = group.basis->support();
    const std::vector<std::uint16_t>& entry = entry_[setup_index][axis];
    if (entry.empty()) return group.basis->evaluate(setup.readings.position[axis][row], values);
    const Table& table = tables_[group_index];
    const double* from = table.values.data() + static_cast<std::size_t>(support) * entry[row];
    for (int j = 0; j < support; ++j) values[j] = from[j];
    return table.start[entry[row]];
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
