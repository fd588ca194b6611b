#pragma once
/// The registered instruments.

#include <span>
#include <string_view>

#include "volcal/model/instruments/instrument.h"

namespace volcal {

std::span<const Instrument* const> instruments();
const Instrument* find_instrument(std::string_view name);

}  // namespace volcal
