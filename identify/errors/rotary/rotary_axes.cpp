#include "volcal/identify/errors/rotary/rotary_axes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "volcal/identify/errors/machine_effects.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {

std::vector<AxisName> identified_rotary_axes(const FitResult& result) {
  std::vector<AxisName> axes;
  const auto add = [&axes](AxisName axis) {
    if (is_rotary(axis) && std::ranges::find(axes, axis) == axes.end()) axes.push_back(axis);
  };
  for (const FunctionGroup& group : result.layout.groups) add(group.axis);
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location) add(block.location->axis);
  }
  const MachineEffects effects(result, result.machine.functional_tools().front(), default_conditions(result));
  for (const EffectColumn& column : effects.columns()) {
    if (column.target.kind == TargetKind::Motion) add(column.target.symbol.axis);
  }
  for (std::size_t effect = 0; effect < effects.effect_count(); ++effect) {
    for (const AxisName axis : kAllAxes) {
      if (effects.reach(effect).position[index_of(axis)]) add(axis);
    }
  }
  std::ranges::sort(axes);
  return axes;
}

double reference_of(const FitResult& result, AxisName axis) {
  const auto stood = result.standing.find(axis);
  return stood == result.standing.end() ? result.machine.axis(axis).home : stood->second;
}

bool stands_at_reference(double position, double reference) {
  constexpr double kSameReference = 1e-4;  // rad
  return std::abs(std::remainder(position - reference, 2.0 * std::numbers::pi)) < kSameReference;
}

std::string reference_text(const FitResult& result, AxisName axis) {
  std::ostringstream text;
  text << letter_of(axis) << " at " << reference_of(result, axis) / kRadianPerDegree << " deg";
  return text.str();
}

void require_identified_rotary_axes(const FitResult& result, const AxisPosition& position) {
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  for (const Axis& axis : result.machine.axes) {
    if (!is_rotary(axis.name) ||
        stands_at_reference(position[index_of(axis.name)], reference_of(result, axis.name)))
      continue;
    if (std::ranges::find(identified, axis.name) != identified.end()) continue;
    throw InputError({},
                     std::string("the errors of axis ") + letter_of(axis.name) +
                         " were not identified, and the pose turns it",
                     "leave " + reference_text(result, axis.name) +
                         ", or identify its errors: name its functions and locations in the model file "
                         "and measure with the axis in several positions");
  }
}

std::vector<AxisPosition> poses_of_all_axes(const Machine& machine, int count) {
  return spread_poses(machine, count);
}

std::vector<ApproachedPose> approached_poses_of_all_axes(const Machine& machine, int count) {
  constexpr std::array<int, kAxisCount> kBases = {29, 31, 37, 41, 43, 47, 53, 59, 61};  // not of poses
  std::vector<ApproachedPose> poses;
  for (const AxisPosition& position : poses_of_all_axes(machine, count)) {
    const int number = static_cast<int>(poses.size()) + 1;
    ApproachedPose& pose = poses.emplace_back(ApproachedPose{position});
    for (const Axis& axis : machine.axes) {
      const std::size_t a = index_of(axis.name);
      pose.direction[a] = radical_inverse(number, kBases[a]) < 0.5 ? -1 : 1;
    }
  }
  return poses;
}

AxisLineErrors line_at_machine_zero(const Machine& machine, const PoseErrors<double>& errors, AxisName axis) {
  const std::vector<Joint>& joints = machine.structure.joints;
  const auto own = std::ranges::find(joints, axis, &Joint::axis);
  const Eigen::Vector3d& p = machine.axis(axis).centre;
  AxisLineErrors line;
  for (auto joint = joints.begin(); joint != joints.end(); ++joint) {
    // The bed stands to the right of the workpiece side, to the left of the tool side.
    const bool carries = joint->workpiece_side == own->workpiece_side && is_rotary(joint->axis) &&
                         (own->workpiece_side ? joint >= own : joint <= own);
    if (!carries) continue;
    const auto& location = errors.location[index_of(joint->axis)];
    const int about = direction_of(joint->axis);
    Eigen::Vector3d alpha(location[3], location[4], location[5]);
    alpha[about] = 0.0;
    line.rotation += alpha;
    line.displacement += Eigen::Vector3d(location[0], location[1], location[2]) +
                         alpha.cross(p - machine.axis(joint->axis).centre);
  }
  return line;
}

}  // namespace volcal
