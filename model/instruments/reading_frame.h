#pragma once
/// Axes that an instrument's three components refer to.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/instruments/instrument.h"

namespace volcal {

/// Key `frame` of instruments whose readings are vectors.
KeySchema frame_key();

/// Where the origin and axes of a frame stand at a reading, by the nominal machine: p_frame = rotation (p_w -
/// origin_w), workpiece coordinates to those of the frame. Of the tool's frame the origin is the workpiece's.
struct ReadingFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_w = Eigen::Vector3d::Zero();
};

/// One frame per reading: of the workpiece (the default), of the machine's bed, or of the tool.
std::vector<ReadingFrame> reading_frames(const SetupContext& context);
/// Per reading: turns a vector in the axes of the readings into those of the tool.
std::vector<Eigen::Matrix3d> rotations_to_tool(const SetupContext& context);
/// Whether the setup's readings refer to the workpiece.
bool reads_in_workpiece(const Setup& setup);

}  // namespace volcal
