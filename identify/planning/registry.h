#pragma once
/// Instruments that can be planned for.

#include <span>
#include <string>
#include <string_view>

#include "volcal/identify/planning/plan_instrument.h"

namespace volcal {

std::span<const PlanInstrument* const> plan_instruments();

/// nullptr where an instrument cannot be planned for.
const PlanInstrument* find_plan_instrument(std::string_view name);
/// The settings' own; throws InputError where it cannot be planned for.
const PlanInstrument& plan_instrument_of(const PlanSettings& settings);

}  // namespace volcal
