#pragma once
/// Rotary axes of an identified machine: which were identified, and where their average lines lie.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/errors/pose.h"
#include "volcal/identify/result/result.h"

namespace volcal {

/// Rotary axes of which functions or location errors were identified, or an effect that acts on them or
/// depends on their position, A B C.
std::vector<AxisName> identified_rotary_axes(const FitResult& result);

/// Where a rotary axis stands as far as a result knows its errors that were not identified, rad: what they
/// add there is in the errors of the others. Where it stood in the campaign; at home where that is not known.
double reference_of(const FitResult& result, AxisName axis);
/// Whether an axis of which nothing was identified stands there, or whole turns from there, to 0.006 deg.
bool stands_at_reference(double position, double reference);
/// "C at 90 deg"
std::string reference_text(const FitResult& result, AxisName axis);

/// Throws InputError where a rotary axis stands away from its reference whose errors were not identified.
void require_identified_rotary_axes(const FitResult& result, const AxisPosition& position);

/// Poses spread evenly over the travel of all axes, of a rotary axis over a turn at most.
std::vector<AxisPosition> poses_of_all_axes(const Machine& machine, int count);
/// A pose and how its axes reach it.
struct ApproachedPose {
  AxisPosition position{};
  ApproachDirection direction{};
};
/// The same poses, every axis reached from either side as often, whatever its place.
std::vector<ApproachedPose> approached_poses_of_all_axes(const Machine& machine, int count);

/// Errors of an axis average line in the machine frame, all axes at 0.
struct AxisLineErrors {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< at the axis' nominal centre, m
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();      ///< rad
};

/// Location errors of the model are relative to the carrying body; ISO 230-1 states them in the machine frame
/// at machine zero, where those of the rotary axes that carry it add up: with p the nominal centres and
/// carriers i, alpha = sum alpha_i, d = sum d_i + alpha_i x (p - p_i). `axis` must be a rotary axis of the
/// machine.
AxisLineErrors line_at_machine_zero(const Machine& machine, const PoseErrors<double>& errors, AxisName axis);

}  // namespace volcal
