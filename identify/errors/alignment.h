#pragma once
/// An identified machine seen in another machine coordinate system: other primary and secondary axis, other
/// origin, other reference direction (ISO/TR 16907:2015, 7.3, 10.2 and 11.3 d). Nothing is identified anew.
///
/// With dP the error of the functional point, q the axes' positions and t the tool, to first order and up to
/// a rigid motion of the workpiece
///   dP'(q, t) = dP(q, t) - phi x q - tau(t)
/// phi turns the machine frame, tau moves its origin. Both are linear in the parameters, so theta' = J theta
/// + k and C' = J C J^T: errors are the same up to the rigid motion, and so is the covariance of what a rigid
/// motion leaves. Angles that axes have at the new origin become directions of the axes that they carry, and
/// turn the tools. Where a table turns the workpiece and no rotary axis the tools, offsets stay what the
/// control knows, and the turn is the effect `spindle-direction`. A rotary axis on the tool side takes it
/// into its lines. Without errors of rotary axes it displaces a tool everywhere alike, and the offsets are
/// stated in the new frame.

#include <optional>
#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

struct Alignment {
  Datum datum;
  /// Of X, Y, Z, where every function is zero, m; absent = the axes' homes.
  std::optional<AxisPosition> origin;
  /// The frame's direction of the primary axis is the spindle's instead of the axis's own reference straight
  /// line. The value is the rotation of the spindle against that line about x and about y, rad: zero where it
  /// was set up parallel to the uncompensated motion. The primary axis must be Z, to which spindles are
  /// parallel (ISO 841); what remains between its motion and the spindle stays in EXZ and EYZ as a slope.
  std::optional<Eigen::Vector2d> spindle_tilt;
};

/// The datum that somebody wants: axes that are not named are those of the former datum, as far as the others
/// leave them. With the spindle as the reference direction the primary axis is Z unless another one is named.
Datum wished_datum(const Datum& former, std::optional<AxisName> primary, std::optional<AxisName> secondary,
                   bool spindle);

struct AlignedResult {
  FitResult result;  ///< without the campaign's nuisance parameters, which belong to the former frame
  Eigen::Vector3d frame_rotation = Eigen::Vector3d::Zero();    ///< phi, rad
  Eigen::Matrix3d frame_covariance = Eigen::Matrix3d::Zero();  ///< of phi, rad^2
};

/// Lines of rotary axes stay where they are: their location errors are restated in the new frame, so that
/// the error at every pose is the same but for a rigid motion of the workpiece. Error motions of rotary axes
/// do not change.
///
/// Throws InputError with a remedy: a machine without X, Y and Z, location errors of rotary axes that the
/// model lacks and the new frame needs, primary = secondary, an origin outside the travel, a spindle with
/// another primary axis than Z, a function whose basis cannot hold the constant or the slope, or effects that
/// refer to the former origin: they count positions from home. Surfaces, expressions and reversals do not.
AlignedResult align_result(const FitResult& result, const Alignment& alignment);

/// Whether errors are stated in another coordinate system than that of a machine file: aligned, or another
/// datum or home.
bool is_in_other_frame(const FitResult& result, const Machine& machine);

/// Readings of a campaign of the machine as it was identified, in the coordinate system of such errors: their
/// datum, origin and tool offsets. Readings that count from the nominal tool point, which the control has
/// from the former offsets, are restated for the new ones. Any other campaign and result stay as they are;
/// where errors do not say that they are aligned, so do tools whose offsets are no turn of the former ones.
void adopt_alignment(Campaign& campaign, const FitResult& result);

}  // namespace volcal
