#include "volcal/model/functions/registry.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace volcal {

// One line per basis.
#define VOLCAL_BASES(BASIS) \
  BASIS(kBSplineBasis)      \
  BASIS(kLegendreBasis)     \
  BASIS(kFourierBasis)      \
  BASIS(kZeroBasis)

#define VOLCAL_DECLARE_BASIS(name) extern const BasisKind name;
#define VOLCAL_ADDRESS_OF_BASIS(name) &(name),
VOLCAL_BASES(VOLCAL_DECLARE_BASIS)

std::span<const BasisKind* const> basis_kinds() {
  static const auto kinds = std::to_array<const BasisKind*>({VOLCAL_BASES(VOLCAL_ADDRESS_OF_BASIS)});
  return kinds;
}

const BasisKind* find_basis(std::string_view name) {
  const auto kinds = basis_kinds();
  const auto found = std::ranges::find(kinds, name, &BasisKind::name);
  return found == kinds.end() ? nullptr : *found;
}

std::vector<std::string> basis_names() {
  std::vector<std::string> names;
  for (const BasisKind* kind : basis_kinds()) names.emplace_back(kind->name);
  return names;
}

std::vector<double> uniform_breakpoints(const Axis& axis, int intervals) {
  if (intervals < 1) throw std::invalid_argument("a function needs at least one interval");
  std::vector<double> breakpoints;
  breakpoints.reserve(static_cast<std::size_t>(intervals) + 1);
  for (int i = 0; i < intervals; ++i) {
    breakpoints.push_back(axis.travel_min + axis.travel() * i / intervals);
  }
  breakpoints.push_back(axis.travel_max);
  return breakpoints;
}

}  // namespace volcal
