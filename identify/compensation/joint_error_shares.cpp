#include "volcal/identify/compensation/joint_error_shares.h"

namespace volcal {
namespace {

JointErrorSource of_axes(const JointErrorSource& all, bool rotary) {
  return [all, rotary](const AxisPosition& position, const ApproachDirection& direction) {
    PoseErrors<double> errors = all(position, direction);
    for (const AxisName axis : kAllAxes) {
      if (is_rotary(axis) == rotary) continue;
      errors.motion[index_of(axis)] = {};
      errors.location[index_of(axis)] = {};
    }
    return errors;
  };
}

}  // namespace

JointErrorSource of_rotary_axes(const JointErrorSource& all) { return of_axes(all, true); }
JointErrorSource of_linear_axes(const JointErrorSource& all) { return of_axes(all, false); }

}  // namespace volcal
