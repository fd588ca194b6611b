#pragma once
/// A temperature channel behind a lumped thermal mass: what follows it late.

#include <Eigen/Core>
#include <string>

#include "volcal/model/effects/effect_keys.h"

namespace volcal {

bool has_time_and_channel(const Setup& setup, const std::string& channel);
/// Throws InputError where the campaign lacks one of them.
void check_time_and_channel(const Campaign& campaign, const std::string& channel, const std::string& label,
                            const SourcePlace& place);

/// Per reading of a setup, the lagged temperature less 20 degC: y with lag y' = T - y from the first reading
/// of the campaign's channel on, T linear between readings; 0 where time or channel were not recorded. `lag`:
/// s.
Eigen::VectorXd lagged_excess(const SetupView& view, const std::string& channel, double lag);

}  // namespace volcal
