#pragma once
/// Values of what is recorded with readings, in the units in which users write of it: x y z (mm) and a b c
/// (deg) as commanded, dir_x ... dir_c (-1, 0, 1), since_x ... since_c (mm, deg: travel since the axis turned
/// round, until it first does as far as ever), t (s since the first reading), T_<channel> (degC), length (mm
/// to the station), feed (mm/min), tool_length tool_x tool_y tool_z (mm).

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {

/// Those that are neither of an axis nor temperatures.
const std::vector<Variable>& plain_variables();
/// "x y z a b c, dir_x ... dir_c, ..., feed": what users may write, for messages.
std::string listed_variables();

/// Of a setup's readings; nothing when it was not recorded there. Throws std::invalid_argument for what users
/// cannot write of (speed, elevation, run, indicators).
std::optional<Eigen::VectorXd> recorded_variable(const SetupView& view, const Variable& variable);
/// Whether the readings of a setup have a variable's column.
bool has_variable(const Setup& setup, const Variable& variable);

/// Throws InputError when the machine lacks the variable's axis, or no setup on which the effect acts has its
/// column. `user`: who needs it, as in "the expression uses z at character 3".
void check_variable(const Campaign& campaign, const Variable& variable,
                    const std::function<bool(const Setup&)>& acts_on, const std::string& what,
                    const std::string& user, const SourcePlace& place);

}  // namespace volcal
