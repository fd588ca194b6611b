#include "volcal/model/instruments/registry.h"

#include <algorithm>
#include <array>

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

std::span<const Instrument* const> instruments() {
  static const auto kInstruments = std::to_array<const Instrument*>({VOLCAL_INSTRUMENTS(VOLCAL_ADDRESS)});
  return kInstruments;
}

const Instrument* find_instrument(std::string_view name) {
  const auto found =
      std::ranges::find_if(instruments(), [&](const Instrument* i) { return i->schema().name == name; });
  return found == instruments().end() ? nullptr : *found;
}

}  // namespace volcal
