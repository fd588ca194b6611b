// Compensation of rotary axes on exact machines of sim, which share no physics with model/.

#include "volcal/identify/compensation/five_axis_compensation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/long_tests.h"
#include "tests/support/machines.h"
#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using Part = CompensationPart;

constexpr double kToolLength = 0.2;                         // m
constexpr double kLocation = 15e-6, kOrientation = 40e-6;   // m, rad
constexpr double kErrorMotion = 3e-6, kTiltMotion = 15e-6;  // m, rad

Vector3d tool_of_length(double length) { return {0.0, 0.0, -length}; }

/// Table and cradle, or head on a table that moves along X.
Machine five_axis_machine(const std::string& structure) {
  Machine machine = testing_support::machine_of(structure);
  for (Axis& axis : machine.axes) {
    if (axis.name == AxisName::A) axis.centre = {0.0, 0.0, 0.05};
    if (!is_rotary(axis.name)) axis.travel_min = -0.3, axis.travel_max = 0.3;
  }
  return machine;
}

/// Location errors of standard deviation 0.7 of the stated sizes, error motions of one and two waves a turn
/// with the stated amplitude, positioning zero at 0.
sim::TruthMachine truth_of(const std::string& structure, std::uint64_t seed) {
  sim::TruthMachine truth(five_axis_machine(structure));
  sim::RandomStream random(seed, "five axes");
  const double turn = 2.0 * std::numbers::pi;
  for (const Axis& axis : truth.machine().axes) {
    if (!is_rotary(axis.name)) continue;
    for (const Component component : kAllComponents) {
      const bool along = !is_rotation(component) && direction_of(component) == direction_of(axis.name);
      const double location = is_rotation(component) ? kOrientation : kLocation;
      if (!along) truth.set_location({component, axis.name}, location * std::sin(random.uniform(0.0, turn)));
      const double size = is_rotation(component) ? kTiltMotion : kErrorMotion;
      const double share = random.uniform(0.0, turn), p1 = random.uniform(0.0, turn),
                   p2 = random.uniform(0.0, turn);
      const double one = size * std::cos(share), two = size * std::sin(share);
      const bool positioning = ErrorSymbol{component, axis.name}.is_positioning();
      const double at_zero = positioning ? one * std::sin(p1) + two * std::sin(p2) : 0.0;
      truth.set_error({component, axis.name}, [=](double q) {
        return one * std::sin(q + p1) + two * std::sin(2.0 * q + p2) - at_zero;
      });
    }
  }
  return truth;
}

JointErrorSource true_errors(const sim::TruthMachine& truth) {
  return [&truth](const AxisPosition& position, const ApproachDirection&) {
    PoseErrors<double> errors;
    for (const Axis& axis : truth.machine().axes) {
      for (const Component component : kAllComponents) {
        errors.motion[index_of(axis.name)][index_of(component)] =
            truth.function_value({component, axis.name}, position[index_of(axis.name)]);
        errors.location[index_of(axis.name)][index_of(component)] = truth.location({component, axis.name});
      }
    }
    return errors;
  };
}

/// Tool points up to 200 mm above the table within 150 mm of its middle; C over a turn, tilt to 100 degrees.
AxisPosition random_pose(sim::RandomStream& random) {
  AxisPosition position{};
  position[0] = random.uniform(-0.15, 0.15);
  position[1] = random.uniform(-0.15, 0.15);
  position[2] = kToolLength + random.uniform(0.0, 0.2);
  position[3] = random.uniform(-100.0, 30.0) * kRadianPerDegree;
  position[4] = random.uniform(-100.0, 100.0) * kRadianPerDegree;
  position[5] = random.uniform(-180.0, 180.0) * kRadianPerDegree;
  return position;
}

/// What is left of the tool point, um, and of the direction of the tool's axis, urad.
struct RotaryResidual {
  double rms = 0.0, max = 0.0, p95 = 0.0, axis = 0.0, largest_move = 0.0;
};

struct RotaryTrial {
  std::string type;
  double controls_length = kToolLength;  ///< that the control knows
  double reference_length = kToolLength;
  double real_length = kToolLength;
  double least_tilt = 0.0;  ///< of A or B, rad: poses nearer the pole are left out
};

/// The exact machine under corrected commands.
class RotaryJudge {
 public:
  explicit RotaryJudge(std::string structure) : structure_(std::move(structure)) {}

  RotaryResidual residual(const RotaryTrial& trial) const {
    std::vector<double> left;
    double axis_square = 0.0, largest_move = 0.0;
    const int machines = testing::short_or_long(6, 20), poses = testing::short_or_long(300, 2000);
    for (int m = 0; m < machines; ++m) {
      const sim::TruthMachine truth = truth_of(structure_, 700 + static_cast<std::uint64_t>(m));
      const auto compensation = compensation_of(trial, truth);
      sim::RandomStream random(31 + static_cast<std::uint64_t>(m), "poses");
      for (int i = 0; i < poses; ++i) {
        const AxisPosition pose = random_pose(random);
        if (std::abs(tilt(truth.machine(), pose)) < trial.least_tilt) continue;
        const Correction correction = compensation ? compensation->correction(pose) : Correction{};
        largest_move = std::max(largest_move, correction.rotary.cwiseAbs().maxCoeff());
        const auto [point, axis] = error(truth, pose, correction, tool_of_length(trial.real_length));
        left.push_back(point);
        axis_square += axis * axis;
      }
    }
    std::ranges::sort(left);
    double square = 0.0;
    for (const double l : left) square += l * l;
    const auto count = static_cast<double>(left.size());
    return {std::sqrt(square / count) / kMicro, left.back() / kMicro,
            left[static_cast<std::size_t>(0.95 * count)] / kMicro, std::sqrt(axis_square / count) / kMicro,
            largest_move};
  }

 private:
  static double tilt(const Machine& machine, const AxisPosition& pose) {
    return machine.has_axis(AxisName::A) ? pose[3] : pose[4];
  }

  static std::optional<FiveAxisCompensation> compensation_of(const RotaryTrial& trial,
                                                             const sim::TruthMachine& truth) {
    if (trial.type.empty()) return std::nullopt;
    FiveAxisSettings settings;
    settings.type = CompensationType::parse(trial.type);
    settings.tool_offset = tool_of_length(trial.controls_length);
    settings.reference.tool_offset = tool_of_length(trial.reference_length);
    return FiveAxisCompensation(truth.machine(), settings, true_errors(truth));
  }

  static std::pair<double, double> error(const sim::TruthMachine& truth, const AxisPosition& pose,
                                         const Correction& correction, const Vector3d& tool) {
    sim::MachineState programmed, commanded;
    programmed.position = pose;
    commanded.position = correction.applied_to(pose);
    const Eigen::Matrix4d nominal = truth.nominal_pose(programmed, tool),
                          actual = truth.pose(commanded, tool);
    const Vector3d n = nominal.block<3, 1>(0, 2), a = actual.block<3, 1>(0, 2);
    return {(actual - nominal).topRightCorner<3, 1>().norm(), std::atan2(n.cross(a).norm(), n.dot(a))};
  }

  std::string structure_;
};

void show_residual(const std::string& name, const RotaryResidual& r) {
  ::testing::Test::RecordProperty(name, std::to_string(r.rms) + " " + std::to_string(r.max) + " " +
                                            std::to_string(r.p95) + " " + std::to_string(r.axis));
  if (std::getenv("VOLCAL_SHOW_RESIDUALS") != nullptr)
    std::printf("%-34s RMS %8.3f max %9.3f p95 %8.3f um, axis %7.2f urad, largest rotary move %.0f urad\n",
                name.c_str(), r.rms, r.max, r.p95, r.axis, r.largest_move / kMicro);
}

/// EX0C = 10 um: the table's axis lies 10 um towards x and takes the workpiece there; the tool follows, at
/// every angle. ECC = 10 urad at every angle but 0 is taken off the command of C.
TEST(RotaryCompensation, MovesTheToolToWhereTheTableLies) {
  const Machine machine = five_axis_machine("w C' b X Y Z t");
  PoseErrors<double> errors;
  testing_support::error_of(errors, "EX0C") = 10e-6;
  testing_support::error_of(errors, "ECC") = 10e-6;
  const FiveAxisCompensation compensation(
      machine, FiveAxisSettings{}, [&](const AxisPosition&, const ApproachDirection&) { return errors; });
  for (const double angle : {0.0, 1.0, 2.5}) {
    const Correction correction = compensation.correction({0.1, 0.05, 0.0, 0.0, 0.0, angle});
    EXPECT_LT((correction.linear - Vector3d(10e-6, 0, 0)).norm(), 1e-15) << angle;
    EXPECT_LT((correction.rotary - Vector3d(0, 0, -10e-6)).norm(), 1e-15) << angle;
  }
}

/// EBC = 100 urad of a head, C = 0, tool 200 mm long: R-VOL moves X by 100e-6 x 200 mm = 20 um; R-RAX with a
/// reference tool of 150 mm 15 of them, R-ANG the other 5.
TEST(RotaryCompensation, SplitsTiltAtTheReferenceTool) {
  const Machine machine = five_axis_machine("w b X Y Z C t");
  PoseErrors<double> errors;
  testing_support::error_of(errors, "EBC") = 100e-6;
  const auto x_um = [&](const char* type) {
    FiveAxisSettings settings;
    settings.type = CompensationType::parse(type);
    settings.tool_offset = tool_of_length(0.2);
    settings.reference.tool_offset = tool_of_length(0.15);
    return FiveAxisCompensation(machine, settings,
                                [&](const AxisPosition&, const ApproachDirection&) { return errors; })
               .correction({})
               .linear.x() /
           kMicro;
  };
  EXPECT_NEAR(x_um("R-VOL"), 20.0, 1e-9);
  EXPECT_NEAR(x_um("R-RAX"), 15.0, 1e-9);
  EXPECT_NEAR(x_um("R-ANG"), 5.0, 1e-9);
  EXPECT_NEAR(x_um("R-POS+R-POR"), 0.0, 1e-9);
}

/// A table's reference point at 300 mm: EBC = 100 urad moves it by 30 um along x.
TEST(RotaryCompensation, StatesTheDisplacementOfATableAtAnElevation) {
  const Machine machine = five_axis_machine("w C' b X Y Z t");
  PoseErrors<double> errors;
  testing_support::error_of(errors, "EBC") = 100e-6;
  FiveAxisSettings settings;
  settings.type = Part::RotaryRadialAxial;
  settings.reference.elevation[2] = 0.3;
  const FiveAxisCompensation compensation(
      machine, settings, [&](const AxisPosition&, const ApproachDirection&) { return errors; });
  for (const double height : {0.0, 0.3, 0.6})
    EXPECT_NEAR(compensation.correction({0, 0, height, 0, 0, 0.4}).linear.x() / kMicro, -30.0, 1e-9);
}

/// EAX = 50 urad tilts the tool about x: FOR turns A back by as much, L-VOL+ and the linear axes undo the
/// displacement by both.
TEST(RotaryCompensation, OrientationIncludesErrorsOfLinearAxes) {
  const Machine machine = five_axis_machine(testing::kTrunnion);
  PoseErrors<double> errors;
  testing_support::error_of(errors, "EAX") = 50e-6;
  FiveAxisSettings settings;
  settings.type = CompensationType::parse("L-VOL+");
  settings.tool_offset = tool_of_length(0.2);
  settings.damping = 1e-6;
  const FiveAxisCompensation compensation(machine, settings,
                                          [&](const AxisPosition& q, const ApproachDirection&) {
                                            PoseErrors<double> at_home_none;
                                            if (q[0] > 0.05) at_home_none = errors;
                                            return at_home_none;
                                          });
  const AxisPosition pose = {0.1, 0.02, 0.3, -0.8, 0.0, 0.0};
  const Correction correction = compensation.correction(pose);
  EXPECT_NEAR(correction.rotary.x(), -50e-6, 1e-8);
  const FiveAxisCompensation::Left left = compensation.left_by(correction, pose);
  EXPECT_LT(left.displacement_w.norm(), 1e-12);
  EXPECT_LT(left.axis, 1e-9);
  EXPECT_NEAR(compensation.left_by({}, pose).axis, 50e-6, 1e-9);
}

TEST(RotaryCompensation, ForNeedsThreeLinearAxesAndTwoThatTurnTheTool) {
  const auto message = [](const std::string& structure, const char* type) {
    FiveAxisSettings settings;
    settings.type = CompensationType::parse(type);
    return testing::refusal([&] {
      FiveAxisCompensation(
          five_axis_machine(structure), settings,
          [](const AxisPosition&, const ApproachDirection&) { return PoseErrors<double>(); });
    });
  };
  EXPECT_NE(message("w C' b X Y Z t", "FOR").find("8.2.6"), std::string::npos);
  EXPECT_NE(message("w A' b X Y Z C t", "R-VOL+").find("8.2.6"), std::string::npos);  // C is the tool's axis
  EXPECT_NE(message("w C' A' b X Y t", "L-VOL+").find("8.2.6"), std::string::npos);
  EXPECT_EQ(message(testing::kTrunnion, "R-VOL+"), "");
  EXPECT_EQ(message(testing::kMixed, "FOR"), "");
  EXPECT_EQ(message("w C' b X Y Z t", "R-VOL"), "");
}

/// w X' C' b Y Z t: at C = 90 degrees X and Y move the tool along one line; what they cannot move is left.
TEST(RotaryCompensation, DirectionsThatNoLinearAxisMovesAreLeft) {
  const Machine machine = five_axis_machine("w X' C' b Y Z t");
  PoseErrors<double> errors;
  testing_support::error_of(errors, "EX0C") = 10e-6;
  testing_support::error_of(errors, "EY0C") = 10e-6;
  const FiveAxisCompensation compensation(
      machine, FiveAxisSettings{}, [&](const AxisPosition&, const ApproachDirection&) { return errors; });
  for (const double degrees : {0.0, 45.0, 89.9, 90.0}) {
    const AxisPosition pose = {0.1, 0.0, 0.0, 0.0, 0.0, degrees * kRadianPerDegree};
    const Correction correction = compensation.correction(pose);
    EXPECT_LT(correction.linear.norm(), 50e-6) << degrees;
    const double left = compensation.left_by(correction, pose).displacement_w.norm();
    EXPECT_LT(left, degrees < 50.0 ? 1e-8 : 11e-6) << degrees;
  }
}

class RotaryResiduals : public ::testing::TestWithParam<const char*> {
 protected:
  RotaryResidual of(const RotaryTrial& trial) const {
    const RotaryResidual r = judge_.residual(trial);
    show_residual(std::string(GetParam()) + " " + trial.type, r);
    return r;
  }
  bool is_trunnion() const { return std::string(GetParam()) == testing::kTrunnion; }

  RotaryJudge judge_{GetParam()};
};

TEST_P(RotaryResiduals, FallFromTypeToType) {
  const RotaryResidual none = of({""}), por = of({"R-POR"}), pos_por = of({"R-POS+R-POR"});
  const RotaryResidual pos_rax_por = of({"R-POS+R-RAX+R-POR"}), volume = of({"R-VOL"});
  EXPECT_NEAR(none.rms, 25.0, 7.0);
  EXPECT_NEAR(none.axis, 55.0, 13.0);
  EXPECT_NEAR(por.rms, 9.0, 3.0);
  EXPECT_EQ(por.axis, none.axis);
  EXPECT_LT(volume.rms, 3e-3);
  EXPECT_LT(volume.max, 15e-3);
  EXPECT_LE(volume.rms, pos_rax_por.rms);
  EXPECT_LE(pos_rax_por.rms, pos_por.rms);
  if (is_trunnion()) {
    EXPECT_NEAR(pos_rax_por.rms, 3.3, 1.2);
  } else {
    EXPECT_LT(pos_rax_por.rms, 3e-3);  // at the reference length R-RAX holds all that tilt does
    const RotaryResidual longer =
        of({"R-POS+R-RAX+R-POR", kToolLength + 0.1, kToolLength, kToolLength + 0.1});
    EXPECT_NEAR(longer.rms, 1.8, 0.5);
    EXPECT_LT(of({"R-VOL", kToolLength + 0.1, kToolLength, kToolLength + 0.1}).rms, 3e-3);
  }
}

TEST_P(RotaryResiduals, OrientationChangesUnderPositioningAndForAlone) {
  const double before = of({""}).axis;
  for (const char* type : {"R-RAX", "R-POR", "R-ANG", "R-RAX+R-POR+R-ANG", "L-VOL"})
    EXPECT_NEAR(of({type}).axis, before, 0.02) << type;
  EXPECT_GT(std::abs(of({"R-POS"}).axis - before), 1.0);
  EXPECT_EQ(of({"R-POS"}).axis, of({"R-VOL"}).axis);
  EXPECT_LT(of({"FOR"}).axis, 0.1 * before);
}

TEST_P(RotaryResiduals, AWrongToolLengthCostsItsLengthTimesTheTilt) {
  const RotaryResidual wrong = of({"R-VOL", kToolLength, kToolLength, kToolLength + 0.01});
  EXPECT_NEAR(wrong.rms, 0.5, 0.2);
  EXPECT_LT(wrong.max, 1.5);
}

TEST_P(RotaryResiduals, OrientationIsNulledAndTheLinearAxesUndoItsTranslation) {
  const RotaryResidual alone = of({"FOR"}), both = of({"R-VOL+"});
  EXPECT_GT(alone.rms, 3.0 * both.rms);
  EXPECT_LT(both.rms, 1e-3);
  EXPECT_LT(both.max, 20e-3);
  // Away from the pole 1 % of the orientation error is left.
  const RotaryResidual away = of({"R-VOL+", kToolLength, kToolLength, kToolLength, 6.0 * kRadianPerDegree});
  EXPECT_LT(away.axis, 0.01 * of({""}).axis);
  EXPECT_LT(away.max, 1e-3);
  constexpr double kLargestOrientationError = 200e-6;  // rad
  EXPECT_LT(both.largest_move, kLargestOrientationError / (2.0 * kOrientationDamping));
}

/// At the pole C does not turn the tool's axis, near it hardly: moves stay finite and the error does not
/// grow.
TEST_P(RotaryResiduals, MovesAreBoundedAtThePole) {
  const sim::TruthMachine truth = truth_of(GetParam(), 705);
  FiveAxisSettings settings;
  settings.type = CompensationType::parse("R-VOL+");
  settings.tool_offset = tool_of_length(kToolLength);
  const FiveAxisCompensation compensation(truth.machine(), settings, true_errors(truth));
  for (const double tilt : {0.0, 1e-9, 1e-4, 2e-3, 1e-2, 2e-2, 0.1}) {
    AxisPosition pose = {0.1, -0.05, 0.3, 0.0, 0.0, 0.7};
    pose[is_trunnion() ? 3 : 4] = tilt;
    const Correction correction = compensation.correction(pose);
    const FiveAxisCompensation::Left before = compensation.left_by({}, pose);
    const FiveAxisCompensation::Left after = compensation.left_by(correction, pose);
    EXPECT_LT(correction.rotary.cwiseAbs().maxCoeff(), before.axis / (2.0 * kOrientationDamping) + 1e-4)
        << tilt;
    EXPECT_LE(after.axis, before.axis) << tilt;
    EXPECT_LT(after.displacement_w.norm(), 1e-10) << tilt;
  }
}

/// A quill W at random positions, on a trunnion and inside a swivelling head, where it goes along x at B = 90
/// degrees: X, Y and Z undo what the rotary axes do at the end of it and, in L-VOL, what the quill itself
/// does.
TEST(RotaryCompensation, ReachesTheEndOfAQuill) {
  for (const char* structure : {"w C' A' b X Y Z W t", "w X' b Y Z C B W t"}) {
    sim::TruthMachine truth = truth_of(structure, 5);
    truth.set_error({Component::X, AxisName::W}, [](double q) { return 2e-4 * q * q; });
    truth.set_error({Component::B, AxisName::W}, [](double q) { return 4e-5 * q; });
    truth.set_location({Component::A, AxisName::W}, 3e-5);
    double all = 0.0, without_quill = 0.0;
    for (const char* type : {"L-VOL+R-VOL", "R-VOL"}) {
      FiveAxisSettings settings;
      settings.type = CompensationType::parse(type);
      settings.tool_offset = tool_of_length(kToolLength);
      const FiveAxisCompensation compensation(truth.machine(), settings, true_errors(truth));
      sim::RandomStream random(8, "poses");
      for (int i = 0; i < 200; ++i) {
        sim::MachineState programmed, commanded;
        programmed.position = random_pose(random);
        programmed.position[index_of(AxisName::W)] = random.uniform(-0.2, 0.2);
        commanded.position = compensation.correction(programmed.position).applied_to(programmed.position);
        const double left = (truth.pose(commanded, settings.tool_offset) -
                             truth.nominal_pose(programmed, settings.tool_offset))
                                .topRightCorner<3, 1>()
                                .norm();
        double& largest = settings.type.has(Part::Positioning) ? all : without_quill;
        largest = std::max(largest, left);
      }
    }
    EXPECT_LT(all, 1e-8) << structure;
    EXPECT_GT(without_quill, 5e-6) << structure;  // 8 um of EXW, 6 um of EA0W and their like
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, RotaryResiduals, ::testing::Values(testing::kTrunnion, testing::kHead),
                         [](const auto& tested) {
                           return std::string(tested.param) == testing::kTrunnion ? "Trunnion" : "Head";
                         });

}  // namespace
}  // namespace volcal
