#pragma once
/// What the channels of a setup's readings are.

#include "volcal/model/description/campaign.h"

namespace volcal {

/// Column of a channel as its instrument declares it: "length_mm". Throws InputError for an unknown
/// instrument.
std::string channel_column(const Setup& setup, std::size_t channel);
/// True when the channel is an angle (rad), false when it is a length (m).
bool is_angle_channel(const Setup& setup, std::size_t channel);

}  // namespace volcal
