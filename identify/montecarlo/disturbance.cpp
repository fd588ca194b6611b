#include "volcal/identify/montecarlo/disturbance.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>

#include "volcal/identify/criticism/catalogue/named_effect.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kMostDisturbed = 1e4;  // um, urad, um/m, 1/K: ten millimetres or 1 % are no disturbance

/// 0 where the text is no finite number.
double size_of(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [read_to, problem] = std::from_chars(text.data(), end, value);
  return problem == std::errc{} && read_to == end && std::isfinite(value) ? value : 0.0;
}

}  // namespace

Disturbance disturbance_from(const std::string& text, const Campaign& campaign) {
  const std::size_t equals = text.rfind('=');
  const std::string value_text = equals == std::string::npos ? "" : text.substr(equals + 1);
  const bool is_rectangular = value_text.starts_with("+-");
  const std::string number = is_rectangular ? value_text.substr(2) : value_text;
  const double value = size_of(number);
  if (!(value > 0.0)) {
    throw InputError(
        {}, "--disturb " + text + ": how large the effect may be is missing or not positive",
        "write KIND:TARGET=U for a standard uncertainty, KIND:TARGET=+-A for limits, in the unit "
        "that volcal diagnose --list prints");
  }
  if (value > kMostDisturbed) {
    throw InputError({}, "--disturb " + text + ": no effect is so large",
                     "give at most 1e4, in the unit that volcal diagnose --list prints");
  }
  const EffectSpec spec = named_effect("--disturb", text.substr(0, equals), campaign);
  const auto effect = find_effect(spec.kind)->make(spec, {});
  const EffectAmplitude& amplitude = effect->amplitudes().front();
  const double divisor = is_rectangular ? std::numbers::sqrt3 : 1.0;
  return {.effect = spec,
          .sigma = value * amplitude.si_per_unit() / divisor,
          .words = fmt::format("{}, {} {} {}", text.substr(0, equals),
                               is_rectangular ? "within +-" : "u =", number, amplitude.unit()),
          .shape = is_rectangular ? DistributionShape::Rectangular : DistributionShape::Normal};
}

}  // namespace volcal
