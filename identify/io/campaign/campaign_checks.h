#pragma once
/// Checks of a campaign that need more than one of its parts: stations, units, noise, temperature channels.

#include "volcal/model/description/campaign.h"

namespace volcal {

/// Setups that name one station: priors must agree within 5 sigma, guesses within 1 m. Throws InputError.
void check_shared_stations(const Campaign& campaign);

/// One setup with its readings. Throws InputError when
/// - the standard deviation of its readings is undefined or zero;
/// - a temperature channel that the machine's scales need has no column;
/// - a laser's station lies well inside the box of its own measured points;
/// - the readings follow the commanded positions by a factor far from 1: a unit or a sign is wrong. Judged
/// where
///   the instrument's prediction at the first guess varies by more than 5 mm (0.1 rad) and correlates with
///   the readings by more than 0.99; factors of 0.5 to 2 pass.
void check_setup(const Campaign& campaign, const Setup& setup);

}  // namespace volcal
