#include "volcal/identify/planning/registry.h"

#include <algorithm>
#include <array>

#include "volcal/model/description/errors.h"

namespace volcal {

// One line per instrument.
#define VOLCAL_PLAN_INSTRUMENTS(INSTRUMENT) \
  INSTRUMENT(planned_laser_tracer)          \
  INSTRUMENT(planned_laser_tracker)         \
  INSTRUMENT(planned_ball_bar)              \
  INSTRUMENT(planned_r_test)                \
  INSTRUMENT(planned_probed_sphere)         \
  INSTRUMENT(planned_rotary_ball_bar)       \
  INSTRUMENT(planned_turning_tracer)

#define VOLCAL_DECLARE_PLANNED(name) const PlanInstrument& name();
#define VOLCAL_ADDRESS_OF_PLANNED(name) &(name)(),
VOLCAL_PLAN_INSTRUMENTS(VOLCAL_DECLARE_PLANNED)

std::span<const PlanInstrument* const> plan_instruments() {
  static const auto kInstruments =
      std::to_array<const PlanInstrument*>({VOLCAL_PLAN_INSTRUMENTS(VOLCAL_ADDRESS_OF_PLANNED)});
  return kInstruments;
}

std::string usual_plan_instrument() { return plan_instruments().front()->name(); }

const PlanInstrument* find_plan_instrument(std::string_view name) {
  const auto found = std::ranges::find_if(plan_instruments(),
                                          [&](const PlanInstrument* each) { return each->name() == name; });
  return found == plan_instruments().end() ? nullptr : *found;
}

const PlanInstrument& plan_instrument_of(const PlanSettings& settings) {
  if (const PlanInstrument* found = find_plan_instrument(settings.instrument)) return *found;
  std::string known;
  for (const PlanInstrument* each : plan_instruments()) known += (known.empty() ? "" : ", ") + each->name();
  throw InputError({}, "no campaign can be planned for \"" + settings.instrument + "\"",
                   "choose one of " + known);
}

}  // namespace volcal
