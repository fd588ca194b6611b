#include "volcal/identify/criticism/formulas/elementary_functions.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace volcal {
namespace {

using Names = std::vector<std::string>;
using Shape = std::vector<double>;

constexpr int kPlaces = 9;  // of a kink or step along the range

/// "y - 120", "y + 250" of -250.
std::string variable_less(const std::string& variable, const std::string& value) {
  return value.starts_with('-') ? variable + " + " + value.substr(1) : variable + " - " + value;
}

/// "y", or "(T_column - 20)".
std::string from_zero(const std::string& variable, double zero) {
  return zero == 0.0 ? variable : "(" + variable_less(variable, fmt::format("{:g}", zero)) + ")";
}

/// Along the range, its ends left out.
std::vector<Shape> places(const DriverRange& driver) {
  std::vector<Shape> all;
  for (int i = 1; i <= kPlaces; ++i)
    all.push_back({driver.from + (driver.to - driver.from) * static_cast<double>(i) / (kPlaces + 1)});
  return all;
}

ElementaryFunction shifted_power(const DriverRange& driver, int exponent) {
  return {[=, variable = driver.variable.written()](const Names& names) {
            const std::string base = "(" + variable_less(variable, names[0]) + ")";
            return exponent == 1 ? base : fmt::format("{}^{}", base, exponent);
          },
          [=](double value, const Shape& shape) { return std::pow(value - shape[0], exponent); },
          places(driver),
          exponent,
          {false}};
}

ElementaryFunction kink(const DriverRange& driver, const std::string& pattern, double (*at)(double beyond)) {
  return {[=, variable = driver.variable.written()](const Names& names) {
            return fmt::format(fmt::runtime(pattern), variable_less(variable, names[0]));
          },
          [=](double value, const Shape& shape) { return at(value - shape[0]); },
          places(driver),
          1,
          {false}};
}

ElementaryFunction step(const DriverRange& driver) {
  ElementaryFunction function{[variable = driver.variable.written()](const Names& names) {
                                return fmt::format("({} > {})", variable, names[0]);
                              },
                              [](double value, const Shape& shape) { return value > shape[0] ? 1.0 : 0.0; },
                              places(driver),
                              0,
                              {false}};
  function.smooth_in_shape = false;
  return function;
}

ElementaryFunction saturation(const DriverRange& driver) {
  std::vector<Shape> starts;
  for (const Shape& place : places(driver)) {
    for (const double share : {0.05, 0.15}) starts.push_back({place[0], share * (driver.to - driver.from)});
  }
  return {[variable = driver.variable.written()](const Names& names) {
            return fmt::format("tanh(({}) / {})", variable_less(variable, names[0]), names[1]);
          },
          [](double value, const Shape& shape) { return std::tanh((value - shape[0]) / shape[1]); },
          starts,
          0,
          {false, true}};
}

ElementaryFunction wave(const DriverRange& driver) {
  std::vector<Shape> starts;
  const double range = driver.to - driver.from;
  for (const double share : {0.25, 0.35, 0.5, 0.7, 1.0, 1.4}) {
    for (const double phase : {0.0, 0.25}) starts.push_back({share * range, phase * share * range});
  }
  return {[variable = driver.variable.written()](const Names& names) {
            return fmt::format("sin(2 * pi * ({}) / {})", variable_less(variable, names[1]), names[0]);
          },
          [](double value, const Shape& shape) {
            return std::sin(2.0 * std::numbers::pi * (value - shape[1]) / shape[0]);
          },
          starts,
          0,
          {true, false}};
}

ElementaryFunction approach(const DriverRange& driver) {
  std::vector<Shape> starts;
  for (const double share : {0.05, 0.1, 0.2, 0.4, 0.8}) starts.push_back({share * (driver.to - driver.from)});
  return {[variable = driver.variable.written()](const Names& names) {
            return fmt::format("(1 - exp(-{} / {}))", variable, names[0]);
          },
          [](double value, const Shape& shape) { return 1.0 - std::exp(-value / shape[0]); },
          starts,
          0,
          {true}};
}

}  // namespace

ElementaryFunction unity() {
  return {[](const Names&) { return std::string(); }, [](double, const Shape&) { return 1.0; }, {{}}};
}

ElementaryFunction power_of(const Variable& variable, double zero, int exponent) {
  const std::string base = from_zero(variable.written(), zero);
  return {[=](const Names&) { return exponent == 1 ? base : fmt::format("{}^{}", base, exponent); },
          [=](double value, const Shape&) { return std::pow(value - zero, exponent); },
          {{}},
          exponent};
}

std::vector<ElementaryFunction> elementary_functions(const DriverRange& driver, double zero) {
  std::vector<ElementaryFunction> functions;
  for (const int exponent : {1, 2, 3}) functions.push_back(power_of(driver.variable, zero, exponent));
  for (const int exponent : {1, 2}) functions.push_back(shifted_power(driver, exponent));
  functions.push_back(kink(driver, "abs({})", [](double beyond) { return std::abs(beyond); }));
  functions.push_back(kink(driver, "max(0, {})", [](double beyond) { return std::max(0.0, beyond); }));
  functions.push_back(kink(driver, "max(0, -({}))", [](double beyond) { return std::max(0.0, -beyond); }));
  functions.push_back(step(driver));
  functions.push_back(saturation(driver));
  functions.push_back(wave(driver));
  const Variable::Kind kind = driver.variable.kind;
  if (kind == Variable::Kind::Time || kind == Variable::Kind::TravelSinceTurning)
    functions.push_back(approach(driver));
  return functions;
}

}  // namespace volcal
