#pragma once
/// A campaign for work on a machine file that is given beside it.

#include "volcal/model/description/campaign.h"

namespace volcal {

/// The campaign with `machine` in place of its own: setups have the tool of the same name. Throws InputError
/// where the machines differ (machine_difference()), where a setup's tool is missing, and where it has
/// another offset.
Campaign campaign_on_machine(Campaign campaign, const Machine& machine);

}  // namespace volcal
