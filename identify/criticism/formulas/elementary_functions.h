#pragma once
/// Functions of one recorded variable that laws of machines are made of: powers, kinks, steps, saturations,
/// waves. A law is a product of one of each driver and an amplitude.
///
/// Values and shapes are in the units in which users write of the variable (recorded_variable.h).

#include <functional>
#include <string>
#include <vector>

#include "volcal/model/description/variable.h"

namespace volcal {

struct DriverRange {
  Variable variable;
  double from = 0.0;
  double to = 1.0;
};

/// With at most two parameters of its shape.
struct ElementaryFunction {
  /// As an expression, the names of its parameters given: "(y - p)^2".
  std::function<std::string(const std::vector<std::string>& names)> text;
  /// At a value of the variable.
  std::function<double(double value, const std::vector<double>& shape)> at;
  std::vector<std::vector<double>>
      starts;                      ///< shapes from which it is looked for; one, empty, without a shape
  int power = 0;                   ///< of the variable's unit in its values
  std::vector<bool> is_span = {};  ///< per parameter of its shape: a period or width, no place
  bool smooth_in_shape = true;     ///< a derivative to its shape exists

  std::size_t shapes() const { return starts.front().size(); }
};

/// 1, whatever the variable: a law without it.
ElementaryFunction unity();
ElementaryFunction power_of(const Variable& variable, double zero, int exponent);

/// `zero`: from where the variable counts in a law: home, 20 degC, 0.
std::vector<ElementaryFunction> elementary_functions(const DriverRange& driver, double zero);

}  // namespace volcal
