#pragma once
/// Five-axis machines whose errors are known, read by an R-test over a grid of two rotary axes: exact
/// transforms of `sim`, functions of three harmonics, and what a prediction leaves at other poses.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/studies/files/five_axis_machines.h"

namespace volcal::studies {

struct FiveAxisErrors {
  double displacement = 3e-6;        ///< RMS of a rotary error motion, m
  double rotation = 15e-6;           ///< rad
  double offset = 15e-6;             ///< of a location, m
  double tilt = 40e-6;               ///< rad
  double linear_displacement = 0.0;  ///< of linear axes, which a fit of rotary errors alone cannot know, m
  double linear_rotation = 0.0;      ///< rad
};

/// Errors drawn: of every rotary axis its locations and error motions of three harmonics.
sim::TruthMachine five_axis_truth(const Machine& machine, const FiveAxisErrors& errors, std::uint64_t seed);

sim::MachineState state_of(const AxisPosition& position, std::size_t tool);

/// Linear positions that bring the nominal tool point to a place of the workpiece.
AxisPosition followed(const KinematicChain& chain, AxisPosition position, const Tool& tool,
                      const Eigen::Vector3d& place_w);

struct GridPlan {
  int turns = 12;  ///< positions of C
  int tilts = 9;   ///< positions of the other axis
  double noise = 1.5e-6;
  std::vector<Eigen::Vector3d> spheres_w = {{0.1, 0.0, 0.05}, {-0.06, 0.09, 0.05}, {-0.05, -0.08, 0.12}};
  std::size_t tools = 3;  ///< of the machine's, the first
  bool singly = false;    ///< one axis after the other, the other at 0, as a probing cycle moves them
};

/// One setup per tool and sphere by the instrument r-test; a sphere stands still while tools are changed.
Campaign r_test_campaign(const sim::TruthMachine& truth, const GridPlan& plan, std::uint64_t seed);

/// Random poses of all axes with the tool point near the workpiece's middle, tools in turn.
struct FreshPose {
  AxisPosition position{};
  std::size_t tool = 0;
};
std::vector<FreshPose> fresh_poses(const Machine& machine, std::uint64_t seed);

/// What the datums of a set-up take off the displacements at these poses: one shift and rotation of the
/// workpiece; three rows a pose, orthonormal columns.
Eigen::MatrixXd setup_datums(const Machine& machine, const std::vector<FreshPose>& poses);

/// RMS over fresh poses of the truth less a prediction, after the datums of a set-up, m.
double error_after_datums(
    const sim::TruthMachine& truth,
    const std::function<Eigen::Vector3d(const AxisPosition& position, std::size_t tool)>& predicted,
    std::uint64_t seed);

}  // namespace volcal::studies
