#pragma once
/// Quantities of a Monte Carlo study that are shown in one line: the values of one table, one component in
/// the volume of one tool.

#include <string>
#include <vector>

#include "volcal/identify/montecarlo/montecarlo.h"

namespace volcal {

struct QuantityGroup {
  std::string name;
  std::string unit;
  std::vector<std::size_t> values;  ///< indices of MonteCarloResult::quantities
};

std::vector<QuantityGroup> quantity_groups(const MonteCarloResult& result);

}  // namespace volcal
