#include "volcal/sim/machine/datum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/paths.h"

namespace volcal::sim {
namespace {

constexpr std::array<AxisName, 3> kLinearAxes = {AxisName::X, AxisName::Y, AxisName::Z};

/// Nothing in datum form: straightness with slopes, functions that are not zero at home, angles too.
TruthMachine crooked_machine(const std::string& code) {
  Machine machine = machine_from_code(code, {{{-0.2, 0.6}, {0.1, 0.8}, {0.0, 0.5}}});
  for (Axis& axis : machine.axes) axis.reference_point = {0.1, -0.2, 0.05};
  TruthMachine truth(machine);
  double phase = 0.0;
  for (const AxisName axis : kLinearAxes) {
    for (const Component component : kAllComponents) {
      phase += 1.0;
      truth.set_error({component, axis}, [phase](double q) {
        return 1e-6 * (3.0 * std::sin(7.0 * q + phase) + 4.0 * q * std::cos(phase) + std::cos(2 * phase));
      });
    }
  }
  double value = 10e-6;
  for (const LocationSymbol& symbol : machine.datum.squareness()) truth.set_location(symbol, value += 7e-6);
  return truth;
}

/// The machine that error tables in a datum describe.
TruthMachine in_datum(const TruthMachine& truth, const Datum& datum) {
  const TruthInDatum tables(truth, datum);
  Machine machine = truth.machine();
  machine.datum = datum;
  TruthMachine described(machine);
  for (const AxisName axis : kLinearAxes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis};
      described.set_error(symbol, [tables, symbol](double q) { return tables.value(symbol, q); });
    }
  }
  const auto symbols = datum.squareness();
  for (std::size_t i = 0; i < 3; ++i) described.set_location(symbols[i], tables.squareness()[i]);
  return described;
}

double difference_after_alignment(const TruthMachine& a, const TruthMachine& b, const Eigen::Vector3d& tool) {
  RandomStream random(3, "points");
  std::vector<Eigen::Vector3d> point;
  std::vector<Eigen::Vector3d> difference;
  for (const CommandedPoint& commanded : random_points(a.machine(), 200, random)) {
    const MachineState state{commanded.position, commanded.direction, 0.0, {}};
    point.push_back(a.nominal_point(state, tool));
    difference.emplace_back(a.point(state, tool) - b.point(state, tool));
  }
  return rms_after_alignment(point, difference);
}

std::vector<Datum> all_datums() {
  std::vector<Datum> datums;
  for (const AxisName primary : kLinearAxes) {
    for (const AxisName secondary : kLinearAxes) {
      if (primary != secondary) datums.push_back({primary, secondary});
    }
  }
  return datums;
}

TEST(LeastSquaresSlope, IsExactForPolynomialsAndSines) {
  // 12/L^3 int (q - c) f dq by hand: q^3 on [-1, 1] has 3/5, sin(w q) on [-1, 1] has 3 (sin w - w cos w) /
  // w^2.
  EXPECT_NEAR(least_squares_slope([](double q) { return q * q * q; }, -1, 1), 0.6, 1e-13);
  EXPECT_NEAR(least_squares_slope([](double q) { return 2.0 * q + 5.0; }, 3, 4), 2.0, 1e-11);
  const double w = 40.0;
  EXPECT_NEAR(least_squares_slope([w](double q) { return std::sin(w * q); }, -1, 1),
              3.0 * (std::sin(w) - w * std::cos(w)) / (w * w), 1e-13);
}

TEST(TruthInDatum, FunctionsAreZeroAtHomeAndStraightnessHasNoSlope) {
  const TruthMachine truth = crooked_machine("w X' b Y Z t");
  const TruthInDatum tables(truth);
  for (const AxisName axis : kLinearAxes) {
    const Axis& described = truth.machine().axis(axis);
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis};
      EXPECT_NEAR(tables.value(symbol, described.home), 0.0, 1e-18);
      if (!symbol.is_straightness()) continue;
      EXPECT_NEAR(least_squares_slope([&](double q) { return tables.value(symbol, q); }, described.travel_min,
                                      described.travel_max),
                  0.0, 1e-15);
    }
  }
}

TEST(TruthInDatum, SquarenessByHand) {
  // Slopes: EYX 1, EZX 2, EXY 3, EZY 4, EXZ 5, EYZ 6 um/m; squareness EC0Y 10, EA0Z 20, EB0Z 30 urad.
  TruthMachine truth(machine_from_code("w X b Y Z t", {{{0, 1}, {0, 1}, {0, 1}}}));
  double slope = 0.0;
  for (const char* name : {"EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"}) {
    slope += 1e-6;
    truth.set_error(*ErrorSymbol::parse(name), [slope](double q) { return slope * q; });
  }
  truth.set_location(*LocationSymbol::parse("EC0Y"), 10e-6);
  truth.set_location(*LocationSymbol::parse("EA0Z"), 20e-6);
  truth.set_location(*LocationSymbol::parse("EB0Z"), 30e-6);
  // Directions: X (1, 1u, 2u), Y (3u - 10u, 1, 4u), Z (5u + 30u, 6u - 20u, 1). Frame: about x 4, y -2, z 1
  // urad. EC0Y = -(-7) - 1 ... the angle between X and Y: EC0Y = 10 - 3 - 1, EA0Z = 20 - 6 - 4, EB0Z = 30 + 5
  // + 2.
  const TruthInDatum tables(truth);
  EXPECT_NEAR(tables.squareness()[0], 6e-6, 1e-15);
  EXPECT_NEAR(tables.squareness()[1], 10e-6, 1e-15);
  EXPECT_NEAR(tables.squareness()[2], 37e-6, 1e-15);
  EXPECT_LT((tables.frame_rotation() - Eigen::Vector3d(4e-6, -2e-6, 1e-6)).norm(), 1e-15);
  EXPECT_NEAR(tables.removed_slope(*ErrorSymbol::parse("EXY")), 3e-6, 1e-15);
  EXPECT_EQ(tables.removed_slope(*ErrorSymbol::parse("EAY")), 0.0);
}

TEST(TruthInDatum, DescribesTheSameMachineInAllSixDatums) {
  for (const char* code : {"w X b Y Z t", "w X' Y' b Z t", "w b X Y Z t", "w Y' b X Z t", "w Z' b Y X t"}) {
    const TruthMachine truth = crooked_machine(code);
    for (const Datum& datum : all_datums()) {
      const TruthMachine described = in_datum(truth, datum);
      for (const Tool& tool : truth.machine().tools) {
        EXPECT_LT(difference_after_alignment(truth, described, tool.offset), 1e-9)
            << code << " primary " << letter_of(datum.primary) << " secondary " << letter_of(datum.secondary);
      }
    }
  }
}

TEST(TruthInDatum, SixDatumsOfOneMachineDifferByARigidMotionAndAShiftPerTool) {
  const TruthMachine truth = crooked_machine("w X b Y Z t");
  const TruthMachine first = in_datum(truth, {AxisName::X, AxisName::Y});
  const TruthInDatum first_tables(truth, {AxisName::X, AxisName::Y});
  for (const Datum& datum : all_datums()) {
    const TruthMachine other = in_datum(truth, datum);
    const Eigen::Vector3d turn = first_tables.frame_rotation() - TruthInDatum(truth, datum).frame_rotation();
    MachineState home;
    for (const Axis& axis : truth.machine().axes) home.position[index_of(axis.name)] = axis.home;
    for (const Tool& tool : truth.machine().tools) {
      // At a fixed position the tool offset is not turned with the frame: the shift between two tools differs
      // from a rigid motion by turn x offset.
      const Eigen::Vector3d difference = first.point(home, tool.offset) - other.point(home, tool.offset);
      const Eigen::Vector3d of_spindle =
          first.point(home, Eigen::Vector3d::Zero()) - other.point(home, Eigen::Vector3d::Zero());
      EXPECT_LT((difference - of_spindle).norm(), 1e-12);
    }
    EXPECT_EQ(turn.norm() < 1e-12, datum.primary == AxisName::X && datum.secondary == AxisName::Y);
  }
}

}  // namespace
}  // namespace volcal::sim
