#include "volcal/identify/report/values/quantity_groups.h"

#include <algorithm>

namespace volcal {
namespace {

std::string group_name(const Quantity& quantity) {
  switch (quantity.kind) {
    case QuantityKind::VolumetricError:
      return "volume, " + quantity.functional_point() + ", " + quantity.name;
    case QuantityKind::VolumetricRms:
    case QuantityKind::VolumetricMax:
      return "volume, " + quantity.functional_point() + ", |e| " + quantity.name;
    default:
      return quantity.name;
  }
}

}  // namespace

std::vector<QuantityGroup> quantity_groups(const MonteCarloResult& result) {
  std::vector<QuantityGroup> groups;
  for (std::size_t i = 0; i < result.quantities.size(); ++i) {
    const Quantity& quantity = result.quantities[i].quantity;
    const std::string name = group_name(quantity);
    auto group = std::ranges::find(groups, name, &QuantityGroup::name);
    if (group == groups.end()) group = groups.insert(group, {name, quantity.unit, {}});
    group->values.push_back(i);
  }
  return groups;
}

}  // namespace volcal
