#pragma once
/// Disturbances as a user writes them.

#include <string>

#include "volcal/identify/montecarlo/repeated_campaign.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// "KIND:TARGET=U", a normal distribution with standard uncertainty U, or "KIND:TARGET=+-A", a rectangular
/// one of half width A; in the edge unit of the effect's amplitude. Throws InputError.
Disturbance disturbance_from(const std::string& text, const Campaign& campaign);

}  // namespace volcal
