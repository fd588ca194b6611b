#pragma once
/// The words that names of effects are made of, and what they mean: what `volcal diagnose --list` prints,
/// diagnosis.json holds, and --effect and --separate take.
///
/// A word in capitals stands for something of the user's files: SYMBOL (EXX, EC0Y), AXIS (x), PLANE (XY),
/// TOOL, STATION, SETUP, INSTRUMENT, CHANNEL, RUN. Words of one kind alone stand in its schema. An effect
/// whose words are in neither fails its contract test.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/criticism/data/scan_direction.h"
#include "volcal/model/description/machine_error.h"
#include "volcal/model/description/schema.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// A pattern of a word and its meaning; what is in capitals stands for something of the user's files.
struct EffectWord {
  std::string_view pattern;  ///< "readings of SETUP"
  std::string_view meaning;
  std::string_view kind = {};  ///< the only one that has it; "common-": all that start so; empty: any

  friend bool operator==(const EffectWord&, const EffectWord&) = default;
};

/// Kinds that are changes of the model and no effects to add: an error given back, more knots.
struct ModelChange {
  std::string_view kind;
  std::string_view summary;
};
std::span<const ModelChange> model_change_kinds();
/// The kind of an error that the model file switches off (left_out.h).
inline constexpr const char* kLeftOut = "left-out";
/// The error motions and location errors that the specification of such an error names.
std::vector<MachineError> errors_given_back(const EffectSpec& spec);
/// Name of more knots for an error function: resolution:EXX:x:finer.
EffectName resolution_name(ErrorSymbol symbol);

/// Words that all kinds have, then those of the schemas of what is registered.
std::vector<EffectWord> effect_words(NamePart part);
/// Words for what scans without a catalogue go through, in the order of Variable::Kind.
std::span<const EffectWord> scan_words();

/// How much has to be believed of what a scan saw, 0 = least: one variable before two, but for a station
/// along its beam, which is a dead path and no parameter of the model where it shows; time before
/// temperatures for a station, which is no part of the machine, and temperatures before time for a beam,
/// whose wavelength follows the air's; and whatever depends on time and a temperature is a function of time.
int complexity_rank(const std::vector<Variable>& variables, ScanDirection direction);

}  // namespace volcal
