#pragma once
/// Hidden physical effects: what a rigid-body model does not know and a campaign nevertheless contains.
///
/// An effect is a kind, a target, its numbers and an amplitude. It acts through the exact transforms of
/// TruthMachine and the exact observation of instruments.h; nothing is linearised. In the formulas of the
/// kinds a is the amplitude, u = (q - home) / travel the share of an axis' travel, dT the excess of a
/// channel's temperature over 20 degC in K, h the time since the campaign's start in hours, d = -1, 0, +1 the
/// direction of approach. Kinds of the group "unlisted" have shapes that no catalogue of effects is meant to
/// hold. m, rad, s, degC.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/schema.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/environment.h"
#include "volcal/sim/measurement/interference.h"

namespace volcal::sim {

struct HiddenEffect {
  std::string kind;
  Options options;                       ///< keys of the kind, SI by stem
  std::optional<double> amplitude = {};  ///< SI unit of amplitude_unit(); or else
  std::optional<double> rms = {};        ///< of its effect on the readings, m (angles with an arm of 1 m)
  SourcePlace place = {};                ///< of the study file, for messages
};

/// What an effect is resolved against.
struct HiddenContext {
  const Machine& machine;
  const Environment& environment;
  const std::vector<SetupPlan>& plans;
};

/// What effects act on.
struct HiddenScene {
  TruthMachine& machine;
  Interference& interference;
};

class HiddenSettings;

struct HiddenKind {
  std::string kind;
  std::string group;            ///< drive, thermal, structure, instrument, unlisted
  std::string formula;          ///< one line, symbols as above
  std::vector<KeySchema> keys;  ///< besides kind, amplitude and rms_um
  std::string unit;             ///< of the amplitude; empty = that of the symbol, um or urad
  std::string per;              ///< what the unit is taken for, "K"; may be empty
  void (*act)(const HiddenSettings& settings, HiddenScene& scene);
};

/// All kinds, by group.
const std::vector<HiddenKind>& hidden_kinds();
/// Null when there is none of this name.
const HiddenKind* find_hidden_kind(const std::string& kind);

/// Unit of an effect's amplitude at the edge: "um", "urad", "um_per_m" ... Throws InputError for an unknown
/// kind or a symbol that cannot be read.
std::string amplitude_unit(const HiddenEffect& effect);

/// Adds an effect of this amplitude (SI). Throws InputError, at the effect's place, for a symbol, axis, tool,
/// channel, station or setup that does not exist and for numbers that make no sense.
void add_hidden(const HiddenEffect& effect, double amplitude, const HiddenContext& context,
                HiddenScene& scene);

}  // namespace volcal::sim
