#pragma once
/// What the channels of a setup's readings are.

#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"

namespace volcal {

/// Column of a channel as its instrument declares it: "length_mm". Throws InputError for an unknown
/// instrument.
std::string channel_column(const Setup& setup, std::size_t channel);
/// True when the channel is an angle (rad), false when it is a length (m).
bool is_angle_channel(const Setup& setup, std::size_t channel);
/// The same of every channel that was read, by setup and channel.
std::vector<std::vector<bool>> angle_channels(const Campaign& campaign);
/// Edge unit of a channel's residuals: "urad" or "um".
std::string residual_unit(const Setup& setup, std::size_t channel);
/// Readings whose noise is estimated together: those of an instrument; of one that reads both, its lengths
/// ("laser-tracker") and its angles ("laser-tracker angles") apart.
std::string noise_group(const Setup& setup, std::size_t channel);
/// Name of the instrument of a noise group.
std::string instrument_of_noise_group(const std::string& group);
/// Edge unit of a noise group's residuals: "urad" or "um"; "um or urad" of an unknown instrument.
std::string noise_group_unit(const std::string& group);

}  // namespace volcal
