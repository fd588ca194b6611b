#pragma once
/// Campaigns and models for tests that use every kind of parameter.

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal::testing_support {

/// Random chain of six axes, `rows` readings each of a laser tracer and of a laser tracker whose tool has an
/// uncertain offset; two scales expand.
inline Campaign random_campaign(std::mt19937_64& random, std::size_t rows) {
  Campaign campaign;
  campaign.machine = testing_support::random_machine(random);
  campaign.machine.tools = {{"exact", random_vector(random, 0.2), 0.0},
                            {"uncertain", random_vector(random, 0.2), 1e-5}};
  for (Axis& axis : campaign.machine.axes) {
    if (axis.name == AxisName::Y) axis.expansion = {11e-6, 1e-6, "Y"};
    if (axis.name == AxisName::Z) axis.expansion = {10e-6, 0.0, "Z"};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    Setup setup;
    setup.name = "S" + std::to_string(i);
    setup.instrument = i == 0 ? "laser-tracer" : "laser-tracker";
    setup.tool = i;
    setup.options.set("station", Eigen::Vector3d(random_vector(random, 0.3) + Eigen::Vector3d(4, 4, 4)));
    setup.noise.set("constant", 1e-6);
    setup.readings.value.assign(i == 0 ? 1 : 3, std::vector<double>(rows, 0.0));
    for (std::size_t row = 0; row < rows; ++row) {
      for (const Axis& axis : campaign.machine.axes) {
        setup.readings.position[index_of(axis.name)].push_back(0.5 * (axis.travel_min + axis.travel_max) +
                                                               uniform(random, 0.5 * axis.travel()));
        setup.readings.direction[index_of(axis.name)].push_back(row % 2 == 0 ? 1 : -1);
      }
      setup.readings.temperature["Y"].push_back(20.0 + uniform(random, 5.0));
      setup.readings.temperature["Z"].push_back(20.0 + uniform(random, 5.0));
      setup.readings.source_line.push_back(static_cast<std::int64_t>(row) + 2);
    }
    campaign.setups.push_back(setup);
  }
  return campaign;
}

/// Splines on all axes, two bases on X, a reversal, and every rotary location error.
inline ModelSpec rich_model(const Machine& machine) {
  ModelSpec model;
  for (const Axis& axis : machine.axes) {
    FunctionSpec spline;
    spline.knots = KnotChoice::Explicit;
    spline.breakpoints = {axis.travel_min, 0.5 * (axis.travel_min + axis.travel_max), axis.travel_max};
    for (const Component component : kAllComponents) {
      FunctionSpec function = spline;
      if (axis.name == AxisName::X && is_rotation(component)) function.degree = 2;
      model.functions[{component, axis.name}] = function;
      if (is_rotary(axis.name)) model.locations[{component, axis.name}] = 0.0;
    }
  }
  EffectSpec reversal;
  reversal.kind = "reversal";
  reversal.options.set("symbol", std::string("EAX"));
  model.effects.push_back(reversal);
  return model;
}

/// Errors of some 10 um and 10 urad on top of the guesses.
inline Eigen::VectorXd random_parameters(const MeasurementModel& model, std::mt19937_64& random) {
  Eigen::VectorXd parameters = model.initial_parameters();
  for (double& parameter : parameters) parameter += uniform(random, 1e-5);
  return parameters;
}

}  // namespace volcal::testing_support
