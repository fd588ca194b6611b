#pragma once
/// machine.toml: structure, datum, axes and tools of a machine.

#include <string>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/machine.h"

namespace volcal {

/// Format line of machine files.
inline constexpr const char* kMachineFormat = "volcal-machine-1";
/// Largest magnitude of a coefficient of expansion that is believed.
inline constexpr double kLargestExpansion_um_per_m_K = 100.0;

/// Reads a machine file. `named_at`: line of another file that names this one. Without [datum] the primary
/// axis is X and the secondary Y; reference_point_mm and centre_mm default to the origin; `endless` of a
/// rotary axis as Machine::is_endless() says. Throws InputError.
Machine read_machine(const std::string& path, const SourcePlace& named_at = {});
/// The same from text; `file` names it in messages.
Machine parse_machine(const std::string& text, const std::string& file);

/// For suggestions in messages.
std::vector<std::string> tool_names(const Machine& machine);

}  // namespace volcal
