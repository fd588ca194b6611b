// Types of ISO/TR 16907, 8.2, and what each corrects of errors given by hand.

#include "volcal/identify/compensation/compensation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using Part = CompensationPart;

constexpr ApproachDirection kTowardsPlus = {1, 1, 1, 0, 0, 0};
constexpr ApproachDirection kTowardsMinus = {-1, -1, -1, 0, 0, 0};

/// 1 m cube, home at 0, lines through its middle, tool at the spindle.
Machine cube() {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.tools = {{"short", Vector3d::Zero(), 0.0}};
  return machine;
}

Vector3d correction_um(const FitResult& result, CompensationType type, const AxisPosition& position,
                       const ApproachDirection& direction = kTowardsPlus) {
  TableFormatOptions options;
  options.type = type;
  return ideal_compensation(result, options).correction(position, direction) / kMicro;
}

void expect_near(const Vector3d& actual, const Vector3d& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-6) << actual.transpose() << " instead of " << expected.transpose();
}

TEST(CompensationTypeNames, AreThoseOfIsoTr16907) {
  for (const CompensationTypeInfo& info : compensation_types()) {
    EXPECT_EQ(CompensationType::parse(info.name), info.type);
    EXPECT_EQ(info.type.name(), info.name);
  }
  EXPECT_EQ(CompensationType::parse("l-str+l-pos").name(), "L-POS+L-STR");
  EXPECT_EQ(CompensationType::parse("L-POS+L-VOL").name(), "L-VOL");
  EXPECT_TRUE(CompensationType::volumetric().contains(CompensationType(Part::Angular)));
  EXPECT_FALSE(CompensationType(Part::Angular).contains(CompensationType::volumetric()));
  EXPECT_EQ(compensation_types().size(), 13U);
}

TEST(CompensationTypeNames, VolumetricTypesAreTheSumOfTheirParts) {
  const auto parsed = [](const char* text) { return CompensationType::parse(text); };
  EXPECT_EQ(parsed("R-POS+R-RAX+R-POR+R-ANG"), CompensationType::rotary_volumetric());
  EXPECT_EQ(parsed("r-vol+"), CompensationType::rotary_volumetric() | Part::Orientation);
  EXPECT_EQ(parsed("R-VOL+FOR").name(), "R-VOL+");
  EXPECT_EQ(parsed("L-VOL+").name(), "L-VOL+");
  EXPECT_EQ(parsed("L-VOL++R-POS").name(), "L-VOL+R-POS+FOR");
  EXPECT_EQ(parsed("L-VOL+R-VOL+").name(), "L-VOL+R-VOL+");
  EXPECT_TRUE(parsed("L-VOL+R-VOL+").has(Part::Orientation));
  EXPECT_FALSE(parsed("L-VOL+R-VOL").has(Part::Orientation));
  EXPECT_EQ(parsed("L-POS+R-POS+FOR").name(), "L-POS+R-POS+FOR");
  EXPECT_EQ(parsed("L-POS+R-POS").linear(), CompensationType(Part::Positioning));
  EXPECT_EQ(parsed("L-POS+R-POS").rotary(), CompensationType(Part::RotaryPositioning));
  for (const CompensationTypeInfo& one : compensation_types()) {
    for (const CompensationTypeInfo& other : compensation_types()) {
      const CompensationType both = one.type | other.type;
      EXPECT_EQ(CompensationType::parse(both.name()), both) << both.name();
    }
  }
}

TEST(CompensationTypeNames, OthersAreRefusedWithTheReason) {
  const auto message = [](const char* text) {
    try {
      CompensationType::parse(text);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message("L-SPEC").find("special to one machine"), std::string::npos);
  EXPECT_NE(message("L-POS+R-SPEC").find("R-SPEC"), std::string::npos);
  for (const char* wrong : {"", "+", "L-POS+", "L-PITCH", "L-POS L-STR"})
    EXPECT_NE(message(wrong).find("L-POS, L-STR, L-SQU, L-ANG, L-VOL"), std::string::npos) << wrong;
}

/// X too long by 10 um at 1 m: the command is shortened by as much.
TEST(IdealCompensation, IsMinusThePositioningError) {
  const FitResult result =
      testing::result_with(cube(), {.functions = {{"EXX", [](double q) { return 10e-6 * q; }}}}, 10);
  expect_near(correction_um(result, Part::Positioning, {1.0, 0.3, 0.2}), {-10.0, 0.0, 0.0});
  expect_near(correction_um(result, Part::Positioning, {0.5, 0.3, 0.2}), {-5.0, 0.0, 0.0});
  expect_near(correction_um(result, Part::Straightness, {1.0, 0.3, 0.2}), Vector3d::Zero());
  expect_near(correction_um(result, Part::Angular, {1.0, 0.3, 0.2}), Vector3d::Zero());
}

/// ECX = 20 urad/m x, table X: the point (x, y) moves by -ECX y in x and by +ECX x in y. At x = 1, y = 0.8
/// that is -16 um in x. Line of X (y = 0.5): -10 um, which L-POS corrects, and 20 um/m^2 x^2 in y, of slope
/// 20 urad. Line of Y (x = 0.5): -10 urad in x, -8 um at y = 0.8. The angle between the lines is 20 - 10 = 10
/// urad, for which L-SQU takes 8 um; L-ANG has -16 + 10 + 8 = 2 um; L-VOL also turns the frame by the 20
/// urad, 16 um.
TEST(IdealCompensation, TellsTheSpecificLinesFromTheVolume) {
  const FitResult result =
      testing::result_with(cube(), {.functions = {{"ECX", [](double q) { return 20e-6 * q; }}}}, 10);
  const AxisPosition place = {1.0, 0.8, 0.5};
  expect_near(correction_um(result, Part::Positioning, place), {10.0, 0.0, 0.0});
  EXPECT_NEAR(correction_um(result, Part::Squareness, place).x(), -8.0, 1e-3);
  EXPECT_NEAR(correction_um(result, Part::Angular, place).x(), -2.0, 1e-6);
  EXPECT_NEAR(correction_um(result, CompensationType::volumetric(), place).x(), 16.0, 1e-6);
}

/// u_Y = e_Y - EC0Y e_X: with EC0Y = 30 urad the point at Y = 1 m lies 30 um towards -x.
TEST(IdealCompensation, OfSquarenessMovesTheEarlierAxisOfTheDatum) {
  const FitResult result = testing::result_with(cube(), {.locations = {{"EC0Y", 30e-6}}}, 10);
  expect_near(correction_um(result, Part::Squareness, {0.2, 1.0, 0.4}), {30.0, 0.0, 0.0});
  expect_near(correction_um(result, Part::Straightness, {0.2, 1.0, 0.4}), Vector3d::Zero());
  TableFormatOptions options;
  options.type = Part::Squareness;
  EXPECT_NEAR(ideal_compensation(result, options).squareness(AxisName::X, AxisName::Y), -30e-6, 1e-12);
}

/// EYX = 8 um sin^2: no slope over the travel; its bow is straightness, at the middle 8 um.
TEST(IdealCompensation, OfStraightnessLeavesTheSlope) {
  const auto bow = [](double q) { return 8e-6 * std::pow(std::sin(M_PI * q), 2) + 5e-6 * q; };
  const FitResult result = testing::result_with(cube(), {.functions = {{"EYX", bow}}}, 400);
  const Vector3d middle = correction_um(result, Part::Straightness, {0.5, 0.1, 0.2});
  EXPECT_NEAR(middle.y(), -8.0, 1e-3);
  EXPECT_NEAR(correction_um(result, Part::Straightness, {1.0, 0.1, 0.2}).y(), 0.0, 1e-3);
  EXPECT_NEAR(correction_um(result, Part::Squareness, {0.5, 1.0, 0.2}).x(), -5.0, 1e-3)
      << "the slope is an angle between X and Y";
}

/// Table 1: zero at home approached towards +, the whole reversal on the way back.
TEST(IdealCompensation, HasTheReversalInTheDirectionTowardsMinus) {
  const FitResult result = testing::result_with(cube(), {.reversals = {{"EXX", 4e-6}}}, 10);
  expect_near(correction_um(result, Part::Positioning, {0.7, 0.1, 0.2}, kTowardsPlus), Vector3d::Zero());
  expect_near(correction_um(result, Part::Positioning, {0.7, 0.1, 0.2}, kTowardsMinus), {4.0, 0.0, 0.0});
}

/// The four types add up to L-VOL but for a rotation of the frame.
TEST(IdealCompensation, TypesAddUpToTheVolumetricOne) {
  for (const Machine& machine : sim::reference_machines()) {
    sim::RandomTruthOptions errors;
    errors.reversal_max = 4e-6;
    errors.angular_reversal_max = 3e-6;
    const sim::TruthMachine truth = sim::random_truth(machine, 5, errors);
    const FitResult result = testing::result_of(truth);
    const auto type = [&](CompensationType wanted) {
      TableFormatOptions options;
      options.type = wanted;
      return ideal_compensation(result, options);
    };
    const Compensation whole = type(CompensationType::volumetric());
    const std::vector<Compensation> parts = {type(Part::Positioning), type(Part::Straightness),
                                             type(Part::Squareness), type(Part::Angular)};
    const ErrorLeft left = error_left(machine, volume_points(machine, 3),
                                      [&](const AxisPosition& at, const ApproachDirection& direction) {
                                        Vector3d difference = whole.correction(at, direction);
                                        for (const Compensation& part : parts)
                                          difference -= part.correction(at, direction);
                                        return difference;
                                      });
    EXPECT_LT(left.max, 1e-10) << machine.structure.code;
    EXPECT_EQ(whole.correction(home_of(machine), kTowardsPlus), Vector3d::Zero());
  }
}

TEST(ChosenStep, IsTheLargestRoundOneThatFollowsTheErrors) {
  const auto wave = [](double q) { return 10e-6 * std::pow(std::sin(2.0 * M_PI * q), 2); };
  const FitResult result = testing::result_with(cube(), {.functions = {{"EXX", wave}}}, 400);
  TableFormatOptions options;
  options.type = Part::Positioning;
  const TableFormat& format = *find_table_format("linuxcnc");
  // A chord of length h leaves up to h^2 / 8 |f''| = h^2 10 um pi^2: 0.99 um at 100 mm, 0.25 um at 50 mm.
  const StepChoice fine = choose_step(format, result, options, 0.3e-6);
  EXPECT_NEAR(fine.step, 50e-3, 1e-12);
  EXPECT_TRUE(fine.reached);
  EXPECT_LE(fine.deviation, 0.3e-6);
  EXPECT_EQ(fine.refusal, "");
  const StepChoice impossible = choose_step(format, result, options, 1e-12);
  EXPECT_FALSE(impossible.reached) << "256 rows do not hold 1 pm";
  EXPECT_THAT(impossible.refusal, ::testing::HasSubstr("501"));
  EXPECT_NEAR(impossible.step, 5e-3, 1e-12) << "201 rows; 2 mm would need 501";
}

}  // namespace
}  // namespace volcal
