#include "volcal/identify/report/text/field_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// What was measured of one axis from 0 to a tenth in its unit, m or rad.
std::string refused_for(AxisName axis) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  ModelSpec model;
  model.default_function.basis = "zero";
  FunctionSpec line;
  line.degree = 1;
  line.breakpoints = {machine.axis(axis).travel_min, machine.axis(axis).travel_max};
  line.coefficients = {0.0, 1e-6};
  model.functions[{Component::Z, axis}] = line;
  model.measured[axis] = {0.0, 0.1};
  const FitResult result = stated_result(machine, model);
  return testing::refusal([&] { require_within_readings(result, default_conditions(result)); });
}

/// The key of the remedy is the one that the machine file takes for the axis.
TEST(FieldText, RefusesExtrapolationWithTheKeyOfTheAxis) {
  EXPECT_THAT(refused_for(AxisName::C),
              AllOf(HasSubstr("C was measured from"), HasSubstr("set travel_deg of [axes.C]")));
  EXPECT_THAT(refused_for(AxisName::X),
              AllOf(HasSubstr("X was measured from"), HasSubstr("set travel_mm of [axes.X]")));
}

}  // namespace
}  // namespace volcal
