#pragma once
/// The registered instruments: the library's own, and those that a program adds.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "volcal/model/instruments/instrument.h"

namespace volcal {

std::span<const Instrument* const> instruments();
const Instrument* find_instrument(std::string_view name);
/// Traits of a setup's instrument; none of those of an instrument that is not registered.
const InstrumentTraits& traits_of(const Setup& setup);
/// Name of the first registered instrument that reads the length of a bar.
const std::string& instrument_with_bar();

/// Adds an instrument of the program's own, which campaigns, fits and diagnoses then know like those of the
/// library; before the library is used. Throws std::invalid_argument when its name is empty or taken.
const Instrument& register_instrument(std::unique_ptr<const Instrument> instrument);

}  // namespace volcal
