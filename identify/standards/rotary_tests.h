#pragma once
/// Direct tests of rotary axes among the setups of a campaign, with their figures of readings and
/// predictions.
///
/// Angular positioning (ISO 230-2): an instrument that reads a rotation about the axis, nothing else moving.
/// Error motions (ISO 230-7): an instrument that reads three displacements of a sphere (columns dx, dy, dz),
/// one rotary axis turning alone; two such setups whose spheres stand at different heights on the axis give
/// its tilt, from the same visit of an angle at both. Directions are those of the body that carries the axis.

#include <span>
#include <vector>

#include "volcal/identify/standards/setup_values.h"
#include "volcal/identify/standards/standard_figures.h"

namespace volcal {

/// `values`: one entry per setup. Setups that read angles while a rotary axis moves and are no test of it are
/// added to `not_recognised`.
std::vector<RotaryPositioningTest> rotary_positioning_tests(const Campaign& campaign,
                                                            std::span<const SetupValues> values,
                                                            std::vector<Finding>& not_recognised);
std::vector<ErrorMotionTest> error_motion_tests(const Campaign& campaign,
                                                std::span<const SetupValues> values);

/// Turns three displacements of a setup (columns dx, dy, dz) into workpiece coordinates; m.
std::vector<Eigen::Vector3d> displacements_w(const Campaign& campaign, const Setup& setup,
                                             const std::vector<std::vector<double>>& value);
/// Whether an instrument's readings are three displacements of a sphere.
bool reads_displacements(const Setup& setup);

}  // namespace volcal
