#pragma once
/// Machine and model files written out, readable again to rounding (machine_reader.h, model_reader.h);
/// result.json keeps every bit.

#include <string>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// A number in its edge unit, with the fewest digits that give `si` back to one unit of the last place.
std::string edge_number(double si, double si_per_unit);
/// A TOML text in double quotes.
std::string toml_text(const std::string& text);

/// One [[effects]] table.
std::string effect_toml(const EffectSpec& effect);

/// machine.toml.
std::string machine_toml(const Machine& machine);

/// model.toml of a specification; `machine_path` is what its `machine` key shall say. `comment` lines
/// (without #) stand at the top.
std::string model_toml(const ModelSpec& spec, const std::string& machine_path,
                       const std::string& comment = {});

}  // namespace volcal
