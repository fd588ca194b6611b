#include "volcal/model/instruments/registry.h"

#include <algorithm>
#include <array>

#include "volcal/model/instruments/all_instruments.h"

namespace volcal {

std::span<const Instrument* const> instruments() {
  static const std::array<const Instrument*, 7> kInstruments = {
      &laser_tracer(), &laser_tracker(), &ball_bar(),          &displacement(),
      &straightness(), &angle(),         &volumetric_points(),
  };
  return kInstruments;
}

const Instrument* find_instrument(std::string_view name) {
  const auto found =
      std::ranges::find_if(instruments(), [&](const Instrument* i) { return i->schema().name == name; });
  return found == instruments().end() ? nullptr : *found;
}

}  // namespace volcal
