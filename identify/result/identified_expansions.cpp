#include "volcal/identify/result/identified_expansions.h"

#include <cmath>

#include "volcal/model/description/parameter_names.h"

namespace volcal {

std::vector<IdentifiedExpansion> identified_expansions(const FitResult& result) {
  std::vector<IdentifiedExpansion> expansions;
  for (const Axis& axis : result.machine.axes) {
    if (!axis.expansion) continue;
    const ParameterBlock* block = result.layout.find_block(expansion_parameter(axis.name));
    if (block == nullptr) continue;
    expansions.push_back({axis.name, axis.expansion->channel, axis.expansion->per_kelvin,
                          axis.expansion->per_kelvin_sigma,
                          axis.expansion->per_kelvin + result.parameters[block->offset],
                          std::sqrt(parameter_variance(result, block->offset))});
  }
  return expansions;
}

}  // namespace volcal
