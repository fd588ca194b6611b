#include "volcal/model/instruments/reading_frame.h"

#include <utility>

#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

/// The workpiece's side of the machine alone: its "tool" is the bed.
Machine workpiece_side(Machine machine) {
  std::erase_if(machine.structure.joints, [](const Joint& joint) { return !joint.workpiece_side; });
  return machine;
}

}  // namespace

KeySchema frame_key() {
  return {.key = "frame",
          .type = KeyType::Text,
          .help = "axes of the readings: those of the workpiece (default), of the machine's bed, of the tool",
          .choices = {"workpiece", "machine", "tool"}};
}

bool reads_in_workpiece(const Setup& setup) {
  return setup.options.text("frame").value_or("workpiece") == "workpiece";
}

std::vector<ReadingFrame> reading_frames(const SetupContext& context) {
  std::vector<ReadingFrame> frames(context.setup.readings.size());
  if (reads_in_workpiece(context.setup)) return frames;
  const bool of_tool = *context.setup.options.text("frame") == "tool";
  const KinematicChain chain(of_tool ? context.machine : workpiece_side(context.machine));
  for (std::size_t row = 0; row < frames.size(); ++row) {
    const AxisPosition position = context.setup.readings.commanded_position(row);
    frames[row].rotation = chain.nominal_rotation_wt(position).transpose();
    if (!of_tool) frames[row].origin_w = chain.nominal_point_w(position, Eigen::Vector3d::Zero());
  }
  return frames;
}

std::vector<Eigen::Matrix3d> rotations_to_tool(const SetupContext& context) {
  const KinematicChain chain(context.machine);
  std::vector<Eigen::Matrix3d> rotations;
  for (const ReadingFrame& frame : reading_frames(context)) {
    const AxisPosition position = context.setup.readings.commanded_position(rotations.size());
    rotations.emplace_back((frame.rotation * chain.nominal_rotation_wt(position)).transpose());
  }
  return rotations;
}

}  // namespace volcal
