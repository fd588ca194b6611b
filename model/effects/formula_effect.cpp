#include "volcal/model/effects/formula_effect.h"

#include <array>

#include "volcal/model/description/units.h"

namespace volcal {

FormulaEffect::Count without_time() {
  return [](const SetupView& view) { return view.setup.readings.time.empty() ? view.rows() : 0; };
}

FormulaEffect::Count without_channel(const std::string& channel) {
  return [channel](const SetupView& view) {
    return view.setup.readings.temperature.contains(channel) ? 0 : view.rows();
  };
}

EffectAmplitude motion_amplitude(const EffectTable& table, const std::string& of, ErrorSymbol symbol,
                                 const std::string& per, const std::string& part) {
  const std::string stem = part.empty() ? "amplitude" : part;
  return {.label = part_label(of, part),
          .target = {.kind = TargetKind::Motion, .symbol = symbol},
          .key = motion_amplitude_key(symbol, per, stem),
          .guess = table.number(stem, 0.0),
          .of = of,
          .part = part};
}

std::vector<EffectAmplitude> vector_amplitudes(const EffectTable& table, const std::string& of,
                                               TargetKind kind, const std::string& unit) {
  std::vector<EffectAmplitude> amplitudes;
  for (int k = 0; k < 3; ++k) {
    const std::string component(1, "xyz"[k]);
    amplitudes.push_back({.label = part_label(of, component),
                          .target = {.kind = kind, .symbol = {}, .component = k},
                          .key = component + "_" + unit,
                          .guess = table.number(component, 0.0),
                          .of = of,
                          .part = component});
  }
  return amplitudes;
}

std::vector<KeySchema> vector_amplitude_keys(const std::string& unit, const std::string& help) {
  std::vector<KeySchema> keys;
  for (const std::string component : {"x", "y", "z"}) {
    keys.push_back({.key = component + "_" + unit,
                    .help = help + ", along " + component,
                    .plausible_min = 1e-9,
                    .plausible_max = 1e5});
  }
  return keys;
}

EffectAmplitude reading_amplitude(const EffectTable& table, const std::string& of, const std::string& key,
                                  int channel, const std::string& part) {
  return {.label = part_label(of, part),
          .target = {.kind = TargetKind::Reading, .symbol = {}, .component = channel},
          .key = key,
          .guess = table.number(std::string(stem_of_key(key)), 0.0),
          .of = of,
          .part = part};
}

EffectShape shape_parameter(const EffectTable& table, const std::string& label, const std::string& stem,
                            const std::string& unit, double otherwise, double scan_min, double scan_max) {
  return {.label = label,
          .key = stem + "_" + unit,
          .value = table.number(stem, otherwise),
          .sigma = table.number(stem + "_sigma", 0.0),
          .scan_min = scan_min,
          .scan_max = scan_max};
}

std::vector<KeySchema> shape_keys(const std::string& stem, const std::string& unit, const std::string& help) {
  return {{.key = stem + "_" + unit, .help = help, .plausible_max = 1e9},
          {.key = stem + "_sigma_" + unit,
           .help = "standard uncertainty of " + stem + "_" + unit + " before the fit; absent = held",
           .plausible_max = 1e9}};
}

KeySchema text_key(const std::string& key, const std::string& help, bool required) {
  return {.key = key, .type = KeyType::Text, .required = required, .help = help};
}

KeySchema axis_key(const std::string& key, const std::string& help) {
  return {.key = key, .type = KeyType::Text, .required = true, .help = help, .choices = {"Z", "Y", "X"}};
}

}  // namespace volcal
