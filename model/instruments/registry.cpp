#include "volcal/model/instruments/registry.h"

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
  INSTRUMENT(volumetric_points)

#define VOLCAL_DECLARE(name) const Instrument& name();
#define VOLCAL_ADDRESS(name) &(name)(),
VOLCAL_INSTRUMENTS(VOLCAL_DECLARE)

namespace {

Registration<Instrument>& registered_instruments() {
  static Registration<Instrument> all(
      {VOLCAL_INSTRUMENTS(VOLCAL_ADDRESS)},
      [](const Instrument& instrument) -> std::string_view { return instrument.schema().name; });
  return all;
}

}  // namespace

std::span<const Instrument* const> instruments() { return registered_instruments().all(); }

const Instrument* find_instrument(std::string_view name) { return registered_instruments().find(name); }

const Instrument& register_instrument(std::unique_ptr<const Instrument> instrument) {
  return registered_instruments().add(std::move(instrument));
}

}  // namespace volcal
