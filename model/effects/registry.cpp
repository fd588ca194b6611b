#include "volcal/model/effects/registry.h"

#include <algorithm>
#include <utility>

#include "volcal/model/description/registration.h"

namespace volcal {

// One line per effect.
#define VOLCAL_EFFECTS(EFFECT)        \
  EFFECT(reversal_effect)             \
  EFFECT(position_reversal_effect)    \
  EFFECT(curved_reversal_effect)      \
  EFFECT(thermal_reversal_effect)     \
  EFFECT(pre_travel_effect)           \
  EFFECT(common_reversal_effect)      \
  EFFECT(lead_error_effect)           \
  EFFECT(growing_lead_error_effect)   \
  EFFECT(rack_error_effect)           \
  EFFECT(encoder_subdivision_effect)  \
  EFFECT(worm_error_effect)           \
  EFFECT(ring_eccentricity_effect)    \
  EFFECT(screw_heating_effect)        \
  EFFECT(scale_expansion_effect)      \
  EFFECT(common_expansion_effect)     \
  EFFECT(common_growth_effect)        \
  EFFECT(thermal_drift_effect)        \
  EFFECT(spindle_growth_effect)       \
  EFFECT(tool_expansion_effect)       \
  EFFECT(squareness_drift_effect)     \
  EFFECT(axis_coupling_effect)        \
  EFFECT(product_coupling_effect)     \
  EFFECT(triple_coupling_effect)      \
  EFFECT(tool_load_effect)            \
  EFFECT(tilt_load_effect)            \
  EFFECT(cradle_coupling_effect)      \
  EFFECT(length_scale_effect)         \
  EFFECT(dead_path_effect)            \
  EFFECT(station_drift_effect)        \
  EFFECT(station_event_effect)        \
  EFFECT(tool_offset_effect)          \
  EFFECT(tool_clamping_effect)        \
  EFFECT(spindle_direction_effect)    \
  EFFECT(ball_bar_length_effect)      \
  EFFECT(servo_mismatch_effect)       \
  EFFECT(following_error_effect)      \
  EFFECT(lagged_temperature_effect)   \
  EFFECT(lagged_expansion_effect)     \
  EFFECT(temperature_rate_effect)     \
  EFFECT(tool_rate_effect)            \
  EFFECT(foundation_tilt_effect)      \
  EFFECT(beam_misalignment_effect)    \
  EFFECT(encoder_eccentricity_effect) \
  EFFECT(run_offset_effect)           \
  EFFECT(probe_lobing_effect)         \
  EFFECT(custom_effect)               \
  EFFECT(empirical_effect)

#define VOLCAL_DECLARE_EFFECT(name) const EffectKind& name();
#define VOLCAL_ADDRESS_OF_EFFECT(name) &(name)(),
VOLCAL_EFFECTS(VOLCAL_DECLARE_EFFECT)

namespace {

Registration<EffectKind>& registered_effects() {
  static Registration<EffectKind> effects(
      {VOLCAL_EFFECTS(VOLCAL_ADDRESS_OF_EFFECT)},
      [](const EffectKind& kind) -> std::string_view { return kind.schema().kind; });
  return effects;
}

}  // namespace

std::span<const EffectKind* const> effect_kinds() { return registered_effects().all(); }

const EffectKind* find_effect(std::string_view kind) { return registered_effects().find(kind); }

double largest_amplitude(const Effect& effect, const EffectAmplitude& amplitude) {
  constexpr double kOfErrorMotions = 1e5;
  double largest = kOfErrorMotions;
  if (const EffectKind* kind = find_effect(effect.name().kind)) {
    const auto& keys = kind->schema().keys;
    const auto key = std::ranges::find(keys, amplitude.key, &KeySchema::key);
    if (key != keys.end()) largest = key->plausible_max;
  }
  return largest * amplitude.si_per_unit();
}

const EffectKind& register_effect(std::unique_ptr<const EffectKind> kind) {
  return registered_effects().add(std::move(kind));
}

}  // namespace volcal
