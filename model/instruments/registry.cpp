#include "volcal/model/instruments/registry.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "volcal/model/description/registration.h"

namespace volcal {

// One line per instrument.
#define VOLCAL_INSTRUMENTS(INSTRUMENT) \
  INSTRUMENT(laser_tracer)             \
  INSTRUMENT(laser_tracker)            \
  INSTRUMENT(ball_bar)                 \
  INSTRUMENT(displacement)             \
  INSTRUMENT(straightness)             \
  INSTRUMENT(angle)                    \
  INSTRUMENT(volumetric_points)        \
  INSTRUMENT(r_test)                   \
  INSTRUMENT(probed_sphere)

#define VOLCAL_DECLARE_INSTRUMENT(name) const Instrument& name();
#define VOLCAL_ADDRESS_OF_INSTRUMENT(name) &(name)(),
VOLCAL_INSTRUMENTS(VOLCAL_DECLARE_INSTRUMENT)

namespace {

Registration<Instrument>& registered_instruments() {
  static Registration<Instrument> all(
      {VOLCAL_INSTRUMENTS(VOLCAL_ADDRESS_OF_INSTRUMENT)},
      [](const Instrument& instrument) -> std::string_view { return instrument.schema().name; });
  return all;
}

}  // namespace

std::span<const Instrument* const> instruments() { return registered_instruments().all(); }

const Instrument* find_instrument(std::string_view name) { return registered_instruments().find(name); }

const InstrumentTraits& traits_of(const Setup& setup) {
  static const InstrumentTraits none;
  const Instrument* instrument = find_instrument(setup.instrument);
  return instrument != nullptr ? instrument->schema().traits : none;
}

const std::string& instrument_with_bar() {
  const auto all = instruments();
  const auto found = std::ranges::find_if(
      all, [](const Instrument* instrument) { return instrument->schema().traits.has_bar; });
  if (found == all.end()) throw std::logic_error("no registered instrument reads the length of a bar");
  return (*found)->schema().name;
}

const Instrument& register_instrument(std::unique_ptr<const Instrument> instrument) {
  return registered_instruments().add(std::move(instrument));
}

}  // namespace volcal
