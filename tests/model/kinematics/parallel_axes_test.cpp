// A second linear axis along a direction: by hand, and first order against the homogeneous transforms of the
// simulator, which share no code with it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/kinematics/rotary_datum.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using testing_support::error_of;
using testing_support::machine_of;

/// A boring mill: Z carries the quill W, whose scale reads 0.1 m above the spindle's nose.
Machine boring_mill() {
  Machine machine = machine_of("w X' b Y Z W t");
  machine.axes.back().reference_point = {0.0, 0.0, 0.1};
  return machine;
}

AxisPosition boring_mill_pose() {
  AxisPosition position{};
  position[index_of(AxisName::X)] = 0.2;
  position[index_of(AxisName::Y)] = 0.3;
  position[index_of(AxisName::Z)] = -0.1;
  position[index_of(AxisName::W)] = -0.05;
  return position;
}

const Vector3d kSideTool(0.1, 0.0, -0.2);

Vector3d displacement_by(const std::string& symbol, double value) {
  PoseErrors<double> errors;
  error_of(errors, symbol) = value;
  return KinematicChain(boring_mill()).first_order(boring_mill_pose(), kSideTool, errors).displacement_w;
}

void expect_vector(const Vector3d& found, const Vector3d& by_hand) {
  EXPECT_LT((found - by_hand).norm(), 1e-18) << found.transpose();
}

TEST(ParallelAxes, NominalPositionsAdd) {
  const Vector3d point = KinematicChain(boring_mill()).nominal_point_w(boring_mill_pose(), kSideTool);
  EXPECT_LT((point - Vector3d(0.3, 0.3, -0.35)).norm(), 1e-15);
}

/// The arm of W is the tool from its scale, (0.1, 0, -0.3) m; that of Z is longer by what W stands out,
/// (0.1, 0, -0.25) m.
TEST(ParallelAxes, ErrorsOfTheQuillByHand) {
  expect_vector(displacement_by("EXW", 10e-6), {10e-6, 0.0, 0.0});
  expect_vector(displacement_by("EZW", 10e-6), {0.0, 0.0, 10e-6});
  expect_vector(displacement_by("EBW", 20e-6), {-6e-6, 0.0, -2e-6});
  expect_vector(displacement_by("EBZ", 20e-6), {-5e-6, 0.0, -2e-6});
}

/// The angles of W lead it astray by its own position, those of Z by that of Z.
TEST(ParallelAxes, AnglesOfTheQuillByHand) {
  expect_vector(displacement_by("EB0W", 30e-6), {-1.5e-6, 0.0, 0.0});
  expect_vector(displacement_by("EA0W", 30e-6), {0.0, 1.5e-6, 0.0});
  expect_vector(displacement_by("EB0Z", 30e-6), {-3e-6, 0.0, 0.0});
}

TEST(ParallelAxes, AParallelAxisStandsBesideItsMainAxis) {
  for (const char* code : {"w X b Y W t", "w U' b Y Z t"}) EXPECT_THROW(Structure::parse(code), InputError);
  try {
    Structure::parse("w X b Y W t", "machine.toml", 3);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("machine.toml"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("parallel to Z, which the structure has not"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("name the axis Z"));
  }
  EXPECT_EQ(Structure::parse("w U' X' b V Y W Z t").joints.size(), 6U);
}

TEST(ParallelAxes, SymbolsFollowTheRuleOfISO230) {
  for (const char* name : {"EXU", "EYV", "EZW"}) EXPECT_TRUE(ErrorSymbol::parse(name)->is_positioning());
  for (const char* name : {"EYU", "EXV", "EXW"}) EXPECT_TRUE(ErrorSymbol::parse(name)->is_straightness());
  for (const char* name : {"EAU", "EBW"}) {
    EXPECT_FALSE(ErrorSymbol::parse(name)->is_positioning());
    EXPECT_FALSE(ErrorSymbol::parse(name)->is_transverse());
    EXPECT_EQ(datum_of(*ErrorSymbol::parse(name)), FunctionDatum::Home);
  }
  EXPECT_EQ(LocationSymbol::parse("EA0W")->name(), "EA0W");
  for (const char* name : {"EUX", "EWW", "EU0W"}) {
    EXPECT_FALSE(ErrorSymbol::parse(name).has_value() || LocationSymbol::parse(name).has_value()) << name;
  }
}

std::vector<std::string> independent_names(const std::string& code, double offset_sigma) {
  Machine machine = machine_of(code);
  for (const Vector3d& offset :
       {Vector3d(0.0, 0.0, -0.15), Vector3d(0.1, 0.0, -0.2), Vector3d(0.0, 0.1, -0.2)})
    machine.tools.push_back({"t" + std::to_string(machine.tools.size()), offset, offset_sigma});
  std::vector<std::string> names;
  for (const LocationSymbol& symbol : independent_locations(machine)) names.push_back(symbol.name());
  return names;
}

/// Five angles: three of the frame, two of the quill, whether the tools are known or not.
TEST(ParallelAxes, AQuillHasTwoAnglesBesideThreeOfTheFrame) {
  for (const double sigma : {0.0, 1e-3}) {
    EXPECT_THAT(independent_names("w X' b Y Z W t", sigma),
                ElementsAre("EC0Y", "EA0Z", "EB0Z", "EA0W", "EB0W"));
    EXPECT_THAT(independent_names("w X b Y V Z t", sigma),
                ElementsAre("EC0Y", "EA0Z", "EB0Z", "EA0V", "EC0V"));
  }
}

sim::TruthMachine simulated(const Machine& machine, const PoseErrors<double>& errors) {
  sim::TruthMachine truth(machine);
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const double motion = errors.motion[index_of(axis.name)][index_of(component)];
      truth.set_error({component, axis.name}, [motion](double) { return motion; });
      const double location = errors.location[index_of(axis.name)][index_of(component)];
      if (location != 0.0) truth.set_location({component, axis.name}, location);
    }
  }
  return truth;
}

/// Root mean square difference of the point, exact less first order, over random machines.
double left_of_second_order(const std::string& letters, double factor) {
  std::mt19937_64 random(21);
  constexpr int kMachines = 60;
  double sum = 0.0;
  for (int i = 0; i < kMachines; ++i) {
    const Machine machine = testing_support::random_machine(random, letters);
    const AxisPosition position = testing_support::random_position(random);
    const Vector3d tool = testing_support::random_vector(random, 0.3);
    const PoseErrors<double> errors =
        testing_support::scaled(testing_support::random_errors(random, machine, 100e-6, 100e-6), factor);
    sim::MachineState state;
    state.position = position;
    const Vector3d exact = simulated(machine, errors).point_error(state, tool);
    const Vector3d first = KinematicChain(machine).first_order(position, tool, errors).displacement_w;
    sum += (exact - first).squaredNorm();
  }
  return std::sqrt(sum / kMachines);
}

/// Four to six linear axes, alone and with two rotary ones: the difference falls with the square of the
/// errors.
TEST(ParallelAxes, TheSimulatorDiffersInSecondOrderAlone) {
  for (const char* letters : {"XYZW", "XYZUVW", "XYZWBC"}) {
    const double large = left_of_second_order(letters, 100.0), small = left_of_second_order(letters, 10.0);
    EXPECT_GT(large, 1e-5) << letters;
    EXPECT_NEAR(std::log10(large / small), 2.0, 0.02) << letters;
  }
}

TEST(ParallelAxes, TheExactPoseIsThatOfTheSimulator) {
  std::mt19937_64 random(22);
  double largest = 0.0;
  for (int i = 0; i < 60; ++i) {
    const Machine machine = testing_support::random_machine(random, "XYZUVWABC");
    const AxisPosition position = testing_support::random_position(random);
    const Vector3d tool = testing_support::random_vector(random, 0.3);
    const PoseErrors<double> errors = testing_support::random_errors(random, machine, 1e-2, 1e-2);
    sim::MachineState state;
    state.position = position;
    const auto exact = KinematicChain(machine).exact_pose<double>(position, tool, errors);
    const Eigen::Matrix4d pose = simulated(machine, errors).pose(state, tool);
    largest = std::max(largest, (exact.point_w - pose.topRightCorner<3, 1>()).norm());
    largest = std::max(largest, (exact.rotation_wt - pose.topLeftCorner<3, 3>()).norm());
  }
  EXPECT_LT(largest, 1e-13);
}

}  // namespace
}  // namespace volcal
