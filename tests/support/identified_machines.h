#pragma once
/// Results without a fit: errors given by hand, or those of a simulated machine.

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/functions/registry.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal::testing {

struct GivenErrors {
  std::map<std::string, std::function<double(double)>> functions = {};  ///< by symbol, m or rad
  std::map<std::string, double> locations = {};
  std::map<std::string, double> reversals = {};
};

/// Functions as polylines of `intervals` pieces.
inline FitResult result_with(const Machine& machine, const GivenErrors& given, int intervals) {
  FitResult result;
  result.machine = machine;
  std::vector<double> parameters;
  const auto offset = [&] { return static_cast<int>(parameters.size()); };
  for (const auto& [name, function] : given.functions) {
    const ErrorSymbol symbol = *ErrorSymbol::parse(name);
    const Axis& axis = machine.axis(symbol.axis);
    FunctionSpec spec;
    spec.degree = 1;
    for (int i = 0; i <= intervals; ++i)
      spec.breakpoints.push_back(axis.travel_min + axis.travel() * i / intervals);
    FunctionGroup group;
    group.axis = symbol.axis;
    group.basis = find_basis("bspline")->make(spec, axis);
    group.symbols = {symbol};
    group.offset = offset();
    result.layout.groups.push_back(group);
    for (const double q : spec.breakpoints) parameters.push_back(function(q));
  }
  result.layout.function_size = offset();
  const auto add_block = [&](ParameterKind kind, const std::string& name, double value) {
    ParameterBlock block;
    block.kind = kind;
    block.name = name;
    block.offset = offset();
    block.guess = Eigen::VectorXd::Zero(1);
    if (kind == ParameterKind::Location) block.location = LocationSymbol::parse(name);
    result.layout.blocks.push_back(block);
    parameters.push_back(value);
  };
  for (const auto& [name, value] : given.locations) add_block(ParameterKind::Location, name, value);
  for (const auto& [name, value] : given.reversals) {
    add_block(ParameterKind::Effect, "reversal " + name, value);
    EffectSpec reversal;
    reversal.kind = "reversal";
    reversal.options.set("symbol", name);
    result.identified.effects.push_back(reversal);
  }
  result.layout.size = offset();
  result.parameters = Eigen::Map<Eigen::VectorXd>(parameters.data(), offset());
  result.covariance = Eigen::MatrixXd::Zero(offset(), offset());
  return result;
}

/// The errors of a simulated machine, as a perfect identification would find them.
inline FitResult result_of(const sim::TruthMachine& truth, int intervals = 50) {
  GivenErrors given;
  for (const AxisName axis : kLinearAxes) {
    if (!truth.machine().has_axis(axis)) continue;
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis};
      given.functions[symbol.name()] = [&truth, symbol](double q) { return truth.function_value(symbol, q); };
      if (truth.reversal(symbol) != 0.0) given.reversals[symbol.name()] = truth.reversal(symbol);
    }
  }
  for (const LocationSymbol symbol : truth.machine().datum.squareness())
    given.locations[symbol.name()] = truth.location(symbol);
  return result_with(truth.machine(), given, intervals);
}

/// A simulated machine that has the identified errors exactly; an axis that travels a turn counts modulo it.
inline sim::TruthMachine true_machine(const FitResult& result) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kClosed = 1e-6;  // rad
  sim::TruthMachine truth(result.machine);
  const ErrorField field(result, result.machine.tools.front(), default_conditions(result));
  for (const Axis& axis : result.machine.axes) {
    for (const Component component : kAllComponents) {
      const std::size_t a = index_of(axis.name), k = index_of(component);
      truth.set_error({component, axis.name}, [=](double q) {
        AxisPosition position{};
        position[a] = q;
        if (is_rotary(axis.name) && axis.travel() > kTurn - kClosed &&
            (q < axis.travel_min || q > axis.travel_max))
          position[a] = q - kTurn * std::floor((q - axis.travel_min) / kTurn);
        return field.joint_errors(position, {}).motion[a][k];
      });
      const double location = field.joint_errors({}, {}).location[a][k];
      if (is_rotary(axis.name) && location != 0.0) truth.set_location({component, axis.name}, location);
    }
  }
  return truth;
}

}  // namespace volcal::testing
