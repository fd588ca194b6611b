// A rotary axis that was measured over a part of its turn: the error field and the simulator, whose rule for
// positions beyond is code of its own.

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/rotary_machines.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/model/description/units.h"
#include "volcal/sim/known/known_errors.h"

namespace volcal {
namespace {

constexpr double kSecondOrderTerms = 10e-9;  // m, that the first-order model leaves out

Machine machine_of_a_whole_turn() {
  Machine machine = testing::rotary_machine("w C' b X Y Z t");
  for (Axis& axis : machine.axes) {
    if (axis.name != AxisName::C) continue;
    axis.travel_min = axis.home = 0.0;
    axis.travel_max = 2.0 * std::numbers::pi;
  }
  return machine;
}

/// Zero at home; C was measured from 0 to 120 degrees.
ModelSpec measured_in_part(const Machine& machine) {
  ModelSpec model;
  model.default_function.basis = "zero";
  FunctionSpec series;
  series.basis = "fourier";
  series.degree = 2;
  series.coefficients = {-7e-6, 5e-6, 8e-6, 2e-6, 4e-6};
  for (const Component component : {Component::X, Component::Z, Component::A, Component::C})
    model.functions[{component, AxisName::C}] = series;
  model.measured[AxisName::C] = {0.0, 120.0 * kRadianPerDegree};
  EXPECT_TRUE(machine.axis(AxisName::C).travels_a_turn());
  return model;
}

class MeasuredTurn : public ::testing::Test {
 protected:
  AxisPosition pose(double c_deg) const {
    AxisPosition position{};
    position[index_of(AxisName::X)] = 0.1;
    position[index_of(AxisName::Y)] = -0.05;
    position[index_of(AxisName::C)] = c_deg * kRadianPerDegree;
    return position;
  }
  Eigen::Vector3d of_model(double c_deg) const { return field_.at(pose(c_deg)).head<3>(); }
  Eigen::Vector3d of_simulator(double c_deg) const {
    sim::MachineState state;
    state.position = pose(c_deg);
    return truth_.point_error(state, machine_.tools.front().offset);
  }

  void SetUp() override { sim::set_known_errors(model_, truth_); }

  Machine machine_ = machine_of_a_whole_turn();
  ModelSpec model_ = measured_in_part(machine_);
  FitResult result_ = stated_result(machine_, model_);
  ErrorField field_{result_, machine_.tools.front()};
  sim::TruthMachine truth_{machine_};
};

TEST_F(MeasuredTurn, IsWhatTheSimulatorHas) {
  for (const double c_deg : {0.0, 60.0, 119.0, 125.0, 200.0, 250.0, 350.0, 360.0})
    EXPECT_LT((of_model(c_deg) - of_simulator(c_deg)).norm(), kSecondOrderTerms) << c_deg;
}

TEST_F(MeasuredTurn, HasOneErrorAtBothEndsOfTheTurn) {
  EXPECT_LT((of_model(360.0) - of_model(0.0)).norm(), 1e-15);
  EXPECT_GT((of_model(120.0) - of_model(0.0)).norm(), 2e-6) << "what was held there before";
}

}  // namespace
}  // namespace volcal
