#include <algorithm>

#include "volcal/sim/known/known_errors.h"
#include "volcal/sim/known/known_kinds.h"

namespace volcal::sim {

StateNumber from_home(const HiddenSettings& settings, AxisName axis) {
  return [k = index_of(axis), home = settings.home(axis)](const MachineState& state) {
    return state.position[k] - home;
  };
}

StateNumber approach_of(AxisName axis) {
  return [k = index_of(axis)](const MachineState& state) { return static_cast<double>(state.direction[k]); };
}

double amplitude_of(const HiddenSettings& settings) { return settings.number("amplitude", 0.0); }

Eigen::Vector3d vector_of(const HiddenSettings& settings) {
  return {settings.number("x", 0.0), settings.number("y", 0.0), settings.number("z", 0.0)};
}

StateNumber product_of(const StateNumber& one, const StateNumber& other) {
  return [one, other](const MachineState& state) { return one(state) * other(state); };
}

void add_motion(const HiddenSettings& settings, ErrorSymbol symbol, const StateNumber& driver,
                HiddenScene& scene) {
  scene.machine.add_state_error(
      symbol, [a = amplitude_of(settings), driver](const MachineState& state) { return a * driver(state); });
}

void add_motion(const HiddenSettings& settings, const StateNumber& driver, HiddenScene& scene) {
  add_motion(settings, settings.symbol(), driver, scene);
}

void move_tool(const Eigen::Vector3d& full, const StateNumber& driver, HiddenScene& scene) {
  scene.interference.tool.emplace_back(
      [full, driver](const Occasion& occasion) -> Eigen::Vector3d { return full * driver(occasion.state); });
}

namespace {

const std::vector<KnownKind>& known_kinds() {
  static const std::vector<KnownKind> kKinds = [] {
    std::vector<KnownKind> all;
    for (const auto& kinds : {known_drive_kinds(), known_thermal_kinds(), known_structure_kinds(),
                              known_instrument_kinds(), known_open_kinds()})
      all.insert(all.end(), kinds.begin(), kinds.end());
    std::ranges::sort(all, {}, &KnownKind::kind);
    return all;
  }();
  return kKinds;
}

const KnownKind& known_kind_of(const HiddenEffect& effect) {
  for (const KnownKind& known : known_kinds()) {
    if (effect.kind == known.kind) return known;
  }
  throw InputError(effect.place,
                   "the simulator does not know the effect \"" + effect.kind + "\" of the known errors",
                   "leave it out of a copy of the model, or hide it in the study as a [[hidden]] effect");
}

}  // namespace

void add_known_effects(const ModelSpec& errors, const HiddenContext& context, HiddenScene& scene) {
  for (const EffectSpec& spec : errors.effects) {
    const HiddenEffect effect{spec.kind, spec.options, {}, {}, {errors.file, spec.source_line}};
    known_kind_of(effect).act(HiddenSettings(effect, 0.0, context, "effect of the known errors "), scene);
  }
}

std::vector<std::string> known_effect_kinds() {
  std::vector<std::string> kinds;
  for (const KnownKind& known : known_kinds()) kinds.push_back(known.kind);
  return kinds;
}

}  // namespace volcal::sim
