#pragma once
/// Errors of some of the axes alone.

#include "volcal/identify/compensation/five_axis_compensation.h"

namespace volcal {

JointErrorSource of_rotary_axes(const JointErrorSource& all);
JointErrorSource of_linear_axes(const JointErrorSource& all);

}  // namespace volcal
