#pragma once
/// What compensation tables leave in the volume, and which formats there are, as text and JSON; um and mm.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volcal/identify/compensation/checks/all_axes_check.h"
#include "volcal/identify/compensation/checks/rotary_check.h"
#include "volcal/identify/compensation/checks/volume_check.h"

namespace volcal {

/// Of the errors of rotary axes, the tool point and the direction of the tool's axis.
std::string rotary_check_text(const RotaryCheck& check, const CompensationType& type);
nlohmann::ordered_json rotary_check_json(const RotaryCheck& check);

std::string all_axes_text(const AllAxesCheck& check);
nlohmann::ordered_json all_axes_json(const AllAxesCheck& check);

/// RMS and largest error before, with the ideal compensation and with the tables, and what is to be expected
/// of the machine with the uncertainty of the identified errors; then per type.
std::string volume_check_text(const VolumeCheck& check, const CompensationType& type);
nlohmann::ordered_json volume_check_json(const VolumeCheck& check);

/// Formats with what they can compensate, their limits, settings and what they were verified on; then the
/// types.
std::string table_formats_text();
nlohmann::ordered_json table_formats_json();
/// "at most 256 positions a table, both directions, ...".
std::string limits_text(const CompensationLimits& limits);

}  // namespace volcal
