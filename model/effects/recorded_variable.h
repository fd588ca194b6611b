#pragma once
/// What is recorded with readings, by the names and in the units in which users write of it: x y z (mm) and a
/// b c (deg) as commanded, dir_x ... dir_c (-1, 0, 1), since_x ... since_c (mm, deg: travel since the axis
/// turned round, until it first does as far as ever), t (s since the first reading), T_<channel> (degC),
/// length (mm to the station), feed (mm/min), tool_length tool_x tool_y tool_z (mm).

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/effects/effect_keys.h"

namespace volcal {

bool is_recorded_variable(const std::string& name);
/// Those that are neither positions, directions nor temperatures.
const std::vector<std::string>& plain_variables();

/// Names in a list with blanks: "y T_column".
std::vector<std::string> variables_in(const std::string& list);

/// Of a setup's readings; nothing when it was not recorded there.
std::optional<Eigen::VectorXd> recorded_variable(const SetupView& view, const std::string& name);
/// Whether the readings of a setup have a variable's column.
bool has_variable(const Setup& setup, const std::string& name);
/// "T_column_degC" for T_column.
std::string column_of_variable(const std::string& variable);

/// Throws InputError when the machine lacks the variable's axis, or no setup on which the effect acts has its
/// column. `user`: who needs it, as in "the expression uses z at character 3".
void check_variable(const Campaign& campaign, const std::string& name,
                    const std::function<bool(const Setup&)>& acts_on, const std::string& what,
                    const std::string& user, const SourcePlace& place);

}  // namespace volcal
