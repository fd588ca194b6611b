#include "chains.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "volcal/sim/machine/random.h"

namespace volcal::bench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::uint64_t kSeedOfPoses = 3;
constexpr double kLargestError = 1e-5;  // m or rad
constexpr double kTravel = 1.0;         // m

Machine machine_of(const std::string& structure) {
  Machine machine;
  machine.structure = Structure::parse(structure);
  double place = 0.1;
  for (const Joint& joint : machine.structure.joints) {
    Axis& axis = machine.axes.emplace_back();
    axis.name = joint.axis;
    axis.travel_min = is_rotary(joint.axis) ? -std::numbers::pi : 0.0;
    axis.travel_max = is_rotary(joint.axis) ? std::numbers::pi : kTravel;
    axis.reference_point = axis.centre = Vector3d(place, -place, 0.5 * place);
    place += 0.05;
  }
  return machine;
}

/// I + [e]x
Matrix3d small_rotation(const double* e) {
  Matrix3d rotation;
  rotation << 1.0, -e[2], e[1], e[2], 1.0, -e[0], -e[1], e[0], 1.0;
  return rotation;
}

/// The transforms of chain.h with small angles in place of the rotations by errors.
class SmallAngleChain {
 public:
  explicit SmallAngleChain(const Machine& machine) {
    for (const Joint& joint : machine.structure.joints) {
      const Axis& axis = machine.axis(joint.axis);
      joints_.push_back(
          {joint.axis, joint.workpiece_side, is_rotary(joint.axis) ? axis.centre : axis.reference_point});
    }
  }

  Vector3d point_w(const AxisPosition& position, const Vector3d& tool_offset,
                   const PoseErrors<double>& errors) const {
    Vector3d p = tool_offset;
    for (std::size_t i = joints_.size(); i-- > 0;) {
      const auto& [axis, workpiece_side, centre] = joints_[i];
      const auto& motion = errors.motion[index_of(axis)];
      const auto& location = errors.location[index_of(axis)];
      const Vector3d shift(motion[0], motion[1], motion[2]);
      const Matrix3d turn = small_rotation(&motion[3]);
      const double q = position[index_of(axis)];
      const int direction = direction_of(axis);
      if (!is_rotary(axis)) {
        const Vector3d along = Vector3d::Unit(direction);
        const Vector3d travel = q * (along + Vector3d(location[3], location[4], location[5]).cross(along));
        if (workpiece_side) p += travel;
        p = (turn * (p - centre) + centre + shift).eval();
        if (!workpiece_side) p += travel;
        continue;
      }
      std::array<double, 3> tilt = {location[3], location[4], location[5]};
      const auto own = static_cast<std::size_t>(direction);
      const Matrix3d about_axis = rotation_about(direction, q + tilt[own]);
      tilt[own] = 0.0;
      const Matrix3d orientation = small_rotation(tilt.data());
      const Vector3d actual = centre + Vector3d(location[0], location[1], location[2]);
      if (workpiece_side) {
        p = (about_axis * (turn * (orientation.transpose() * (p - actual)) + shift) + centre).eval();
      } else {
        p = (orientation * (turn * (about_axis * (p - centre)) + shift) + actual).eval();
      }
    }
    return p;
  }

 private:
  struct ChainJoint {
    AxisName axis;
    bool workpiece_side;
    Vector3d centre;
  };
  std::vector<ChainJoint> joints_;
};

/// Twists of kLanes poses side by side, as the fit sums them: R (d + e x arm) joint by joint.
class TwistLanes {
 public:
  explicit TwistLanes(const Machine& machine)
      : chain_(machine),
        joints_(machine.structure.joints),
        turns_(std::ranges::any_of(joints_, [](const Joint& joint) { return is_rotary(joint.axis); })),
        arm_(3 * joints_.size()),
        rotation_(9 * joints_.size()) {}

  void errors(const PoseLanes& poses, const Vector3d& tool_offset, Vector3d* errors) {
    chain_.levers(poses.position.data(), tool_offset, point_.data(), arm_.data(),
                  turns_ ? rotation_.data() : nullptr);
    std::array<Lanes, 3> sum{};
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
      find_motion(poses, joint);
      add_cross(turn_.data(), arm_.data() + 3 * joint, shift_.data());
      if (turns_) {
        rotate(rotation_.data() + 9 * joint, shift_.data(), false, turned_.data());
        for (std::size_t k = 0; k < 3; ++k) add_scaled(turned_[k], 1.0, sum[k]);
      } else {
        for (std::size_t k = 0; k < 3; ++k) add_scaled(shift_[k], 1.0, sum[k]);
      }
    }
    for (int lane = 0; lane < kLanes; ++lane)
      errors[lane] = Vector3d(sum[0][lane], sum[1][lane], sum[2][lane]);
  }

 private:
  /// Displacement and rotation of a joint, its location errors included.
  void find_motion(const PoseLanes& poses, std::size_t joint) {
    const AxisName axis = joints_[joint].axis;
    const auto own = static_cast<std::size_t>(direction_of(axis));
    const auto& motion = poses.motion[index_of(axis)];
    const auto& location = poses.location[index_of(axis)];
    for (std::size_t k = 0; k < 3; ++k) {
      shift_[k] = motion[k];
      turn_[k] = motion[k + 3];
    }
    if (is_rotary(axis)) {
      const double sign = joints_[joint].workpiece_side ? -1.0 : 1.0;
      for (std::size_t k = 0; k < 3; ++k) {
        add_scaled(location[k], sign, shift_[k]);
        add_scaled(location[k + 3], k == own ? 1.0 : sign, turn_[k]);
      }
    } else {
      std::array<Lanes, 3> travelled{};
      travelled[own] = poses.position[index_of(axis)];
      add_cross(&location[3], travelled.data(), shift_.data());
    }
  }

  KinematicChain chain_;
  std::vector<Joint> joints_;
  bool turns_;
  std::array<Lanes, 3> point_, shift_, turn_, turned_;
  std::vector<Lanes> arm_, rotation_;
};

/// Poses `first` to first + kLanes.
PoseLanes side_by_side(const Poses& poses, std::size_t first) {
  PoseLanes lanes;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const std::size_t pose = first + static_cast<std::size_t>(lane);
      lanes.position[axis][lane] = poses.position[pose][axis];
      for (std::size_t k = 0; k < 6; ++k) {
        lanes.motion[axis][k][lane] = poses.errors[pose].motion[axis][k];
        lanes.location[axis][k][lane] = poses.errors[pose].location[axis][k];
      }
    }
  }
  return lanes;
}

}  // namespace

Poses random_poses(const std::string& structure, std::size_t count) {
  Poses poses;
  poses.machine = machine_of(structure);
  poses.tool_offset = Vector3d(0.05, -0.02, -0.2);
  sim::RandomStream random(kSeedOfPoses, structure);
  const auto any = [&](double width) { return width * (2.0 * random.uniform() - 1.0); };
  for (std::size_t i = 0; i < count; ++i) {
    AxisPosition& position = poses.position.emplace_back();
    PoseErrors<double>& errors = poses.errors.emplace_back();
    for (const Axis& axis : poses.machine.axes) {
      position[index_of(axis.name)] = axis.travel_min + random.uniform() * axis.travel();
      for (double& value : errors.motion[index_of(axis.name)]) value = any(kLargestError);
      auto& location = errors.location[index_of(axis.name)];
      for (std::size_t k = is_rotary(axis.name) ? 0 : 3; k < 6; ++k) location[k] = any(kLargestError);
    }
  }
  for (std::size_t first = 0; first < count; first += kLanes)
    poses.lanes.push_back(side_by_side(poses, first));
  return poses;
}

void volumetric_errors(const Poses& poses, Transforms transforms, std::vector<Vector3d>& errors) {
  const KinematicChain chain(poses.machine);
  const SmallAngleChain small(poses.machine);
  TwistLanes lanes(poses.machine);
  const std::size_t count = poses.position.size();
  errors.resize(count);
  if (transforms == Transforms::TwistsInLanes) {
    for (std::size_t i = 0; i < poses.lanes.size(); ++i)
      lanes.errors(poses.lanes[i], poses.tool_offset, errors.data() + i * kLanes);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const AxisPosition& position = poses.position[i];
    if (transforms == Transforms::Twists) {
      errors[i] = chain.first_order(position, poses.tool_offset, poses.errors[i]).displacement_w;
      continue;
    }
    const Vector3d actual =
        transforms == Transforms::Exact
            ? chain.exact_pose<double>(position, poses.tool_offset, poses.errors[i]).point_w
            : small.point_w(position, poses.tool_offset, poses.errors[i]);
    errors[i] = actual - chain.nominal_point_w(position, poses.tool_offset);
  }
}

}  // namespace volcal::bench
