#include "volcal/sim/hidden/hidden_effects.h"

#include <algorithm>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {
namespace {

std::vector<HiddenKind> collected() {
  std::vector<HiddenKind> all;
  for (const auto& group :
       {hidden_drive_kinds(), hidden_thermal_kinds(), hidden_structure_kinds(), hidden_rotary_kinds(),
        hidden_instrument_kinds(), hidden_unlisted_kinds(), hidden_unlisted_time_kinds()}) {
    all.insert(all.end(), group.begin(), group.end());
  }
  return all;
}

const HiddenKind& kind_of(const HiddenEffect& effect) {
  const HiddenKind* kind = find_hidden_kind(effect.kind);
  if (kind) return *kind;
  std::string names;
  for (const HiddenKind& each : hidden_kinds()) names += (names.empty() ? "" : ", ") + each.kind;
  throw InputError(effect.place, "there is no hidden effect \"" + effect.kind + "\"", "known: " + names);
}

}  // namespace

const std::vector<HiddenKind>& hidden_kinds() {
  static const std::vector<HiddenKind> kinds = collected();
  return kinds;
}

const HiddenKind* find_hidden_kind(const std::string& kind) {
  const auto& kinds = hidden_kinds();
  const auto found = std::ranges::find(kinds, kind, &HiddenKind::kind);
  return found == kinds.end() ? nullptr : &*found;
}

std::string amplitude_unit(const HiddenEffect& effect) {
  const HiddenKind& kind = kind_of(effect);
  if (!kind.unit.empty()) return kind.unit;
  const std::string symbol = effect.options.text("symbol").value_or("");
  if (const auto motion = ErrorSymbol::parse(symbol)) return std::string(edge_unit(motion->component));
  if (const auto location = LocationSymbol::parse(symbol)) return std::string(edge_unit(location->component));
  throw InputError(effect.place,
                   "hidden effect " + effect.kind + ": \"" + symbol + "\" is not an error symbol",
                   "write a symbol of ISO 230-1, such as EXX, or EC0Y for a location error");
}

void add_hidden(const HiddenEffect& effect, double amplitude, const HiddenContext& context,
                HiddenScene& scene) {
  kind_of(effect).act(HiddenSettings(effect, amplitude, context), scene);
}

}  // namespace volcal::sim
