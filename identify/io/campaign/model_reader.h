#pragma once
/// model.toml: bases of the error functions, known or switched-off errors, effects beyond the rigid body,
/// errors of tools' offsets.
///
/// Functions: `basis`, `degree`, `knots = "auto"` or a number of intervals, or `knots_mm` / `knots_deg`
/// (breakpoints, ends included); an identified function also has `coefficients_um` / `coefficients_urad`. A
/// function is left out with basis = "zero". `[locations]`: `EC0Y_urad = 12.3` (known), `EC0Y = "zero"` (left
/// out). `[priors]`: `displacement_um`, `rotation_urad`, `squareness_mrad`, how large errors may be before
/// any reading is seen (standard deviations). `[tools.long]`: `offset_error_um = [1.2, -3.4, 0.5]`, what the
/// machine file's offset of that tool is known to be wrong by, actual minus stated.

#include <map>
#include <string>

#include "volcal/identify/text/toml_document.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

inline constexpr const char* kModelFormat = "volcal-model-1";

/// Reads a model for `machine`. Throws InputError; also when the file names another machine, one that differs
/// from `machine` in structure, datum or axes.
ModelSpec read_model(const std::string& path, const Machine& machine, const SourcePlace& named_at = {});
ModelSpec parse_model(const std::string& text, const std::string& file, const Machine& machine);

/// The table `functions` of another file's table, in the form that model files have. Throws InputError.
std::map<ErrorSymbol, FunctionSpec> read_function_specs(const TomlTable& parent, const Machine& machine);

/// A model together with the machine that its `machine` key names.
struct ModelFile {
  Machine machine;
  ModelSpec spec;
};
/// `otherwise`: the machine of a file that names none; without it such a file is an error.
ModelFile read_model_with_machine(const std::string& path, const SourcePlace& named_at = {},
                                  const Machine* otherwise = nullptr);

}  // namespace volcal
