#pragma once
/// Results of fits that were never made, for tests of what stands on them.

#include <cmath>
#include <random>
#include <string>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/random_matrix.h"
#include "volcal/model/description/unknowns.h"

namespace volcal::testing_support {

inline void add_tool_block(FitResult& result, const std::string& tool, std::mt19937_64& random) {
  ParameterBlock block;
  block.kind = ParameterKind::ToolOffset;
  block.name = "tool " + tool;
  block.offset = result.layout.size;
  block.labels = {"x", "y", "z"};
  block.units = {"mm", "mm", "mm"};
  block.si_per_unit = {1e-3, 1e-3, 1e-3};
  block.guess = Eigen::Vector3d::Zero();
  result.layout.blocks.push_back(block);
  result.layout.size += 3;
  result.parameters.conservativeResize(result.layout.size);
  result.parameters.tail<3>() = random_vector(random, 1e-5);
}

/// All error motions and locations at random, a dense covariance, one tool whose offset was estimated.
inline FitResult random_result(Machine machine, std::mt19937_64& random) {
  machine.tools = {{"stated", random_vector(random, 0.3), 3e-6},
                   {"estimated", random_vector(random, 0.3), 3e-6}};
  testing::GivenErrors given;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const double phase = uniform(random, 3.0);
      given.functions[ErrorSymbol{component, axis.name}.name()] = [phase](double q) {
        return 1e-5 * std::sin(4.0 * q + phase);
      };
      if (!is_rotary(axis.name)) continue;
      given.locations[LocationSymbol{component, axis.name}.name()] = uniform(random, 1e-5);
    }
  }
  for (const LocationSymbol& symbol : squareness_errors(machine))
    given.locations[symbol.name()] = uniform(random, 1e-5);
  FitResult result = testing::result_with(machine, given, 5);
  add_tool_block(result, "estimated", random);
  const Eigen::MatrixXd root = 1e-6 * test::random_matrix(random, result.layout.size, result.layout.size);
  result.covariance = root * root.transpose();
  return result;
}

}  // namespace volcal::testing_support
