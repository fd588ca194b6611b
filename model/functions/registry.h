#pragma once
/// The registered bases. A new basis is one file that defines a `BasisKind` and one line in registry.cpp.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/functions/basis.h"

namespace volcal {

struct BasisKind {
  std::string_view name;
  std::string_view summary;
  std::string_view source;
  int degree_min;
  int degree_max;
  bool linear_axes;
  bool rotary_axes;
  bool uses_knots;
  bool has_automatic_degree = false;  ///< `degree = "auto"`: follows from the readings
  bool is_periodic = false;           ///< repeats with every turn
  /// `spec` must be resolved: with `uses_knots`, `breakpoints` holds the pieces. Throws
  /// std::invalid_argument.
  std::unique_ptr<Basis> (*make)(const FunctionSpec& spec, const Axis& axis);
};

std::span<const BasisKind* const> basis_kinds();
const BasisKind* find_basis(std::string_view name);
std::vector<std::string> basis_names();

/// Breakpoints of `intervals` equal pieces over the axis's travel.
std::vector<double> uniform_breakpoints(const Axis& axis, int intervals);

}  // namespace volcal
