#include "volcal/model/description/units.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal {
namespace {

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const sim::HiddenKind& kind : sim::hidden_kinds()) names.push_back(kind.kind);
  return names;
}

/// Amplitude keys that the kind might take; which of them it is, the symbol says.
std::vector<std::string> amplitude_keys(const sim::HiddenKind& kind) {
  if (!kind.unit.empty()) return {"amplitude_" + kind.unit};
  return {"amplitude_um", "amplitude_urad"};
}

void read_amplitude(const TomlTable& table, const sim::HiddenKind& kind, sim::HiddenEffect& effect) {
  effect.rms = table.number("rms_um", kNotNegative);
  std::string given;
  for (const std::string& key : amplitude_keys(kind)) {
    const auto value = table.number(key);
    if (!value) continue;
    if (!given.empty()) table.fail(key, "two amplitudes are stated", "leave one out");
    effect.amplitude = *value;
    given = key;
  }
  const std::string wanted = "amplitude_" + amplitude_unit(effect);
  if (!given.empty() && given != wanted) {
    table.fail(given, "the amplitude of this effect is not in " + std::string(unit_of_key(given).suffix),
               "write " + wanted);
  }
  if (!given.empty() && effect.rms) {
    table.fail("rms_um", "amplitude and rms_um are both stated", "leave one out");
  }
  if (given.empty() && !effect.rms) {
    table.fail("", "neither " + wanted + " nor rms_um is stated",
               "state the amplitude, or the root mean square of its effect on the readings");
  }
}

}  // namespace

sim::HiddenEffect read_hidden_effect(const TomlTable& table) {
  const auto name = table.choice("kind", kind_names());
  if (!name) table.fail_missing("kind");
  const sim::HiddenKind& kind = *sim::find_hidden_kind(*name);
  sim::HiddenEffect effect;
  effect.kind = kind.kind;
  effect.place = table.place();
  effect.options = table.options(kind.keys);
  read_amplitude(table, kind, effect);
  return effect;
}

}  // namespace volcal
